"""Orders to a fleet that is flown by streamed trajectories."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import Future, wait
from functools import partial
from pathlib import Path

import numpy as np

from jfto_mavlink.dialect import MODES
from jfto_mavlink.errors import FlightError, LinkError
from jfto_mavlink.fleet.fly import (
    PREPARE_S,
    Fleet,
    check_fleet,
    set_parameters,
    start_together,
)
from jfto_mavlink.fleet.orders import FleetOrders, OrderSettings, in_flight
from jfto_mavlink.flight.control import StartLine, return_home
from jfto_mavlink.flight.follow import Progressed
from jfto_mavlink.guided.curve_clock import CurveClock
from jfto_mavlink.guided.curves import AWAITED_S, Curves
from jfto_mavlink.guided.flight import GuidedFlight, Surroundings
from jfto_mavlink.guided.held import HeldFlight
from jfto_mavlink.guided.reference import GuidedLimits, check_flyable
from jfto_mavlink.guided.scheduler import GuidedSettings, Scheduler
from jfto_mavlink.guided.stream import Ended, Streamed, fly, take_off
from jfto_mavlink.guided.target import HeadingPlan, MapFrame
from jfto_mavlink.protocol.command import set_mode
from jfto_mavlink.protocol.exchange import Context, Exchange, wait_for
from jfto_msgs_py.errors import InputError, MessageError
from jfto_msgs_py.records.event import ERROR, WARN, Event
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_msgs_py.types import Array
from jfto_world.terrain.frame import LocalFrame

STOP_WAIT_S = 4.0
# From the hover of the last one until all begin their curves.
BEGIN_S = 1.0
# How long a bridge that is started in mid-flight waits to hear who flies.
HEARD_WAIT_S = 6.0
GUIDED = MODES["GUIDED"]
_STANDING = (MODES["BRAKE"], GUIDED, MODES["LOITER"])


class GuidedOrders(FleetOrders):
    """Streams trajectories, which `take` brings in from another thread; missions take them home.

    `now_ns` is the graph's time. `state_file` is where the flight's state is kept, None: nowhere.
    """

    guided = True

    def __init__(
        self,
        fleet: Fleet,
        settings: OrderSettings,
        plan: Plan,
        now_ns: Callable[[], int],
        guided: GuidedSettings | None = None,
        state_file: Path | None = None,
        tell: Callable[[Event], None] = lambda _event: None,
    ) -> None:
        super().__init__(fleet, settings)
        self._now_ns, self._guided, self._tell = now_ns, guided or GuidedSettings(), tell
        self._uavs = {uav.id: uav for uav in plan.uavs}
        self._horizon_s = plan.slots.horizon_s
        by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
        self._headings = {
            uav.id: HeadingPlan(
                route.arrival_s, tuple(by_id[i].yaw_deg for i in route.waypoint_ids)
            )
            for uav, route in zip(plan.uavs, plan.routes, strict=True)
        }
        frame = LocalFrame(plan.origin)
        self._maps = {u: MapFrame(frame, m.home_deg_m[2]) for u, m in self.missions.items()}
        self._curves = Curves(tuple(self.missions), self._check_flyable)
        self._held = HeldFlight(state_file)
        self._flight: GuidedFlight | None = None
        self._schedulers: dict[str, Scheduler] = {}
        self._streams: dict[str, Future[Ended]] = {}
        # Where all were told to be when they were told to hold.
        self._paused_s: float | None = None

    def take(self, uav: str, trajectory: TimedTrajectory) -> None:
        """A trajectory has come; one that cannot be flown raises MissionError, and is not."""
        if not self._curves.take(uav, trajectory):
            return
        newest = self._curves.newest
        self._curves.hold(newest)
        if self._running() and trajectory.start_ns - self._now_ns() < AWAITED_S * 1e9:
            assert self._flight is not None
            self._flight.replace(newest)

    def streaming(self, uav: str) -> str:
        """What the stream of a vehicle does, in words."""
        future = self._streams.get(uav)
        if future is None:
            return "not started"
        if not future.done():
            return "streaming"
        return str(future.exception() or future.result().why)

    def begun_ns(self, flown_ns: Callable[[], int | None]) -> int | None:  # noqa: ARG002
        """Time zero of the flight, None while it has none."""
        return None if self._flight is None else self._flight.zero_ns

    def progressed(self) -> Progressed | None:
        """Time zero (ns) and how far along the curves the fleet is, s; None before it begins."""
        elapsed_s = None if self._flight is None else self._flight.elapsed_s()
        if self._flight is None or elapsed_s is None:
            return None
        return Progressed(self._flight.zero_ns, elapsed_s)

    def start(self) -> str:
        """Check, arm, take off together and stream; returns when all are on their way."""
        with self._start_order():
            self._curves.require()
            self._check_near({uav: np.array(each.start_m) for uav, each in self._uavs.items()})
            release = self._release or self._read_back()
            check_fleet(self.fleet, release, self.settings.gate)
            set_parameters(self.fleet)
            self._flight = None
            line = StartLine(dict.fromkeys(self.missions, self.fleet.runner.clock() + PREPARE_S))
            self._begun(line)
            height_m = self._guided.take_off_m
            start_together(self.fleet, line, lambda context: take_off(context, line, height_m))
            if self._aborted:
                raise FlightError(601, "start called off, because the operator aborted.")
            self._fly(CurveClock(self.fleet.runner.clock() + BEGIN_S), self._zero_in(BEGIN_S))
            self._begin(self.missions)
            return f"streaming: {', '.join(self.missions)}"

    def pause(self) -> str:
        """Stop every stream, and its vehicle with it."""
        with self._order("pause"):
            chosen = self._running()
            if not chosen:
                raise FlightError(601, "No vehicle is being streamed to.")
            self._pause(chosen, "paused by the operator")
            return f"holding: {', '.join(chosen)}"

    def resume(self) -> str:
        """Stream again to the vehicles that hold, from where they stand along their curves."""
        with self._order("resume"):
            flight, paused_s = self._flight, self._paused_s
            if flight is None or paused_s is None:
                raise FlightError(601, "Nothing was paused that could go on.")
            chosen = self._flying(lambda v: v.mode in _STANDING)
            results = self.fleet.runner.run(
                {uav: lambda context: set_mode(context, GUIDED) for uav in chosen},
                self.fleet.report,
            )
            failed = [str(r) for r in results.values() if isinstance(r, Exception)]
            ready = [u for u, r in results.items() if not isinstance(r, Exception)]
            self._go_on(ready, paused_s, "after a pause")
            if failed:
                raise FlightError(603, " ".join(failed))
            return f"streaming: {', '.join(chosen)}"

    def called_off(self) -> None:
        """Streams end without a stop of their own: other orders follow."""
        for scheduler in self._schedulers.values():
            scheduler.leave("called off by the operator")
        super().called_off()

    def pick_up(self) -> None:
        """Go on with the flight that an earlier run of this program began, if there is one.

        Whoever cannot go on holds and is called home, and everybody is told.
        """
        try:
            state = self._held.state()
            curves = {} if state is None else self._held.curves()
        except (InputError, MessageError) as error:
            state, curves = None, {}
            self._tell(Event(WARN, "guided", "", " ".join(str(error).split())))
        found = self.fleet.runner.run(dict.fromkeys(self.missions, _mode_in_the_air))
        flying = [uav for uav, mode in found.items() if mode == GUIDED]
        holding = [uav for uav, mode in found.items() if mode == MODES["BRAKE"]]
        if not flying + holding or self._flight is not None:
            return
        if state is None or set(curves) != set(self.missions):
            self._call_home(flying + holding, "nothing is kept of a flight to go on with")
            return
        self._curves.hold(curves)
        gone_s = max((self._now_ns() - state.zero_ns) / 1e9, 0.0)
        self._fly(CurveClock(self.fleet.runner.clock() - gone_s), state.zero_ns)
        self._paused_s = state.elapsed_s
        if state.paused:
            self.held = True
            assert self._flight is not None
            self._flight.keep(paused=True)
            text = f"{', '.join(flying + holding)} hold: order resume, or home."
            self._tell(Event(WARN, "guided", "", text))
            return
        self.fleet.runner.run(dict.fromkeys(holding, partial(set_mode, mode=GUIDED)))
        self._go_on(flying + holding, state.elapsed_s, "the bridge was started again")

    def close(self) -> None:
        """Stop all vehicles that are streamed to, before the bridge goes."""
        running = self._running()
        if running:
            # The next bridge goes on: no operator has ordered them to hold.
            self._pause(running, "the bridge ends", by_order=False)

    def _pause(self, uavs: list[str], reason: str, *, by_order: bool = True) -> None:
        flight = self._flight
        assert flight is not None
        self._paused_s, self.held = flight.elapsed_s() or 0.0, by_order
        for uav in uavs:
            self._schedulers[uav].halt(reason)
        flight.stand(by_order=by_order)
        ended = wait([self._streams[uav] for uav in uavs], STOP_WAIT_S)
        errors = [str(f.exception()) for f in ended.done if f.exception() is not None]
        if ended.not_done or errors:
            raise FlightError(603, " ".join(["Not all are seen to hold.", *errors]))

    def _go_on(self, uavs: list[str], stopped_s: float, why: str) -> None:
        """Stream to those who stand, from where they stand."""
        assert self._flight is not None
        self._streams = {uav: f for uav, f in self._streams.items() if uav not in uavs}
        self._streams |= {uav: Future() for uav in uavs}
        self._flight.go_on(self.fleet.runner.clock() + BEGIN_S, stopped_s, why)
        self._paused_s, self.held = None, False
        self._begin(uavs)

    def _fly(self, clock: CurveClock, zero_ns: int) -> None:
        """A flight on the curves held."""
        around = Surroundings(self.fleet.runner.clock, self._now_ns, self._where, self._tell)
        held = Curves(tuple(self.missions), self._check_flyable)
        held.hold(self._curves.held)
        self._flight = GuidedFlight(held, clock, zero_ns, self._guided, around, self._held)
        self._flight.keep_curves()
        self._flight.keep()

    def _zero_in(self, seconds: float) -> int:
        return self._now_ns() + round(seconds * 1e9)

    def _begin(self, uavs: Iterable[str]) -> None:
        flight = self._flight
        assert flight is not None
        for uav in uavs:
            mission = self.missions[uav]
            hover = self._maps[uav].position_m(*mission.home_deg_m[:2], self._guided.take_off_m)
            scheduler = self._schedulers[uav] = Scheduler(self._guided, float(hover[2]))
            streamed = Streamed(
                mission,
                self._maps[uav],
                self._headings[uav],
                partial(flight.curve, uav),
                flight.progress,
                # Planned ways home begin at the horizon, when all have waited for the last.
                lambda: max(flight.curves.end_s, self._horizon_s),
                self._tell,
                self._guided,
            )
            job = partial(fly, streamed=streamed, scheduler=scheduler)
            self._streams[uav] = self.fleet.runner.start(uav, job, self.fleet.report)
            self._streams[uav].add_done_callback(partial(self._ended, uav))

    def _ended(self, uav: str, stream: Future[Ended]) -> None:
        """A stream has ended: with the last one the flight is over, unless it is only held.

        One that has failed leaves a vehicle that hovers: it is called home, and that is told.
        """
        error = None if stream.cancelled() else stream.exception()
        if error is not None and not isinstance(error, LinkError):
            text = " ".join(f"{uav} is streamed to no more: {error} It is called home.".split())
            self._tell(Event(ERROR, "guided", uav, text))
            self.fleet.runner.start(uav, return_home, self.fleet.report)
        if self._flight is not None and self._paused_s is None and not self._running():
            self._flight.keep(over=True)

    def _running(self) -> list[str]:
        return [uav for uav, future in self._streams.items() if not future.done()]

    def _call_home(self, uavs: list[str], why: str) -> None:
        text = f"{', '.join(uavs)} not flown on along the trajectories, {why}: called home."
        self._tell(Event(ERROR, "guided", "", text))
        self.fleet.runner.run(dict.fromkeys(uavs, return_home), self.fleet.report)

    def _check_near(self, places_m: dict[str, Array]) -> None:
        for uav, place_m in places_m.items():
            begins_m = self._curves.places(uav, np.array([0.0]))[0]
            away_m = float(np.linalg.norm(begins_m - place_m))
            if away_m > self._guided.join_max_m:
                raise FlightError(
                    601,
                    f"{uav}: its trajectory begins {away_m:.0f} m away. Plan anew, from where the "
                    "vehicles stand.",
                )

    def _where(self) -> dict[str, Array]:
        """Where those who are streamed to are, by their last positions."""
        here = {}
        for uav in self._running():
            vehicle = self.fleet.runner.vehicle(uav)
            if vehicle.position_s is not None:
                place = (vehicle.lat_deg, vehicle.lon_deg, vehicle.height_m)
                here[uav] = self._maps[uav].position_m(*place)
        return here

    def _check_flyable(self, uav: str, curve: TimedTrajectory) -> None:
        limits = self._uavs[uav]
        check_flyable(
            uav, curve, GuidedLimits(limits.speed_mps, limits.climb_mps, limits.descent_mps)
        )


def _mode_in_the_air(context: Context) -> Exchange[int | None]:
    """The mode of a vehicle in flight; None for one on the ground, or silent."""
    vehicle = context.vehicle

    def known() -> bool:
        return None not in (vehicle.heartbeat_s, vehicle.landed_state, vehicle.position_s)

    if not (yield from wait_for(context, known, HEARD_WAIT_S)):
        return None
    return vehicle.mode if in_flight(vehicle) else None
