"""The vehicles and where they lift off."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param


@dataclass(frozen=True)
class FleetPart:
    """The UAVs. Arrays have one entry per UAV; one entry stands for all."""

    count: int = param(8, "Number of UAVs, A.", low=1, high=1000)
    ids: tuple[str, ...] = param(
        (), "Names, also the ROS namespaces. Left out: uav1, uav2 and so on.", per_uav=True
    )
    p_max_dbm: tuple[float, ...] = param(
        (30.0,), "Greatest transmit power, P_a,max.", unit="dBm", low=0.0, high=40.0, per_uav=True
    )
    energy_j: tuple[float, ...] = param(
        (200.0,),
        "Energy for transmission, E_a,max.",
        unit="J",
        low=0.0,
        high=1e7,
        strict=True,
        per_uav=True,
    )
    t_max_s: tuple[float, ...] = param(
        (450.0,),
        "Latest arrival at the last waypoint, T_a,max. 0: as late as fleet.battery_wh, or "
        "fleet.endurance_s, lets it come home from anywhere; also where fleet.battery_wh is given "
        "and this is not.",
        unit="s",
        low=0.0,
        high=100_000.0,
        per_uav=True,
    )
    endurance_s: tuple[float, ...] = param(
        (0.0,),
        "How long the battery lets a UAV fly, from lift-off until it stands at its pad, reserve "
        "left out. 0: not known, not checked.",
        unit="s",
        low=0.0,
        high=100_000.0,
        per_uav=True,
    )
    speed_mps: tuple[float, ...] = param(
        (10.0,), "Horizontal speed.", unit="m/s", low=0.1, high=60.0, per_uav=True
    )
    climb_mps: tuple[float, ...] = param(
        (4.0,), "Greatest climb speed.", unit="m/s", low=0.1, high=30.0, per_uav=True
    )
    descent_mps: tuple[float, ...] = param(
        (3.0,), "Greatest descent speed.", unit="m/s", low=0.1, high=30.0, per_uav=True
    )
    battery_wh: tuple[float, ...] = param(
        (0.0,),
        "Capacity of a full battery, which the whole flight must do with: legs, waits, the way "
        "home and the landing. Needs fleet.hover_power_w. 0: not known, not checked.",
        unit="Wh",
        low=0.0,
        high=100_000.0,
        per_uav=True,
        later=True,
    )
    hover_power_w: tuple[float, ...] = param(
        (0.0,),
        "Power that a UAV takes to stand in the air, for fleet.battery_wh and for the check of its "
        "charge before a flight; 0: unknown.",
        unit="W",
        low=0.0,
        high=50_000.0,
        per_uav=True,
        later=True,
    )
    cruise_power_w: tuple[float, ...] = param(
        (0.0,),
        "Power that a UAV takes under way at its speed in calm air; trajectory.wind_mps adds to "
        "it. 0: as for standing.",
        unit="W",
        low=0.0,
        high=50_000.0,
        per_uav=True,
        later=True,
    )
    battery_reserve_percent: float = param(
        20.0,
        "Share of its battery's capacity that a UAV must have left when it is down again.",
        unit="%",
        low=0.0,
        high=90.0,
        later=True,
    )
    mission_items: int = param(
        650,
        "Items, home included, that an autopilot holds: 650 or more on the boards in use. Routes "
        "are kept within it.",
        low=20,
        high=65_000,
        later=True,
    )


@dataclass(frozen=True)
class StartsPart:
    """Starting points. UAVs that share one lift off from pads mission.d_min_m apart."""

    count: int = param(4, "Number of starting points, S, when they are chosen.", low=1, high=1000)
    positions_m: tuple[float, ...] = param(
        (),
        "Given starting points, east and north of the origin: e1, n1, e2, n2, … UAVs take them in "
        "turn. Left out: chosen from the distribution of the waypoints.",
        unit="m",
        low=-50_000.0,
        high=50_000.0,
    )
