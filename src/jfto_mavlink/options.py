"""The parameters of mavlink_bridge besides the scenario's."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param


@dataclass(frozen=True)
class BridgeOptions:
    """The bridge's own parameters."""

    autostart: bool = param(True, "Configure and activate at start.")
    plan_file: str = param("", "Plan that is flown; waited for where there is none yet.")
    roster: tuple[str, ...] = param(
        (),
        "Vehicles: UAV=SYSID@LINK[#UID] each. @LINK may be left out where endpoints are given, all "
        "of it where the UAVs have system ids 1, 2 and so on.",
    )
    endpoints: tuple[str, ...] = param(
        (), "Links of roster entries without one: one for all or one each (udpin:0.0.0.0:14550)."
    )
    key_file: str = param("", "MAVLink signing key; left out: unsigned.")
    log_directory: str = param("", "Where a .tlog per vehicle is written; left out: nowhere.")
    state_file: str = param(
        "", "Where the flight under way is kept, for after a restart; left out: nowhere."
    )
    parameters_file: str = param(
        "",
        "Where it is kept what vehicles' parameters were before the flight, until they are put "
        "back; left out: nowhere.",
    )
    preflight_file: str = param(
        "", "Where the page of the last checks is written; left out: nowhere."
    )
    telemetry_rate_hz: float = param(
        10.0, "Positions and attitudes per second and UAV.", unit="Hz", low=0.5, high=50.0
    )
    allow_arming: bool = param(False, "Let the start service arm vehicles.")
    abort_by_landing: bool = param(
        False, "The abort service lets them land where they are instead of returning home."
    )
    style: str = param(
        "planned",
        "How waypoints are flown; planned: as the plan was timed.",
        choices=("planned", "fly_through", "hold"),
    )
    pass_within_m: float = param(
        2.0, "How close every waypoint is passed.", unit="m", low=0.1, high=10.0
    )
    takeoff_height_m: float = param(
        0.0,
        "Height of the take-off above the pad; 0: as planned, 10 m where the plan does not say.",
        unit="m",
        low=0.0,
        high=500.0,
    )
    return_height_m: float = param(
        0.0,
        "Of a plan without ways home: climb to this height above home before returning, if lower; "
        "0: as the terrain asks.",
        unit="m",
        low=0.0,
        high=1000.0,
    )
    height_min_m: float = param(
        0.0, "Least height above home, where the terrain is not known.", unit="m", low=-500.0
    )
    height_max_m: float = param(1000.0, "Greatest height above home.", unit="m", low=1.0)
    distance_max_m: float = param(5000.0, "Greatest distance from home.", unit="m", low=1.0)
    gates: tuple[int, ...] = param(
        (),
        "Time gates: behind their K-th waypoint (1, 2 …) all wait for its planned time, so that "
        "slots are kept by the clock; they need start_at_s.",
        low=1,
    )
    start_at_s: float = param(
        0.0,
        "With gates: planned moment of lift-off, seconds since the epoch on the vehicles' clock.",
        unit="s",
        low=0.0,
    )
    check_terrain: bool = param(
        True, "Refuse missions whose legs or way home do not clear the scenario's terrain."
    )
    speedup: float = param(
        1.0, "Simulated vehicles: how much faster than the clock.", low=0.1, high=50.0
    )
    vehicle_stamps: bool = param(
        False,
        "Stamp what vehicles report with their own UTC: where they are simulated and /clock is "
        "theirs.",
    )
