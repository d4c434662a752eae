"""Following a vehicle along its route until it has landed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from jfto_mavlink.dialect import MODES, Message, mavlink
from jfto_mavlink.exchange import Context, Exchange, Report, Wait
from jfto_mavlink.flight.place import Place, closest_m
from jfto_mavlink.mission.build import VehicleMission

LOOK_EVERY_S = 1.0
# A vehicle silent for this long is given up; its own failsafes act.
GIVE_UP_S = 120.0
COMPLETE = mavlink.MISSION_STATE_COMPLETE
# After any other last item the vehicle hovers where it is.
LANDING = (mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH, mavlink.MAV_CMD_NAV_LAND)


@dataclass
class Passage:
    """How one waypoint was passed. Times count from lift-off; `closest_m` is measured in 3-D.

    `reached_s` is None until the autopilot said so (or has gone on to a later item).
    """

    waypoint_id: int
    planned_s: float
    reached_s: float | None = None
    closest_m: float = math.inf

    @property
    def late_s(self) -> float | None:
        """Seconds behind the plan, negative when early."""
        return None if self.reached_s is None else self.reached_s - self.planned_s


@dataclass
class FlightRecord:
    """One vehicle's flight. `ended` is "landed", "hovering" at the end of a mission, or "lost"."""

    uav: str
    passages: list[Passage]
    ended: str = ""
    duration_s: float = 0.0
    modes: list[str] = field(default_factory=list)

    def missed(self, within_m: float) -> tuple[int, ...]:
        """Ids of waypoints not reached, or passed farther away than allowed."""
        return tuple(
            p.waypoint_id
            for p in self.passages
            if p.reached_s is None or not p.closest_m <= within_m
        )


class Follower:
    """Takes a vehicle's messages and keeps its flight record.

    The first `passed` waypoints were passed before, nobody here knows when.
    """

    def __init__(self, mission: VehicleMission, lift_off_s: float, passed: int = 0) -> None:
        self.mission = mission
        self.lift_off_s = lift_off_s
        self.record = FlightRecord(
            mission.uav,
            [Passage(i, at) for i, at in zip(mission.waypoint_ids, mission.arrival_s, strict=True)],
        )
        self._next = passed
        self._last_place: Place | None = None

    def take(self, message: Message, now_s: float) -> list[str]:
        """Update the record; returns what happened, in words."""
        kind = message.get_type()
        if kind == "GLOBAL_POSITION_INT":
            self._moved((message.lat / 1e7, message.lon / 1e7, message.relative_alt / 1e3))
        elif kind == "MISSION_ITEM_REACHED":
            index = self.mission.item_map.waypoint(message.seq)
            if index is not None:
                return self._reached(index, now_s)
        elif kind == "MISSION_CURRENT" and message.seq:
            # Reached messages are sent once: a later item under way says the same.
            index = self.mission.item_map.next_waypoint(message.seq)
            passed = len(self.record.passages) if index is None else index
            return self._reached(passed - 1, now_s) if passed else []
        return []

    def _moved(self, place: Place) -> None:
        start = self._last_place or place
        self._last_place = place
        # The waypoint ahead, and the one just reached: a corner is cut before it is passed.
        for index in (self._next - 1, self._next):
            if 0 <= index < len(self.record.passages):
                passage = self.record.passages[index]
                target = self.mission.waypoints_deg_m[index]
                passage.closest_m = min(passage.closest_m, closest_m(start, place, target))

    def _reached(self, index: int, now_s: float) -> list[str]:
        words = []
        for passage in self.record.passages[self._next : index + 1]:
            passage.reached_s = now_s - self.lift_off_s
            words.append(
                f"waypoint {passage.waypoint_id} reached, {passage.closest_m:.1f} m, "
                f"{passage.late_s:+.1f} s"
            )
        self._next = max(self._next, index + 1)
        return words

    @property
    def done(self) -> int:
        """Waypoints reached so far."""
        return self._next


def follow(context: Context, mission: VehicleMission, lift_off_s: float) -> Exchange[FlightRecord]:
    """Follow a started vehicle until it has landed and disarmed, hovers at the end, or is lost.

    `lift_off_s` and all times in the record are on the vehicle's own clock.
    """
    follower = Follower(mission, lift_off_s)
    record, vehicle = follower.record, context.vehicle
    mode: int | None = MODES["AUTO"]
    total = len(record.passages)
    hovers = mission.mission.items[-1].command not in LANDING
    while not record.ended:
        message = yield Wait(context.clock() + LOOK_EVERY_S)
        now_s = context.clock()
        if message is not None:
            for words in follower.take(message, vehicle.own_time_s(now_s)):
                yield Report(words, follower.done, total)
        if vehicle.mode != mode:
            mode = vehicle.mode
            record.modes.append(vehicle.mode_name)
            texts = "; ".join(vehicle.texts_since(now_s - LOOK_EVERY_S))
            yield Report(f"mode {vehicle.mode_name}: {texts}", follower.done, total)
        if vehicle.silent_s(now_s) > GIVE_UP_S:
            record.ended = "lost"
        elif not vehicle.armed:
            record.ended = "landed"
        elif hovers and vehicle.mission_state == COMPLETE and vehicle.mode == MODES["AUTO"]:
            record.ended = "hovering"
        record.duration_s = vehicle.own_time_s(now_s) - lift_off_s
    return record
