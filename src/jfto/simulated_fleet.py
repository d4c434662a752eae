"""Simulated vehicles on the pads of a plan, and the one time that all of them keep."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence

from jfto_msgs_py.plan import Plan
from jfto_sim import VehicleConfig
from jfto_sim.server import SimServer
from jfto_world.terrain import Dem
from jfto_world.terrain.frame import LocalFrame

# What a field team sets: home at a low battery, down at once at an empty one. ArduCopter's own
# defaults do nothing.
FAILSAFES = {"BATT_FS_LOW_ACT": 2.0, "BATT_FS_CRT_ACT": 1.0, "BATT_CRT_VOLT": 10.0}
# Ground height above a pad at metres east and north of it.
PadGround = Callable[[float, float], float]
Place = tuple[float, float, float]


def pads(plan: Plan) -> dict[str, Place]:
    """Latitude, longitude (degrees) and height (m) of each UAV's pad."""
    frame = LocalFrame(plan.origin)
    found = {}
    for uav in plan.uavs:
        lat, lon, height = frame.to_geodetic([uav.start_m])
        found[uav.id] = (float(lat[0]), float(lon[0]), float(height[0]))
    return found


def grounds(plan: Plan, dem: Dem | None) -> dict[str, PadGround]:
    """The terrain as each UAV of a plan sees it from its pad; empty where it is not known."""
    if dem is None:
        return {}
    return {uav.id: _seen_from(dem, uav.start_m) for uav in plan.uavs}


def vehicle_configs(
    places: Mapping[str, Place],
    seen: Mapping[str, PadGround],
    utc_ns: int,
    *,
    seed: int = 0,
    gps_noise_m: float = 0.0,
    hesitations_s: Sequence[float] | None = None,
) -> list[VehicleConfig]:
    """One vehicle per pad with system ids 1, 2 …, powered up at `utc_ns`, battery failsafes on.

    `hesitations_s` has the seconds that each stays on its pad when told to start.
    """
    return [
        VehicleConfig(
            sysid=n,
            home_lat_deg=pad[0],
            home_lon_deg=pad[1],
            home_alt_m=pad[2],
            seed=seed + n - 1,
            parameters=FAILSAFES,
            gps_noise_m=gps_noise_m,
            hesitation_s=0.0 if hesitations_s is None else hesitations_s[n - 1],
            utc_at_boot_us=utc_ns // 1000,
            ground=seen.get(uav),
        )
        for n, (uav, pad) in enumerate(places.items(), 1)
    ]


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


def _seen_from(dem: Dem, pad_m: Place) -> PadGround:
    pad_height_m = float(dem.height(pad_m[0], pad_m[1]))
    return lambda east_m, north_m: (
        float(dem.height(pad_m[0] + east_m, pad_m[1] + north_m)) - pad_height_m
    )
