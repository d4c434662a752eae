"""The air of a plan's simulated vehicles, with the errors that its scenario asks for."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.scenario.simulation import SimulationPart
from jfto_sim.air import Air, AirMember, AirSettings, FleetAir, Ground
from jfto_world.terrain import Dem
from jfto_world.terrain.frame import LocalFrame


def fleet_air(plan: Plan, errors: SimulationPart, dem: Dem | None) -> FleetAir:
    """Radios of the plan's UAVs; ridges count where the errors say so and the terrain is known."""
    air = Air(
        [AirMember(uav.id, uav.p_max_dbm, uav.energy_j) for uav in plan.uavs],
        plan.radio,
        AirSettings(
            path_loss_error_db=errors.path_loss_error_db,
            shadowing_sigma_db=errors.shadowing_sigma_db,
            shadowing_decorrelation_m=errors.shadowing_decorrelation_m,
            seed=errors.seed,
        ),
        None if dem is None or not errors.terrain_loss else _ground(dem),
    )
    return FleetAir(air, LocalFrame(plan.origin).to_enu)


def hesitations_s(count: int, errors: SimulationPart) -> list[float]:
    """Seconds that each vehicle stays on its pad after the start order, half-normal."""
    rng = np.random.default_rng(errors.seed)
    return [float(value) for value in errors.time_error_s * np.abs(rng.standard_normal(count))]


def _ground(dem: Dem) -> Ground:
    """The terrain, continued level beyond its edges: links may pass there."""
    x, y, _ = dem.grid()
    return lambda east, north: dem.height(np.clip(east, x[0], x[-1]), np.clip(north, y[0], y[-1]))
