"""The speeds that camera and wind leave."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from jfto.planning.flight import flight_of
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.speeds import fleet_limits, photo_cap_mps, speed_notes
from jfto.planning.survey import Survey
from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.scenario import Scenario
from jfto_world.motion.arducopter import Airframe, WpNav


def _scenario(tiny: Path, *overrides: str) -> Scenario:
    return load_scenario(tiny, overrides).scenario


# 13.2 mm over 5472 px at 8.8 mm and 100 m: 2.741 cm a pixel.
_CAMERA = (
    "camera.sensor_mm=13.2,8.8",
    "camera.focal_length_mm=8.8",
    "camera.image_px=5472,3648",
    "coverage.distance_m=100",
    "camera.exposure_s=0.005",
)


def test_blur_bounds_the_speed_of_photographs(tiny: Path) -> None:
    """Pixel on the ground × blur / exposure; an explicit speed wins, a stop needs none."""
    blur = (*_CAMERA, "trajectory.photo_blur_px=0.8")
    assert photo_cap_mps(_scenario(tiny, *blur)) == pytest.approx(0.027412 * 0.8 / 0.005, rel=1e-4)
    explicit = _scenario(tiny, *blur, "trajectory.photo_speed_mps=3")
    assert photo_cap_mps(explicit) == 3.0
    assert photo_cap_mps(_scenario(tiny, *blur, "trajectory.hold_s=2")) == math.inf
    assert photo_cap_mps(_scenario(tiny, *_CAMERA)) == math.inf


def test_the_distance_follows_from_the_resolution_where_none_is_given(tiny: Path) -> None:
    """4 cm a pixel, half a pixel in 1/500 s: 10 m/s."""
    scenario = _scenario(
        tiny,
        "coverage.distance_m=0",
        "coverage.gsd_cm=4",
        "camera.exposure_s=0.002",
        "trajectory.photo_blur_px=0.5",
    )
    assert photo_cap_mps(scenario) == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("speed", "climb", "descent", "cap"),
    [(5.0, 4.0, 3.0, 3.0), (5.0, 0.5, 0.5, 3.0), (2.0, 4.0, 1.0, 3.0), (9.0, 4.0, 3.0, 8.0)],
)
def test_missions_keep_below_the_photo_speed_on_any_slope(
    tiny: Path, speed: float, climb: float, descent: float, cap: float
) -> None:
    """The autopilot's min(v / cos g, v_z / sin g) never exceeds the cap, and comes near it."""
    scenario = _scenario(
        tiny,
        f"fleet.speed_mps={speed}",
        f"fleet.climb_mps={climb}",
        f"fleet.descent_mps={descent}",
        f"trajectory.photo_speed_mps={cap}",
        "trajectory.angle_max_deg=40",
    )
    limits = fleet_limits(scenario)[0]
    slopes = np.radians(np.linspace(0.01, 89.99, 2000))
    vertical = max(limits.climb_mps, limits.descent_mps)
    along = np.minimum(limits.speed_mps / np.cos(slopes), vertical / np.sin(slopes))
    assert 0.99 * cap < along.max() <= cap + 1e-9
    assert limits.speed_mps >= min(speed, 0.86 * cap) - 1e-9
    assert "for sharp photographs" in speed_notes(scenario)[0]


def test_curves_slow_down_at_waypoints_only(tiny: Path) -> None:
    """In guided flight the cap is the trajectory's, the fleet keeps its speeds."""
    scenario = _scenario(tiny, "trajectory.mode=guided", "trajectory.photo_speed_mps=2")
    rules = flight_of(scenario).rules
    assert rules is not None
    assert rules.cap_mps == 2.0
    assert fleet_limits(scenario)[0].speed_mps == 5.0
    assert speed_notes(scenario) == ()


def test_speeds_leave_room_for_wind_below_the_tilt_limit(tiny: Path) -> None:
    """15 m/s at 30° and 3 m/s of wind becomes what the airframe can hold, said in words."""
    scenario = _scenario(tiny, "fleet.speed_mps=15", "trajectory.wind_mps=3")
    speed_mps = fleet_limits(scenario)[0].speed_mps
    top_mps = Airframe().top_airspeed_mps(WpNav(angle_max_deg=30.0))
    assert speed_mps == pytest.approx(6.81)
    assert speed_mps + 3.0 < top_mps
    (note,) = speed_notes(scenario)
    assert note.startswith("uav1, ")
    assert "planned at 6.81 m/s" in note
    assert "trajectory.angle_max_deg" in note
    assert speed_notes(_scenario(tiny)) == ()


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (("trajectory.wind_mps=9.5",), "nothing is left"),
        (("trajectory.photo_speed_mps=0.5",), "too slow to fly"),
    ],
)
def test_what_leaves_no_speed_is_refused(tiny: Path, overrides: tuple[str, ...], said: str) -> None:
    """A wind near the top airspeed, or a crawl for photographs; cures are named."""
    with pytest.raises(InfeasibleError, match=said) as caught:
        fleet_limits(_scenario(tiny, *overrides))
    assert len(caught.value.cures) == 2


def test_a_plan_carries_the_capped_speeds(tiny: Path, tiny_survey: Survey) -> None:
    """The mission's speed, its times and what is uploaded are one: the plan's UAVs say it."""
    scenario = _scenario(tiny, "trajectory.photo_speed_mps=4.5")
    plan = plan_routes(scenario, tiny_survey).plan
    speeds = {(uav.speed_mps, uav.climb_mps, uav.descent_mps) for uav in plan.uavs}
    assert max(math.hypot(v, max(up, down)) for v, up, down in speeds) <= 4.5 + 1e-6
    assert plan.certificate is not None
    assert not [v for v in plan.certificate.violations if v.kind == "route"]
