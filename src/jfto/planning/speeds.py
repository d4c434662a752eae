"""The speeds that a plan may use: what the camera and the wind leave of what the fleet can fly."""

from __future__ import annotations

import math

from jfto.planning.survey import make_camera, make_settings
from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.scenario import Scenario
from jfto_planner.smoothing import photo_speed_mps
from jfto_world.motion import MotionLimits

# Of the airspeed that the tilt limit holds; the rest is left to regulate with.
AIRSPEED_SHARE = 0.95
# Slower than this nobody photographs an area.
LEAST_SPEED_MPS = 1.0
# Of the photo speed that climbing may take where both are fast: legs up to 30° keep full speed.
CLIMB_SHARE = 0.5
_STEP_MPS = 0.01


def photo_cap_mps(scenario: Scenario) -> float:
    """Greatest speed at a photo point, m/s; infinite where the UAV stops there or blur is free.

    trajectory.photo_speed_mps wins over trajectory.photo_blur_px.
    """
    wanted = scenario.trajectory
    if wanted.hold_s > 0:
        return math.inf
    if wanted.photo_speed_mps > 0:
        return wanted.photo_speed_mps
    if wanted.photo_blur_px == 0:
        return math.inf
    camera = make_camera(scenario.camera, scenario.coverage)
    gsd_m = camera.gsd_m(make_settings(scenario.coverage).distance_for(camera))
    return photo_speed_mps(gsd_m, wanted.photo_blur_px, scenario.camera.exposure_s)


def fleet_limits(scenario: Scenario) -> tuple[MotionLimits, ...]:
    """Speeds of each UAV as planned, uploaded and flown.

    Missions have one speed for all of a flight: it is lowered to what photographs allow at any
    slope, and to what `angle_max_deg` can hold against trajectory.wind_mps. Curves slow down at
    waypoints instead. Raises InfeasibleError where wind or photographs leave nothing.
    """
    own = _own(scenario)
    if scenario.trajectory.mode != "waypoints":
        return own
    cap_mps, wind_cap_mps = photo_cap_mps(scenario), _wind_cap_mps(scenario)
    if cap_mps < LEAST_SPEED_MPS:
        raise InfeasibleError(
            f"Photographs allow missions {cap_mps:.2f} m/s, from trajectory.photo_speed_mps, or "
            "trajectory.photo_blur_px and camera.exposure_s: too slow to fly.",
            cures=("stops at waypoints (trajectory.hold_s)", "a shorter camera.exposure_s"),
        )
    return tuple(_sharp(_slower(limits, wind_cap_mps), cap_mps) for limits in own)


def planned_wind_mps(scenario: Scenario) -> float:
    """The wind, from any quarter, in which speeds and tilt limit still keep the plan's times, m/s.

    0 where nothing is left for it: in mode straight, and where curves use all of their tilt.
    """
    wanted = scenario.trajectory
    if wanted.mode == "straight":
        return 0.0
    if wanted.mode == "waypoints":
        return wanted.wind_mps
    # Loaded here: its compiler takes a second, which other modes need not pay.
    from jfto_world.motion.arducopter import Airframe, WpNav

    top_mps = Airframe().top_airspeed_mps(WpNav(angle_max_deg=wanted.curve_tilt_deg))
    left_mps = AIRSPEED_SHARE * top_mps - max(scenario.fleet.speed_mps)
    return min(wanted.wind_mps, max(math.floor(left_mps / _STEP_MPS) * _STEP_MPS, 0.0))


def speed_notes(scenario: Scenario) -> tuple[str, ...]:
    """What was lowered, why, and how to fly faster: a sentence per cause."""
    if scenario.trajectory.mode != "waypoints":
        return ()
    wanted, own = scenario.trajectory, dict(zip(scenario.fleet.ids, _own(scenario), strict=True))
    notes = []
    wind_cap_mps, cap_mps = _wind_cap_mps(scenario), photo_cap_mps(scenario)
    in_wind = {name: _slower(limits, wind_cap_mps) for name, limits in own.items()}
    fast = [name for name in own if in_wind[name] != own[name]]
    if fast:
        notes.append(
            f"{', '.join(fast)}: planned at {wind_cap_mps:g} m/s, since a tilt of "
            f"{wanted.angle_max_deg:g}° holds no more against {wanted.wind_mps:g} m/s of wind. "
            "Raise trajectory.angle_max_deg or lower trajectory.wind_mps to plan faster."
        )
    slowed = [name for name in own if _sharp(in_wind[name], cap_mps) != in_wind[name]]
    if slowed:
        notes.append(
            f"{', '.join(slowed)}: planned at {cap_mps:.2f} m/s at most on any slope, for sharp "
            "photographs. Shorten camera.exposure_s, allow more trajectory.photo_blur_px or "
            "photo_speed_mps, or stop at waypoints with trajectory.hold_s."
        )
    return tuple(notes)


def _own(scenario: Scenario) -> tuple[MotionLimits, ...]:
    fleet = scenario.fleet
    return tuple(
        MotionLimits(*speeds)
        for speeds in zip(fleet.speed_mps, fleet.climb_mps, fleet.descent_mps, strict=True)
    )


def _wind_cap_mps(scenario: Scenario) -> float:
    # Loaded here: its compiler takes a second, which other modes need not pay.
    from jfto_world.motion.arducopter import Airframe, WpNav

    wanted = scenario.trajectory
    top_mps = Airframe().top_airspeed_mps(WpNav(angle_max_deg=wanted.angle_max_deg))
    left_mps = AIRSPEED_SHARE * top_mps - wanted.wind_mps
    if left_mps < LEAST_SPEED_MPS:
        raise InfeasibleError(
            f"trajectory.wind_mps is {wanted.wind_mps:g}, but a tilt of trajectory.angle_max_deg "
            f"{wanted.angle_max_deg:g} holds {top_mps:.1f} m/s of airspeed: nothing is left to "
            "fly with.",
            cures=("a greater trajectory.angle_max_deg", "a smaller trajectory.wind_mps"),
        )
    return math.floor(left_mps / _STEP_MPS) * _STEP_MPS


def _slower(limits: MotionLimits, cap_mps: float) -> MotionLimits:
    return MotionLimits(min(limits.speed_mps, cap_mps), limits.climb_mps, limits.descent_mps)


def _sharp(limits: MotionLimits, cap_mps: float) -> MotionLimits:
    """Limits whose speed along a leg of any slope, min(v / cos g, v_z / sin g), is at most a cap.

    Its greatest value is the root of v² + v_z².
    """
    vertical = max(limits.climb_mps, limits.descent_mps)
    if math.hypot(limits.speed_mps, vertical) <= cap_mps:
        return limits
    left = math.sqrt(max(cap_mps**2 - limits.speed_mps**2, 0.0))
    vertical = min(vertical, max(CLIMB_SHARE * cap_mps, left))
    return MotionLimits(
        min(limits.speed_mps, math.sqrt(cap_mps**2 - vertical**2)),
        min(limits.climb_mps, vertical),
        min(limits.descent_mps, vertical),
    )
