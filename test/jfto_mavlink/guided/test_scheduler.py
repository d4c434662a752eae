"""Targets and reasons to stop, without a vehicle."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_mavlink.errors import MissionError
from jfto_mavlink.guided.curve_clock import RAMP_S, CurveClock, Progress
from jfto_mavlink.guided.reference import (
    JOIN_MPS,
    JOIN_MPS2,
    GuidedLimits,
    Joining,
    Reference,
    check_flyable,
    reference,
)
from jfto_mavlink.guided.scheduler import GuidedSettings, Scheduler
from jfto_mavlink.guided.target import TURN_DPS, EkfFrame, HeadingPlan, MapFrame
from jfto_msgs_py.records.plan import Origin
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_world.terrain.frame import LocalFrame

START_NS = 1_763_776_800 * 10**9


def at(seconds: float) -> np.ndarray:
    return np.array([START_NS + round(seconds * 1e9)])


def polynomial(times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A quintic per axis with its derivatives."""
    curves = [np.polynomial.Polynomial(c) for c in ([0, 1, 0.2, -0.01, 1e-3, -1e-5], [5, -1], [9])]
    return tuple(np.stack([c.deriv(n)(times) for c in curves], axis=1) for n in (0, 1, 2))


def straight(*points, seconds: float = 20.0) -> TimedTrajectory:
    """Straight legs of equal duration, as a planner without smoothing gives them."""
    position = np.array(points, dtype=float)
    offsets = np.rint(np.arange(len(points)) * seconds * 1e9).astype(np.int64)
    velocity = np.zeros_like(position)
    velocity[:-1] = np.diff(position, axis=0) / seconds
    return TimedTrajectory(START_NS, offsets, position, velocity, np.zeros_like(position))


def ahead(floor_m: float = 0.0) -> Scheduler:
    """A scheduler of a vehicle that hovers."""
    return Scheduler(GuidedSettings(), floor_m)


def along(seconds: float) -> Progress:
    """Full speed, begun at 0 s."""
    return Progress(max(seconds, 0.0), begun=seconds >= 0)


def run(scheduler, trajectory, times, start=(0.0, 0.0, 0.0), *, follows=True, progress=along):
    """Steps at the given times; the vehicle is where it was told to be, or stays at its start."""
    here, steps = np.array(start), []
    for seconds in times:
        steps.append(scheduler.step(seconds, trajectory, progress(seconds), here, 0.1))
        if follows and steps[-1].target is not None:
            here = steps[-1].target.position_m
    return steps


def test_between_close_samples_a_quintic_is_exact():
    """Position, velocity and acceleration at any instant, from samples half a second apart."""
    times = np.arange(0.0, 10.1, 0.5)
    trajectory = TimedTrajectory(START_NS, np.rint(times * 1e9).astype(int), *polynomial(times))
    dense = np.linspace(0.0, 10.0, 137)
    found = reference(trajectory, START_NS + np.rint(dense * 1e9).astype(np.int64))
    wanted = polynomial(dense)
    assert np.allclose(found.position_m, wanted[0], atol=1e-6)
    assert np.allclose(found.velocity_mps, wanted[1], atol=1e-6)
    assert np.allclose(found.acceleration_mps2, wanted[2], atol=1e-5)


def test_between_far_samples_it_is_straight_and_outside_at_rest():
    """Legs are meant as straight; before lift-off and after the end nothing moves."""
    trajectory = straight((0, 0, 50), (100, 0, 50), (100, 60, 50))
    middle = reference(trajectory, at(10.0))
    assert np.allclose(middle.position_m, [[50, 0, 50]])
    assert np.allclose(middle.velocity_mps, [[5, 0, 0]])
    for seconds, place in ((-5.0, (0, 0, 50)), (41.0, (100, 60, 50))):
        found = reference(trajectory, at(seconds))
        assert np.allclose(found.position_m, [place])
        assert not found.velocity_mps.any()


def test_a_corner_at_full_speed_is_refused():
    """It would be overshot by tens of metres."""
    corner = straight((0, 0, 50), (100, 0, 50), (100, 100, 50))
    with pytest.raises(MissionError, match=r"uav1: .* m/s² at .*smoothed") as caught:
        check_flyable("uav1", corner, GuidedLimits())
    assert caught.value.code == 303


def test_too_fast_is_refused():
    """Targets are not limited by the autopilot, so they must be right."""
    with pytest.raises(MissionError, match=r"12.5 m/s at"):
        check_flyable("uav1", straight((0, 0, 9), (250, 0, 9)), GuidedLimits(speed_mps=10.0))


def test_joining_is_smooth_and_gentle():
    """From the offset to none, with at most the speed and acceleration that it may add."""
    still = Reference(np.zeros(3), np.zeros(3), np.zeros(3))
    joining = Joining.begin(3.0, np.array([20.0, -15.0, 0.0]))
    times = np.linspace(3.0, 3.0 + joining.duration_s, 400)
    found = [joining.applied(still, t) for t in times]
    position = np.array([f.position_m for f in found])
    velocity = np.array([f.velocity_mps for f in found])
    assert np.allclose(position[0], [20.0, -15.0, 0.0])
    assert np.allclose(position[-1], 0.0, atol=1e-9)
    assert np.linalg.norm(velocity, axis=1).max() <= JOIN_MPS + 1e-6
    assert max(np.linalg.norm(f.acceleration_mps2) for f in found) <= JOIN_MPS2 + 1e-3
    slope = np.gradient(position, times, axis=0)
    assert np.allclose(slope[1:-1], velocity[1:-1], atol=0.02)


def test_nothing_is_sent_before_lift_off():
    """The vehicle hovers by itself."""
    steps = run(ahead(), straight((0, 0, 0), (50, 0, 0)), [-2.0, -1.0, -0.1])
    assert all(step.target is None and not step.stop for step in steps)


def test_beside_the_pad_it_does_not_sink_below_the_hover():
    """The trajectory begins on the ground; the vehicle waits above until it has left the pad."""
    scheduler, curve = ahead(floor_m=10.0), straight((0, 0, 0), (60, 0, 0), seconds=30.0)
    times, start = np.arange(0.0, 30.0, 0.1), np.array([0.0, 0.0, 10.0])
    targets = np.array([s.target.position_m for s in run(scheduler, curve, times, start)])
    beside = targets[:, 0] < 19.9
    assert (targets[beside, 2] > 9.99).all()
    assert np.abs(np.diff(targets[:, 2])).max() < 0.1
    assert targets[-1, 2] < 9.0


def test_without_positions_it_goes_on_by_its_own_clock():
    """Nothing was heard for a minute: targets go on along the curve, and nobody is astray."""
    scheduler, curve = ahead(), straight((0, 0, 0), (50, 0, 0))
    run(scheduler, curve, np.arange(0.0, 5.05, 0.1))
    step = scheduler.step(15.0, curve, along(15.0), np.zeros(3), 60.0)
    assert not step.stop
    assert step.target.position_m[0] == pytest.approx(37.5, abs=0.01)


def test_a_fleet_that_stood_goes_on_from_there_slowly_and_is_later_for_good():
    """The clock's speed grows from 0 to 1 without a jump; lateness is what was lost."""
    clock = CurveClock(100.0)
    assert not clock.at(99.0).begun
    assert clock.at(112.0).elapsed_s == 12.0
    clock.go_on(120.0, 13.0)
    times = np.arange(120.0, 120.0 + RAMP_S + 1.0, 0.01)
    found = [clock.at(now_s) for now_s in times]
    elapsed, rate = np.array([p.elapsed_s for p in found]), np.array([p.rate for p in found])
    assert elapsed[0] == 13.0
    assert rate[0] == 0.0
    assert rate[-1] == 1.0
    assert np.allclose(np.gradient(elapsed, times)[1:-1], rate[1:-1], atol=1e-3)
    assert np.allclose(np.gradient(rate, times)[1:-1], [p.growth for p in found[1:-1]], atol=0.02)
    assert clock.late_s(130.0) == pytest.approx(20.0 - 13.0 + RAMP_S / 2)


def test_going_on_begins_where_the_vehicle_stands():
    """It was swept 8 m on before it stood: the first target is there, at rest."""
    scheduler, curve = ahead(), straight((0, 0, 0), (100, 0, 0))
    run(scheduler, curve, np.arange(0.0, 8.0, 0.1))
    clock = CurveClock(0.0)
    clock.go_on(12.0, 8.0)
    here = np.array([40.0, 8.0, 0.0])
    step = scheduler.step(12.0, curve, clock.at(12.0), here, 0.1)
    assert np.allclose(step.target.position_m, here)
    assert np.allclose(step.target.velocity_mps, 0.0)


def test_a_vehicle_that_does_not_follow_is_stopped():
    """It stays where it is while the target goes on."""
    steps = run(ahead(), straight((0, 0, 0), (200, 0, 0)), np.arange(0.0, 4.0, 0.1), follows=False)
    assert "from where it should be" in steps[-1].stop


def test_a_new_trajectory_is_joined_without_a_jump():
    """Five metres to the side, in mid-flight."""
    scheduler = ahead()
    before = run(scheduler, straight((0, 0, 0), (100, 0, 0)), np.arange(0.0, 8.0, 0.1))
    here, newer = before[-1].target.position_m, straight((0, 5, 0), (100, 5, 0))
    for seconds in np.arange(8.0, 19.0, 0.1):
        target = scheduler.step(seconds, newer, along(seconds), here, 0.1).target.position_m
        assert np.linalg.norm(target - here) < 0.75
        here = target
    assert here[1] == pytest.approx(5.0, abs=0.01)


def test_headings_turn_the_short_way_and_stay():
    """From 350 to 20 degrees through north."""
    plan = HeadingPlan((10.0, 20.0), (350.0, 20.0))
    assert plan.at(0.0) == (350.0, 0.0)
    yaw, rate = plan.at(10.0 + 20.0 / TURN_DPS)
    assert (yaw, rate) == (pytest.approx(10.0), TURN_DPS)
    assert plan.at(15.0) == (20.0, 0.0)
    assert plan.at(500.0) == (20.0, 0.0)
    assert HeadingPlan((), ()).at(3.0) is None


def test_targets_are_about_the_autopilots_own_origin():
    """Origin elsewhere, home above it, another datum: a point above the pad is above the pad."""
    frame = LocalFrame(Origin(47.4, 8.5, 440.0))
    pad = np.array([300.0, -200.0, 25.0])
    lat, lon, alt = (float(v) for v in frame.to_geodetic(pad))
    view = MapFrame(frame, alt)
    # 100 units of 1e-7 degree north of the pad is where the EKF began; home is 3 m above it.
    ekf = EkfFrame(view, (lat + 1e-5, lon, 485.0), 488.0)
    north, east, down = ekf.position_ned_m(pad + np.array([0.0, 0.0, 10.0]))
    assert north == pytest.approx(-100 * 0.011131884502145034, abs=1e-3)
    assert east == pytest.approx(0.0, abs=1e-3)
    assert down == pytest.approx(-13.0, abs=1e-3)
    assert view.position_m(lat, lon, 10.0) == pytest.approx(pad + np.array([0, 0, 10]), abs=1e-3)
