"""Guided streams in virtual time: a simulated vehicle follows, and is stopped on purpose."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_mavlink.dialect import MODES
from jfto_mavlink.flight.control import StartLine
from jfto_mavlink.guided.curve_clock import CurveClock
from jfto_mavlink.guided.reference import GuidedLimits, check_flyable, reference
from jfto_mavlink.guided.scheduler import GuidedSettings, Scheduler
from jfto_mavlink.guided.stream import Ending, Streamed, ekf_frame, fly, stream, take_off
from jfto_mavlink.guided.target import HeadingPlan, MapFrame
from jfto_mavlink.protocol.command import set_mode
from jfto_msgs_py.records.event import ERROR
from jfto_msgs_py.records.plan import Origin
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_sim import LinkFaults, Vehicle, VehicleConfig
from jfto_world.terrain.frame import LocalFrame
from support.rehearsal import Rehearsal

START_NS = 1_763_776_800 * 10**9
# The plan's origin is not where the vehicle stands, and its heights are in another datum.
ORIGIN = Origin(47.397742, 8.545594, 440.0)
PAD_M = np.array([300.0, -200.0, 25.0])
HOME_ALT_M = 488.1
HOVER_M = 10.0


def curve(duration_s: float = 50.0, sample_s: float = 0.5) -> TimedTrajectory:
    """A bend of 170 m with a climb of 12 m: minimum jerk along it, up to 6.4 m/s."""
    times = np.arange(0.0, duration_s + sample_s / 2, sample_s)
    u = times / duration_s
    share = u**3 * (10 - 15 * u + 6 * u**2)
    rate = 30 * u**2 * (1 - u) ** 2 / duration_s
    bend = 60 * u * (1 - u) * (1 - 2 * u) / duration_s**2
    radius, turn = 80.0, 2.0
    angle = turn * share
    position = np.stack(
        [radius * np.sin(angle), radius * (1 - np.cos(angle)), HOVER_M + 12.0 * share], axis=1
    )
    tangent = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(u)], axis=1)
    normal = np.stack([-np.sin(angle), np.cos(angle), np.zeros_like(u)], axis=1)
    up = np.array([0.0, 0.0, 12.0])
    velocity = radius * turn * rate[:, None] * tangent + rate[:, None] * up
    acceleration = radius * turn * bend[:, None] * tangent + bend[:, None] * up
    acceleration += radius * (turn * rate[:, None]) ** 2 * normal
    return TimedTrajectory(
        START_NS, np.rint(times * 1e9).astype(np.int64), position + PAD_M, velocity, acceleration
    )


class Flight:
    """One simulated vehicle that hovers above its pad, ready for targets."""

    def __init__(self, **extra) -> None:
        self.frame = LocalFrame(ORIGIN)
        lat, lon, alt = self.frame.to_geodetic(PAD_M)
        config = VehicleConfig(
            home_lat_deg=float(lat), home_lon_deg=float(lon), home_alt_m=HOME_ALT_M
        )
        self.sim = Vehicle(config)
        self.said: list[str] = []
        self.told: list = []
        self.runner = Rehearsal({"uav1": self.sim}, step_s=0.01, **extra)
        self.runner.advance(45.0)
        self.map = MapFrame(self.frame, float(alt))
        self.scheduler = Scheduler(GuidedSettings(), float(PAD_M[2]) + HOVER_M)
        line = StartLine({"uav1": self.runner.now_s + 5.0})
        self.do(lambda context: take_off(context, line, HOVER_M))
        self.ekf = self.do(lambda context: ekf_frame(context, self.map))
        self.lift_off_s = self.runner.now_s + 2.0

    def do(self, job):
        """Result of one conversation; its error is raised."""
        result = self.runner.run({"uav1": job}, self._report)["uav1"]
        if isinstance(result, Exception):
            raise result
        return result

    def begin(
        self, trajectory: TimedTrajectory, heading: HeadingPlan | None = None, *, whole=False
    ):
        """Stream a trajectory; with what follows the stream where it is `whole`."""
        clock = CurveClock(self.lift_off_s)
        streamed = Streamed(
            None, self.map, heading, lambda: trajectory, clock.at,
            lambda: trajectory.offset_ns[-1] / 1e9, self.told.append, GuidedSettings(),
        )  # fmt: skip
        return self.runner.start(
            "uav1",
            lambda context: (
                fly(context, streamed, self.scheduler)
                if whole
                else stream(context, streamed, self.scheduler, self.ekf)
            ),
            self._report,
        )

    def now_ns(self) -> int:
        return START_NS + round((self.runner.now_s - self.lift_off_s) * 1e9)

    def fly_for(self, duration_s: float) -> np.ndarray:
        """Let time pass; returns errors to the curve, m, 10 times a second."""
        errors = []
        until_s = self.runner.now_s + duration_s
        while self.runner.now_s < until_s:
            self.runner.advance(0.1)
            wanted = reference(curve(), np.array([self.now_ns()])).position_m[0]
            errors.append(np.linalg.norm(self.where_m() - wanted))
        return np.array(errors)

    def where_m(self) -> np.ndarray:
        """True position in the map: what the simulator knows, not what it reports."""
        lat, lon, _ = self.sim.flight.position.reported()
        return self.map.position_m(lat / 1e7, lon / 1e7, self.sim.body.position_m[2])

    def speed_mps(self) -> float:
        return float(np.linalg.norm(self.sim.body.velocity_mps))

    def _report(self, _uav, step) -> None:
        self.said.append(step.text)


def test_a_vehicle_tracks_a_smooth_curve_within_a_metre():
    """Also where the plan's origin and datum are not the autopilot's; in the end it hovers."""
    flight = Flight()
    check_flyable("uav1", curve(), GuidedLimits())
    activity = flight.begin(curve())
    flight.fly_for(2.0)
    errors = flight.fly_for(49.5)
    print(f"rms {np.sqrt(np.mean(errors**2)):.2f} m, max {errors.max():.2f} m")
    assert np.sqrt(np.mean(errors**2)) < 1.0
    flight.fly_for(2.0)
    assert flight.runner.until(lambda: activity.done, 10.0)
    assert activity.result.how == Ending.OVER
    assert flight.runner.vehicle("uav1").mode == MODES["GUIDED"]
    end_m = curve().position_m[-1]
    assert np.linalg.norm(flight.where_m() - end_m) < 1.0


def test_a_lossy_link_does_not_matter():
    """10 % of the targets lost."""
    flight = Flight(to_vehicle=LinkFaults(loss=0.1), from_vehicle=LinkFaults(loss=0.1), seed=4)
    flight.begin(curve())
    flight.fly_for(2.0)
    errors = flight.fly_for(30.0)
    assert np.sqrt(np.mean(errors**2)) < 1.0


def test_a_stream_that_is_halted_stops_the_vehicle_on_purpose():
    """At rest in BRAKE before GUID_TIMEOUT would have let it go on for 3 s."""
    flight = Flight()
    activity = flight.begin(curve())
    flight.fly_for(25.0)
    assert flight.speed_mps() > 5.0
    flight.scheduler.halt("paused by the operator")
    assert flight.runner.until(lambda: flight.sim.mode.number == MODES["BRAKE"], 1.5)
    assert flight.runner.until(lambda: activity.done, 10.0)
    assert activity.result.how == Ending.HELD
    assert flight.runner.until(lambda: flight.speed_mps() < 0.1, 10.0)


def test_a_pilot_who_takes_over_is_left_alone():
    """Out of GUIDED no target and no BRAKE is sent."""
    flight = Flight()
    activity = flight.begin(curve())
    flight.fly_for(10.0)
    flight.do(lambda context: set_mode(context, MODES["LOITER"]))
    assert flight.runner.until(lambda: activity.done, 3.0)
    assert "LOITER" in activity.result.why
    assert activity.result.how == Ending.LEFT
    flight.runner.advance(5.0)
    assert flight.sim.mode.number == MODES["LOITER"]


def test_a_trajectory_far_away_is_not_joined():
    """Nobody knows what stands in between: it holds, is called home, and everybody is told."""
    flight = Flight()
    far = curve()
    moved = TimedTrajectory(
        START_NS,
        far.offset_ns,
        far.position_m + np.array([60.0, 0.0, 0.0]),
        far.velocity_mps,
        far.acceleration_mps2,
    )
    activity = flight.begin(moved, whole=True)
    flight.fly_for(4.0)
    assert flight.sim.mode.number == MODES["BRAKE"]
    (told,) = flight.told
    assert told.level == ERROR
    assert "its trajectory is 60 m away. It holds, and is called home in 5 s" in told.text
    assert np.linalg.norm(flight.where_m() - PAD_M - [0.0, 0.0, HOVER_M]) < 1.0
    assert flight.runner.until(lambda: activity.done, 20.0)
    assert activity.result.how == Ending.UNABLE
    assert flight.sim.mode.number == MODES["RTL"]


def test_the_vehicle_looks_where_the_photos_want_it():
    """Yaw and yaw rate are streamed with the targets."""
    flight = Flight()
    flight.begin(curve(), HeadingPlan((10.0, 25.0, 40.0), (20.0, 110.0, 350.0)))
    flight.fly_for(24.0)
    assert flight.sim.body.yaw_deg == pytest.approx(110.0, abs=2.0)
    flight.fly_for(15.0)
    assert (flight.sim.body.yaw_deg - 350.0 + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=2.0)
