"""Several vehicles side by side, as the command line and tests want them."""

from __future__ import annotations

from jfto_msgs_py.errors import InputError
from jfto_sim.config import RECORDED_UTC_AT_BOOT_US, VehicleConfig
from jfto_sim.geodesy import UNITS_PER_DEGREE, move

FLEET_MAX = 200


def fleet(
    count: int,
    home: tuple[float, float, float] = (47.397742, 8.545594, 488.1),
    *,
    spacing_m: float = 10.0,
    seed: int = 0,
    parameters: dict[str, float] | None = None,
    gps_noise_m: float = 0.0,
    utc_at_boot_us: int = RECORDED_UTC_AT_BOOT_US,
) -> list[VehicleConfig]:
    """`count` vehicles with system ids 1.. in a row to the east of `home` (lat, lon, height).

    Raises InputError for a count or spacing that makes no sense.
    """
    if not 1 <= count <= FLEET_MAX:
        raise InputError(f"There must be 1 to {FLEET_MAX} simulated vehicles, not {count}.")
    if not spacing_m >= 0:
        raise InputError(f"spacing_m is {spacing_m}, must not be negative.")
    lat, lon = round(home[0] * UNITS_PER_DEGREE), round(home[1] * UNITS_PER_DEGREE)
    configs = []
    for k in range(count):
        at = move(lat, lon, k * spacing_m, 0.0)
        configs.append(
            VehicleConfig(
                sysid=k + 1,
                home_lat_deg=at[0] / UNITS_PER_DEGREE,
                home_lon_deg=at[1] / UNITS_PER_DEGREE,
                home_alt_m=home[2],
                seed=seed + k,
                parameters=dict(parameters or {}),
                gps_noise_m=gps_noise_m,
                utc_at_boot_us=utc_at_boot_us,
            )
        )
    return configs
