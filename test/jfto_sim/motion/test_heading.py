"""How long turns take, and which way they go."""

import pytest

from jfto_sim import Vehicle
from jfto_sim.geodesy import wrap_180
from jfto_sim.motion.heading import Heading, YawMode
from support.pilot import Pilot


@pytest.mark.parametrize(
    ("angle", "measured_s"), [(30, 0.9), (60, 1.25), (90, 2.1), (120, 2.6), (150, 3.1), (180, 3.3)]
)
def test_turns_take_as_long_as_measured(angle, measured_s):
    """CONDITION_YAW at the default rate, to within 5 degrees, 0.35 s either way."""
    pilot = Pilot(Vehicle())
    pilot.take_off(10.0)
    pilot.command(115, angle, 0, 1, 0)
    begun = pilot.vehicle.time_s
    while abs(wrap_180(pilot.vehicle.body.yaw_deg - angle)) > 5:
        pilot.run(0.02)
    assert pilot.vehicle.time_s - begun == pytest.approx(measured_s, abs=0.35)


@pytest.mark.parametrize(
    ("direction", "relative", "angle", "end"),
    [(1, False, 350, 350), (-1, False, 10, 10), (0, False, 350, 350), (-1, True, 30, 330)],
)
def test_direction(direction, relative, angle, end):
    """Clockwise, counter-clockwise, the short way, and relative to where it points."""
    heading = Heading(0.0)
    heading.turn_to(angle, 60.0, direction, relative=relative)
    swept = 0.0
    for _ in range(400):
        before = heading.demand_deg
        heading.step((0.0, 0.0), (0.0, 0.0), 0.02)
        swept += wrap_180(heading.demand_deg - before)
    assert heading.demand_deg == pytest.approx(end)
    if direction:
        assert swept * direction > 0
    assert heading.reached(end)


def test_along_track_keeps_the_heading_at_rest():
    """A target that hardly moves does not turn the nose."""
    heading = Heading(45.0)
    heading.follow_track()
    heading.step((0.0, 0.0), (0.1, -0.1), 1.0)
    assert heading.demand_deg == 45.0
    assert heading.mode is YawMode.ALONG_TRACK
