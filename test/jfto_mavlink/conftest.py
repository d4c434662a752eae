"""A rig in virtual time: an exchange on one side, a scripted vehicle on the other."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.files.tlog import read_tlog
from jfto_mavlink.io.framing import Framer
from jfto_mavlink.io.port import Station
from jfto_mavlink.protocol.exchange import Activity, Context, Exchange, Report
from jfto_mavlink.protocol.vehicle_state import VehicleState
from jfto_msgs_py.records.plan import Origin, Plan, Route, Slots, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio

DATA = Path(__file__).parents[1] / "data" / "ardupilot"
Answer = Callable[[Message, float], Iterable[tuple[float, Message]]]


class Rig:
    """Runs one exchange against a vehicle given as a function, without waiting for anything.

    The function gets each message sent and the time, and returns (delay, message) pairs.
    """

    def __init__(self) -> None:
        self.now_s = 0.0
        self.sent: list[tuple[float, Message]] = []
        self.reports: list[Report] = []
        self.vehicle = VehicleState("uav1")
        self.station = Station()
        self.context = Context("uav1", 1, self.station, self.vehicle, lambda: self.now_s)
        self._codec = mavlink.MAVLink(None, 1, 1)
        self._queue: list[tuple[float, int, Message]] = []
        self._order = itertools.count()

    def later(self, delay_s: float, message: Message) -> None:
        """Let the vehicle say something after a while."""
        heapq.heappush(self._queue, (self.now_s + delay_s, next(self._order), message))

    def run(self, exchange: Exchange, answer: Answer, limit_s: float = 600.0) -> object:
        """Result of the exchange; its error is raised. Fails the test after `limit_s`."""

        def send(message: Message) -> None:
            self.sent.append((self.now_s, message))
            for delay_s, reply in answer(message, self.now_s):
                self.later(delay_s, reply)

        activity = Activity(exchange, send, self.reports.append)
        while not activity.done:
            due_s = self._queue[0][0] if self._queue else float("inf")
            if due_s <= activity.deadline_s:
                self.now_s = max(self.now_s, due_s)
                message = heapq.heappop(self._queue)[2]
                message.pack(self._codec)
                self.vehicle.update(message, self.now_s)
                activity.feed(message)
            else:
                self.now_s = activity.deadline_s
                activity.tick(self.now_s)
            assert self.now_s < limit_s, "the exchange does not come to an end"
        if activity.error is not None:
            raise activity.error
        return activity.result

    def sent_types(self) -> list[str]:
        """Types of the messages sent, in order."""
        return [message.get_type() for _, message in self.sent]


@pytest.fixture
def rig() -> Rig:
    return Rig()


@pytest.fixture
def recording() -> Callable[[str], list[tuple[float, Message]]]:
    """Messages of a recording of the real autopilot: seconds from its first frame, message."""

    def load(name: str) -> list[tuple[float, Message]]:
        framer = Framer()
        records = list(read_tlog(DATA / name))
        start = records[0][0]
        return [((us - start) / 1e6, f.message) for us, raw in records for f in framer.feed(raw)]

    return load


@pytest.fixture
def plan() -> Plan:
    """Two UAVs with three and two waypoints on a slope, pads 20 m apart."""
    waypoints = tuple(
        Waypoint(i, (40.0 * i, 30.0 * (i % 3), 25.0 + 4.0 * i), 75.0 * i - 90.0, -20.0 - 5.0 * i)
        for i in range(1, 6)
    )
    uavs = tuple(
        Uav(f"uav{n + 1}", 30.0, 200.0, 450.0, 8.0, 4.0, 3.0, (0.0, 20.0 * n, 2.0 * n))
        for n in range(2)
    )
    routes = (
        Route((1, 3, 5), (15.0, 30.0, 47.5), 260.0),
        Route((2, 4), (16.0, 33.0), 180.0),
    )
    return Plan(
        scenario_hash="0" * 64,
        seed=1,
        origin=Origin(47.397742, 8.545594, 488.0),
        radio=Radio(),
        k_min=1,
        delta=1,
        d_min_m=5.0,
        length_max_m=1000.0,
        slots=Slots(20, 3.0),
        waypoints=waypoints,
        uavs=uavs,
        routes=routes,
        positions_m=np.zeros((2, 21, 3)),
    )
