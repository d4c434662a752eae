"""Simulated vehicles on the pads of a plan, the air between them, and the time that all keep."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from jfto_msgs_py.records.plan import Plan, Uav
from jfto_msgs_py.scenario.simulation import SimulationPart
from jfto_sim import VehicleConfig
from jfto_sim.air import Air, AirMember, AirSettings, FleetAir, Ground
from jfto_sim.battery import HOVER_V
from jfto_sim.server import SimServer
from jfto_world.terrain import Dem
from jfto_world.terrain.frame import LocalFrame

# What a field team sets: home at a low battery, down at once at an empty one. ArduCopter's own
# defaults do nothing.
FAILSAFES = {"BATT_FS_LOW_ACT": 2.0, "BATT_FS_CRT_ACT": 1.0, "BATT_CRT_VOLT": 10.0}
# They have been on for so long when a station first hears them: their position estimates, ready
# after 41 s, are not waited for.
UPTIME_S = 45.0
# Ground height above a pad at metres east and north of it.
PadGround = Callable[[float, float], float]
Place = tuple[float, float, float]


def pads(plan: Plan) -> list[Place]:
    """Latitude, longitude (degrees) and height (m) of each UAV's pad."""
    frame = LocalFrame(plan.origin)
    lat, lon, height = frame.to_geodetic([uav.start_m for uav in plan.uavs])
    return [(float(a), float(b), float(c)) for a, b, c in zip(lat, lon, height, strict=True)]


def vehicle_configs(
    plan: Plan, utc_ns: int, errors: SimulationPart | None = None, dem: Dem | None = None
) -> list[VehicleConfig]:
    """A plan's UAVs on their pads with system ids 1, 2 …, powered up at `utc_ns`, failsafes on.

    They stand over the terrain, where it is known, with the errors that the scenario asks for.
    """
    errors = errors or SimulationPart()
    return [
        VehicleConfig(
            sysid=n,
            home_lat_deg=pad[0],
            home_lon_deg=pad[1],
            home_alt_m=pad[2],
            seed=errors.seed + n - 1,
            parameters=FAILSAFES | _pack(uav),
            gps_noise_m=errors.position_error_m,
            hesitation_s=hesitation_s,
            utc_at_boot_us=utc_ns // 1000,
            ground=None if dem is None else _ground_from(dem, uav.start_m),
        )
        for n, (uav, pad, hesitation_s) in enumerate(
            zip(plan.uavs, pads(plan), hesitations_s(len(plan.uavs), errors), strict=True), 1
        )
    ]


def _pack(uav: Uav) -> dict[str, float]:
    """The capacity of the battery that was planned with; what it takes to hover is its own."""
    if uav.battery is None:
        return {}
    return {"BATT_CAPACITY": round(1000.0 * uav.battery.capacity_wh / HOVER_V)}


class FleetTime:
    """Time of a fleet that runs `speedup` times faster than the wall: ns since the epoch.

    Where `start_s` is a wall time, the fleet's was the same then. Once there are vehicles their
    own time counts: on a busy computer they fall behind.
    """

    def __init__(self, speedup: float, start_s: float = 0.0) -> None:
        self._speedup = speedup
        self._start_s = start_s or time.time()
        self._boot_ns = 0
        self._server: SimServer | None = None

    def now_ns(self) -> int:
        """The fleet's time."""
        server = self._server
        if server is not None:
            return self._boot_ns + round(server.elapsed_s * 1e9)
        ahead_s = (time.time() - self._start_s) * self._speedup
        return round(self._start_s * 1e9) + round(ahead_s * 1e9)

    def follow(self, server: SimServer, boot_ns: int) -> None:
        """Go by vehicles that were powered up at `boot_ns`."""
        self._boot_ns, self._server = boot_ns, server


def _ground_from(dem: Dem, pad_m: Place) -> PadGround:
    pad_height_m = float(dem.height(pad_m[0], pad_m[1]))
    return lambda east_m, north_m: (
        float(dem.height(pad_m[0] + east_m, pad_m[1] + north_m)) - pad_height_m
    )


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
