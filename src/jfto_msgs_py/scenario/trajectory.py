"""How a route is flown, which decides when a UAV is where."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param

TRAJECTORY_MODES = ("waypoints", "guided", "straight")


@dataclass(frozen=True)
class TrajectoryPart:
    """How routes are flown; fleet.speed_mps, climb_mps and descent_mps bound every mode."""

    mode: str = param(
        "waypoints",
        "waypoints: missions of the autopilot, timed as ArduCopter flies them; guided: a streamed "
        "quintic Bezier curve; straight: legs at constant speed without turns or take-off, for "
        "studies.",
        choices=TRAJECTORY_MODES,
    )
    hold_s: float = param(
        0.0,
        "Stop at each waypoint, for sharp photographs; 0: fly through. Whole seconds in mode "
        "waypoints.",
        unit="s",
        low=0.0,
        high=3600.0,
    )
    takeoff_m: float = param(
        10.0,
        "waypoints: height above the pad to which a UAV climbs before its first leg.",
        unit="m",
        low=0.0,
        high=500.0,
    )
    wpnav_accel_mps2: float = param(
        2.5, "waypoints: WPNAV_ACCEL of the autopilot.", unit="m/s²", low=0.5, high=5.0
    )
    wpnav_accel_z_mps2: float = param(
        1.0, "waypoints: WPNAV_ACCEL_Z.", unit="m/s²", low=0.2, high=5.0
    )
    wpnav_jerk_mps3: float = param(1.0, "waypoints: WPNAV_JERK.", unit="m/s³", low=0.2, high=20.0)
    wpnav_radius_m: float = param(
        1.2,
        "waypoints: WPNAV_RADIUS; 1.2 is what missions set to pass within 2 m.",
        unit="m",
        low=0.05,
        high=10.0,
    )
    angle_max_deg: float = param(
        30.0, "waypoints: ANGLE_MAX, the greatest tilt.", unit="deg", low=10.0, high=80.0
    )
    wind_mps: float = param(
        3.0,
        "waypoints: wind that speeds must leave room for below the tilt limit, and for which the "
        "spread of arrivals is reported; times are for calm air.",
        unit="m/s",
        low=0.0,
        high=15.0,
    )
    curve_accel_mps2: float = param(
        3.5, "guided: greatest horizontal acceleration.", unit="m/s²", low=0.5, high=10.0
    )
    curve_accel_z_mps2: float = param(
        2.0, "guided: greatest vertical acceleration.", unit="m/s²", low=0.2, high=10.0
    )
    curve_jerk_mps3: float = param(5.0, "guided: greatest jerk.", unit="m/s³", low=0.2, high=100.0)
    curve_tilt_deg: float = param(
        30.0,
        "guided: greatest tilt that acceleration and gravity may need.",
        unit="deg",
        low=5.0,
        high=80.0,
    )
    corridor_m: float = param(
        20.0,
        "guided: how far the curve may leave the straight legs.",
        unit="m",
        low=0.5,
        high=500.0,
    )
    clearance_m: float = param(
        15.0,
        "Least height above ground along the whole flight, away from the pads.",
        unit="m",
        low=0.0,
        high=1000.0,
    )
    photo_blur_px: float = param(
        0.0,
        "How far the image may move during camera.exposure_s while flying through a waypoint; "
        "bounds the speed to this times the ground sampling distance over the exposure. 0: any.",
        unit="px",
        low=0.0,
        high=100.0,
    )
    photo_speed_mps: float = param(
        0.0,
        "Greatest speed of photographs, instead of trajectory.photo_blur_px: at each waypoint in "
        "mode guided, of the whole mission in mode waypoints. 0: as the blur allows.",
        unit="m/s",
        low=0.0,
        high=60.0,
    )
