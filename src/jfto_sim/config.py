"""What one simulated vehicle is: identity, home, seed, surroundings; and several in a row."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from jfto_msgs_py.errors import InputError
from jfto_sim.geodesy import UNITS_PER_DEGREE, move
from jfto_world.motion.arducopter.wpnav import Airframe

FLEET_MAX = 200
PORT_MAX = 8
RECORDED_UID2 = (51, 100, 49, 50, 49, 57, 99, 55, 99, 52, 99, 53, 52, 48, 52, 97, 97, 0)
RECORDED_UTC_AT_BOOT_US = 1_795_312_779_996_533


@dataclass(frozen=True)
class VehicleConfig:
    """One vehicle. Home is where it stands at power-up; the ground is flat at that height.

    `ground`, where given, is the height of the ground above home at metres east and north of it.

    `parameters` replaces defaults at power-up. `uid2` (18 bytes) is the AUTOPILOT_VERSION uid; the
    default differs per system id, so that two vehicles can be told apart. `wind_mps` (east, north)
    is where the air moves to. `gps_noise_m` is the standard deviation of the reported horizontal
    position, `hesitation_s` how much longer than its motors need it stays on the ground once told
    to take off. `clock_drift_ppm` makes the vehicle's own clock run fast. `utc_at_boot_us` is UTC
    at power-up in microseconds.
    """

    sysid: int = 1
    home_lat_deg: float = 47.397742
    home_lon_deg: float = 8.545594
    home_alt_m: float = 488.1
    heading_deg: float = 0.0
    seed: int = 0
    port_count: int = 3
    parameters: dict[str, float] = field(default_factory=dict)
    uid2: tuple[int, ...] | None = None
    wind_mps: tuple[float, float] = (0.0, 0.0)
    gps_noise_m: float = 0.0
    hesitation_s: float = 0.0
    clock_drift_ppm: float = 0.0
    utc_at_boot_us: int = RECORDED_UTC_AT_BOOT_US
    ground: Callable[[float, float], float] | None = None
    # Within 1.2 % of the drag and 15 ms of the lag that plans go by: those with which calm flights
    # are nearest in place, and a recorded order that came 14 ms before a waypoint still does.
    airframe: Airframe = field(
        default_factory=lambda: Airframe(drag_quadratic_1pm=0.0327, attitude_lag_s=0.045)
    )

    def __post_init__(self) -> None:
        if not 1 <= self.sysid <= 255:
            raise InputError(f"sysid is {self.sysid}, must be 1 to 255.")
        if not (-90 <= self.home_lat_deg <= 90 and -180 <= self.home_lon_deg <= 180):
            raise InputError(
                f"home of vehicle {self.sysid} is {self.home_lat_deg}, {self.home_lon_deg}: "
                "latitude must be within +-90 and longitude within +-180 degrees."
            )
        if not 1 <= self.port_count <= PORT_MAX:
            raise InputError(f"port_count is {self.port_count}, must be 1 to {PORT_MAX}.")
        if self.uid2 is not None and len(self.uid2) != 18:
            raise InputError(f"uid2 has {len(self.uid2)} bytes, must have 18.")
        for name in ("gps_noise_m", "hesitation_s"):
            if getattr(self, name) < 0:
                raise InputError(f"{name} is {getattr(self, name)}, must not be negative.")

    @property
    def identity(self) -> list[int]:
        """The 18 bytes of AUTOPILOT_VERSION.uid2."""
        if self.uid2 is not None:
            return list(self.uid2)
        return [*RECORDED_UID2[:-2], ord("0") + self.sysid % 10, self.sysid - 1]

    @property
    def home_units(self) -> tuple[int, int]:
        """Latitude and longitude of home in 1e-7 degree."""
        lat, lon = self.home_lat_deg * UNITS_PER_DEGREE, self.home_lon_deg * UNITS_PER_DEGREE
        return round(lat), round(lon)


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
