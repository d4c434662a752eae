"""Fleets over hills, done with one waypoint each."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from jfto_msgs_py.plan_file import rounded
from jfto_msgs_py.records.plan import Origin, Plan, Uav, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_planner.routing import PlanTerms, build_plan
from jfto_planner.smoothing import Clearance, CurveRules, smooth_fleet
from jfto_planner.smoothing.limits import CurveLimits
from jfto_world.motion import MotionLimits

CURVE = {"accel_mps2": 3.5, "accel_z_mps2": 2.0, "jerk_mps3": 5.0, "tilt_deg": 30.0}
PARAMETERS = {"bezier": CURVE, "arducopter": {"takeoff_m": 10.0}, "constant_speed": {}}


def hills(seed: int, relief_m: float) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Ground of a few waves, 0 to `relief_m` high."""
    rng = np.random.default_rng(seed)
    waves = [(rng.uniform(-1, 1, 2) / rng.uniform(60, 300), rng.uniform(0, 6)) for _ in range(3)]

    def height(east: np.ndarray, north: np.ndarray) -> np.ndarray:
        parts = [np.sin(2 * (k[0] * east + k[1] * north) + phase) for k, phase in waves]
        return np.asarray(relief_m * (0.5 + sum(parts) / (2 * len(parts))))

    return height


def fleet_plan(
    count: int, seed: int, *, relief_m: float = 80.0, time_model: str = "arducopter"
) -> Plan:
    """Each UAV of a plan flies to one waypoint somewhere over the hills, at least d_min apart."""
    rng, ground = np.random.default_rng(seed), hills(seed, relief_m)
    pads = 10.5 * np.array([(k % 3, k // 3) for k in range(count)], dtype=float)
    pads = np.column_stack([pads, ground(*pads.T)])
    places: list[np.ndarray] = []
    while len(places) < count:
        place = rng.uniform(-250, 250, 2)
        up = ground(*place[:, None])[0] + rng.uniform(20, 60)
        place = np.array([*place, up])
        if all(np.linalg.norm(place - other) > 12 for other in places):
            places.append(place)
    limits = [MotionLimits(*rng.uniform((5, 2, 1.5), (10, 4, 3))) for _ in range(count)]
    lines = tuple(np.array([pad, place]) for pad, place in zip(pads, places, strict=True))
    curves = ()
    if time_model == "bezier":
        rules = CurveRules(Clearance(15.0))
        names = tuple(f"uav{k + 1}" for k in range(count))
        curve_limits = tuple(CurveLimits.of(one, **CURVE) for one in limits)
        curves = smooth_fleet(names, lines, curve_limits, ground, rules)
    uavs = tuple(
        Uav(
            f"uav{k + 1}",
            30.0,
            1e6,
            1e4,
            one.speed_mps,
            one.climb_mps,
            one.descent_mps,
            tuple(map(float, pads[k])),  # type: ignore[arg-type]
        )
        for k, one in enumerate(limits)
    )
    terms = PlanTerms(
        scenario_hash="hills",
        seed=seed,
        origin=Origin(36.6, -84.2, 300.0),
        radio=Radio(),
        k_min=min(1, count - 1),
        delta=2,
        d_min_m=10.0,
        length_max_m=1e6,
        slot_count=20,
        horizon_s=None,
        waypoints=tuple(
            Waypoint(k, tuple(map(float, place)))  # type: ignore[arg-type]
            for k, place in enumerate(places)
        ),
        uavs=uavs,
    )
    routes = [(k,) for k in range(count)]
    # As the planner itself has it: times of rounded points.
    plain = rounded(build_plan(routes, terms))
    terms = PlanTerms(**{**vars(terms), "waypoints": plain.waypoints, "uavs": plain.uavs})
    return rounded(build_plan(routes, terms, time_model, PARAMETERS[time_model], curves))


@pytest.fixture(name="make_fleet", scope="session")
def _make_fleet():
    return fleet_plan


@pytest.fixture(name="make_hills", scope="session")
def _make_hills():
    return hills
