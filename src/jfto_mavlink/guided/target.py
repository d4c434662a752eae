"""Targets as the autopilot takes them: SET_POSITION_TARGET_LOCAL_NED in the frame of its EKF.

Position, velocity, acceleration, and a heading that turns gently towards the next photo's.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.guided.reference import Reference
from jfto_mavlink.protocol.exchange import Context
from jfto_mavlink.protocol.item import Place
from jfto_msgs_py.types import Array
from jfto_world.terrain.frame import LocalFrame

# The autopilot's own approximation: metres per degree of latitude, everywhere on Earth.
METRES_PER_DEGREE = 0.011131884502145034 * 1e7


@dataclass(frozen=True)
class MapFrame:
    """The plan's ENU map as one vehicle sees it, which counts heights from its home.

    The plan's heights are in the datum of its terrain, the vehicle's in that of its GPS; at the pad
    both are the same place. `pad_alt_m` is the pad's altitude in the plan's datum.
    """

    frame: LocalFrame
    pad_alt_m: float

    def position_m(self, lat_deg: float, lon_deg: float, height_m: float) -> Array:
        """ENU position (3,) of a place given by its height above home."""
        return self.frame.to_enu(lat_deg, lon_deg, self.pad_alt_m + height_m)

    def place(self, position_m: Array) -> Place:
        """Latitude, longitude and height above home of an ENU position (3,)."""
        lat, lon, alt = self.frame.to_geodetic(position_m)
        return float(lat), float(lon), float(alt) - self.pad_alt_m


@dataclass(frozen=True)
class EkfFrame:
    """North, east, down of the EKF origin. Altitudes here are above sea level, by the vehicle.

    `origin` is its GPS_GLOBAL_ORIGIN, `home_alt_m` the altitude in its HOME_POSITION.
    """

    map: MapFrame
    origin: Place
    home_alt_m: float

    def position_ned_m(self, position_m: Array) -> tuple[float, float, float]:
        """NED of an ENU position (3,) of the map.

        By the formula that the autopilot itself uses, so that it ends up at that very latitude and
        longitude: true metres would be 2 m per kilometre beside.
        """
        lat, lon, height_m = self.map.place(position_m)
        lat_0, lon_0, alt_0 = self.origin
        shrink = max(math.cos(math.radians((lat + lat_0) / 2)), 0.01)
        turn = (lon - lon_0 + 180.0) % 360.0 - 180.0
        north = (lat - lat_0) * METRES_PER_DEGREE
        return north, turn * METRES_PER_DEGREE * shrink, alt_0 - self.home_alt_m - height_m


def ned(vector: Array) -> tuple[float, float, float]:
    """North, east, down of an ENU velocity or acceleration (3,)."""
    return float(vector[1]), float(vector[0]), -float(vector[2])


# ArduCopter turns at up to 90 deg/s; this leaves room for the wind.
TURN_DPS = 45.0


@dataclass(frozen=True)
class HeadingPlan:
    """Headings (degrees clockwise from north) of photos at `arrival_s` seconds from lift-off."""

    arrival_s: tuple[float, ...]
    yaw_deg: tuple[float, ...]

    def at(self, elapsed_s: float) -> tuple[float, float] | None:
        """Heading (deg) and rate (deg/s) then; None without photos.

        After a photo it turns to the next one's heading, the short way.
        """
        if not self.yaw_deg:
            return None
        ahead = min(bisect_right(self.arrival_s, elapsed_s), len(self.yaw_deg) - 1)
        goal = self.yaw_deg[ahead]
        if ahead == 0:
            return goal % 360.0, 0.0
        before, since_s = self.yaw_deg[ahead - 1], self.arrival_s[ahead - 1]
        turn = (goal - before + 180.0) % 360.0 - 180.0
        turned = min(TURN_DPS * max(elapsed_s - since_s, 0.0), abs(turn))
        if turned >= abs(turn):
            return goal % 360.0, 0.0
        sign = 1.0 if turn > 0 else -1.0
        return (before + sign * turned) % 360.0, sign * TURN_DPS


_POSITION, _FORCE = 0x007, 0x200
_YAW, _YAW_RATE = 0x400, 0x800


def target_message(
    context: Context, frame: EkfFrame, target: Reference, heading: tuple[float, float] | None
) -> Message:
    """A target to pass through; `heading` is yaw (deg) and its rate (deg/s), None for any.

    The GLOBAL_INT form of this message drops the acceleration, measured to cost 0.8 m.
    """
    mask = 0 if heading is not None else _YAW | _YAW_RATE
    yaw_deg, rate_dps = heading or (0.0, 0.0)
    return _message(
        context,
        mask,
        (
            *frame.position_ned_m(target.position_m),
            *ned(target.velocity_mps),
            *ned(target.acceleration_mps2),
        ),
        (math.radians((yaw_deg + 180.0) % 360.0 - 180.0), math.radians(rate_dps)),
    )


def stop_message(context: Context) -> Message:
    """Come to rest: velocity and acceleration 0, wherever that is."""
    return _message(context, _POSITION | _YAW | _YAW_RATE, (0.0,) * 9, (0.0, 0.0))


def _message(
    context: Context, mask: int, motion: tuple[float, ...], turn: tuple[float, float]
) -> Message:
    boot_ms = int(context.clock() * 1000) & 0xFFFFFFFF
    return mavlink.MAVLink_set_position_target_local_ned_message(
        boot_ms, *context.target, mavlink.MAV_FRAME_LOCAL_NED, mask & ~_FORCE, *motion, *turn
    )
