"""Orders to a fleet that is flown by streamed trajectories."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, wait

import numpy as np

from jfto_mavlink.dialect import MODES
from jfto_mavlink.errors import FlightError, MissionError
from jfto_mavlink.fleet.fly import PREPARE_S, Fleet, start_together
from jfto_mavlink.fleet.orders import FleetOrders, OrderSettings
from jfto_mavlink.flight.control import StartLine
from jfto_mavlink.flight.preflight import wait_ready
from jfto_mavlink.guided.reference import GuidedLimits, check_flyable, reference
from jfto_mavlink.guided.scheduler import GuidedSettings, Scheduler
from jfto_mavlink.guided.stream import ekf_frame, stream, take_off
from jfto_mavlink.guided.target import HeadingPlan, MapFrame
from jfto_mavlink.protocol.command import set_mode
from jfto_mavlink.protocol.exchange import Context, Exchange
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_world.terrain.frame import LocalFrame

# From the order to take off until the hover, 10 m up.
TAKE_OFF_S = 14.0
STOP_WAIT_S = 4.0
GUIDED = MODES["GUIDED"]


class GuidedOrders(FleetOrders):
    """Streams trajectories; `take` and `confirm` bring them in from another thread.

    `now_ns` is the time that their stamps are in.
    """

    def __init__(
        self,
        fleet: Fleet,
        settings: OrderSettings,
        plan: Plan,
        now_ns: Callable[[], int],
        guided: GuidedSettings | None = None,
    ) -> None:
        super().__init__(fleet, settings)
        self._now_ns, self._guided = now_ns, guided or GuidedSettings()
        self._uavs = {uav.id: uav for uav in plan.uavs}
        by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
        self._headings = {
            uav.id: HeadingPlan(
                route.arrival_s, tuple(by_id[i].yaw_deg for i in route.waypoint_ids)
            )
            for uav, route in zip(plan.uavs, plan.routes, strict=True)
        }
        frame = LocalFrame(plan.origin)
        self._maps = {u: MapFrame(frame, m.home_deg_m[2]) for u, m in self.missions.items()}
        self._trajectories: dict[str, TimedTrajectory] = {}
        self._schedulers: dict[str, Scheduler] = {}
        self._streams: dict[str, Future[str]] = {}

    def take(self, uav: str, trajectory: TimedTrajectory) -> None:
        """A trajectory has come; one that cannot be flown ends the stream of that vehicle."""
        scheduler = self._schedulers.get(uav)
        try:
            check_flyable(uav, trajectory, self._limits(uav))
        except MissionError as error:
            if scheduler is not None:
                scheduler.halt(str(error))
            raise
        finally:
            self._trajectories[uav] = trajectory
        if scheduler is not None:
            scheduler.take(trajectory, self.fleet.runner.clock())

    def confirm(self, uav: str) -> None:
        """The source of a vehicle's trajectory is still there."""
        scheduler = self._schedulers.get(uav)
        if scheduler is not None:
            scheduler.confirm(self.fleet.runner.clock())

    def streaming(self, uav: str) -> str:
        """What the stream of a vehicle does, in words."""
        future = self._streams.get(uav)
        if future is None:
            return "not started"
        if not future.done():
            return "streaming"
        return str(future.exception() or future.result())

    def check(self) -> str:
        """Hold every vehicle at the gate before arming, and arm none; no mission is asked for."""
        with self._order("check"):
            self._check_ready()
            return f"ready to arm: {', '.join(self.missions)}"

    def start(self) -> str:
        """Check, arm, take off together and stream; returns when all are on their way."""
        with self._start_order():
            self._check_trajectories()
            self._check_ready()
            # Getting ready may have taken a while.
            self._check_trajectories()
            starts_ns = min(each.start_ns for each in self._trajectories.values())
            ahead_s = (starts_ns - self._now_ns()) / 1e9 - TAKE_OFF_S
            go_s = self.fleet.runner.clock() + max(PREPARE_S, ahead_s)
            line = StartLine(dict.fromkeys(self.missions, go_s))
            self._begun(line)

            height_m = self._guided.take_off_m
            start_together(self.fleet, line, lambda context: take_off(context, line, height_m))
            if self._aborted:
                raise FlightError(601, "start called off, because the operator aborted.")
            for uav, on_map in self._maps.items():
                hover_m = on_map.position_m(*self.missions[uav].home_deg_m[:2], height_m)
                self._begin(uav, float(hover_m[2]))
            return f"streaming: {', '.join(self.missions)}"

    def pause(self) -> str:
        """Stop every stream, and its vehicle with it."""
        with self._order("pause"):
            chosen = [uav for uav, future in self._streams.items() if not future.done()]
            if not chosen:
                raise FlightError(601, "No vehicle is being streamed to.")
            self._stop(chosen, "paused by the operator")
            return f"holding: {', '.join(chosen)}"

    def resume(self) -> str:
        """Stream again to the vehicles that hold, where their trajectory is still near."""
        with self._order("resume"):
            chosen = self._flying(lambda v: v.mode in (MODES["BRAKE"], GUIDED, MODES["LOITER"]))
            for uav in chosen:
                self._check_near(uav, self._here(uav), self._now_ns())
            results = self.fleet.runner.run(
                {uav: lambda context: set_mode(context, GUIDED) for uav in chosen},
                self.fleet.report,
            )
            failed = [str(r) for r in results.values() if isinstance(r, Exception)]
            for uav, result in results.items():
                if not isinstance(result, Exception):
                    self._begin(uav, float("-inf"))
            if failed:
                raise FlightError(603, " ".join(failed))
            return f"streaming: {', '.join(chosen)}"

    def abort(self) -> str:
        """Bring all home, or down; streams end without a stop of their own."""
        for scheduler in self._schedulers.values():
            scheduler.leave("aborted by the operator")
        return super().abort()

    def close(self) -> None:
        """Stop all vehicles that are streamed to, before the bridge goes."""
        running = [uav for uav, future in self._streams.items() if not future.done()]
        if running:
            self._stop(running, "the bridge ends")

    def _stop(self, uavs: list[str], reason: str) -> None:
        for uav in uavs:
            self._schedulers[uav].halt(reason)
        ended = wait([self._streams[uav] for uav in uavs], STOP_WAIT_S)
        errors = [str(f.exception()) for f in ended.done if f.exception() is not None]
        if ended.not_done or errors:
            raise FlightError(603, " ".join(["Not all are seen to hold.", *errors]))

    def _begin(self, uav: str, hover_m: float) -> None:
        scheduler = self._schedulers[uav] = Scheduler(self._guided, hover_m)
        scheduler.take(self._trajectories[uav], self.fleet.runner.clock())

        def job(context: Context) -> Exchange[str]:
            frame = yield from ekf_frame(context, self._maps[uav])
            return (
                yield from stream(
                    context,
                    scheduler,
                    frame,
                    self._headings[uav],
                    lambda: self._trajectories[uav].start_ns,
                    self._now_ns,
                    self._guided.rate_hz,
                )
            )

        self._streams[uav] = self.fleet.runner.start(uav, job, self.fleet.report)

    def _check_ready(self) -> None:
        def job(context: Context) -> Exchange[tuple[str, ...]]:
            home = self.missions[context.uav].home_deg_m[:2]
            return wait_ready(context, home, self.settings.gate)

        self.fleet.check(job)

    def _check_trajectories(self) -> None:
        joined_ns = self._now_ns() + round((PREPARE_S + TAKE_OFF_S) * 1e9)
        missing = [uav for uav in self.missions if uav not in self._trajectories]
        if missing:
            raise FlightError(601, f"{', '.join(missing)}: no trajectory has come yet.")
        for uav, trajectory in self._trajectories.items():
            check_flyable(uav, trajectory, self._limits(uav))
            self._check_near(uav, np.array(self._uavs[uav].start_m), joined_ns)

    def _check_near(self, uav: str, here_m: np.ndarray, at_ns: int) -> None:
        wanted = reference(self._trajectories[uav], np.array([at_ns])).position_m[0]
        away_m = float(np.linalg.norm(wanted - here_m))
        if away_m > self._guided.join_max_m:
            raise FlightError(
                601,
                f"{uav}: its trajectory has gone on and is {away_m:.0f} m away. Plan anew, with a "
                "later lift-off.",
            )

    def begun_ns(self, flown_ns: Callable[[], int | None]) -> int | None:  # noqa: ARG002
        """Time zero of the flight: what is streamed has it in its stamps."""
        return min((each.start_ns for each in self._trajectories.values()), default=None)

    def _here(self, uav: str) -> np.ndarray:
        vehicle = self.fleet.runner.vehicle(uav)
        return self._maps[uav].position_m(vehicle.lat_deg, vehicle.lon_deg, vehicle.height_m)

    def _limits(self, uav: str) -> GuidedLimits:
        limits = self._uavs[uav]
        return GuidedLimits(limits.speed_mps, limits.climb_mps, limits.descent_mps)
