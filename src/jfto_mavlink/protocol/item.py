"""Mission items and whole missions as they travel in MISSION_ITEM_INT; distances of places."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field

from jfto_mavlink.dialect import Message, mavlink

MISSION = mavlink.MAV_MISSION_TYPE_MISSION
FENCE = mavlink.MAV_MISSION_TYPE_FENCE
RALLY = mavlink.MAV_MISSION_TYPE_RALLY
TYPE_NAMES = {MISSION: "mission", FENCE: "fence", RALLY: "rally"}

FRAME_ABSOLUTE = mavlink.MAV_FRAME_GLOBAL
FRAME_HOME = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
FRAME_TERRAIN = mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT
FRAME_NONE = mavlink.MAV_FRAME_MISSION

DEGREE_1E7 = 10_000_000
# Latitude and longitude in degrees, and height in metres.
Place = tuple[float, float, float]
Offset = tuple[float, float, float]

_EQUATOR_M = 6_378_137.0
_ECCENTRICITY2 = 0.00669437999014
# Commands up to this number are flown to; larger ones are done in passing.
LAST_NAV_COMMAND = mavlink.MAV_CMD_NAV_LAST

# Commands whose x and y are not a position: plain numbers on the wire, kept with frame 0.
WITHOUT_POSITION = frozenset(
    (
        mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH,
        mavlink.MAV_CMD_NAV_GUIDED_ENABLE,
        mavlink.MAV_CMD_NAV_DELAY,
        mavlink.MAV_CMD_CONDITION_DELAY,
        mavlink.MAV_CMD_CONDITION_DISTANCE,
        mavlink.MAV_CMD_CONDITION_YAW,
        mavlink.MAV_CMD_DO_JUMP,
        mavlink.MAV_CMD_DO_CHANGE_SPEED,
        mavlink.MAV_CMD_DO_SET_SERVO,
        mavlink.MAV_CMD_DO_DIGICAM_CONTROL,
        mavlink.MAV_CMD_DO_MOUNT_CONTROL,
        mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST,
        mavlink.MAV_CMD_DO_FENCE_ENABLE,
        mavlink.MAV_CMD_DO_GRIPPER,
        mavlink.MAV_CMD_DO_GUIDED_LIMITS,
        mavlink.MAV_CMD_JUMP_TAG,
        mavlink.MAV_CMD_DO_JUMP_TAG,
        mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW,
        mavlink.MAV_CMD_DO_SET_ROI_NONE,
        mavlink.MAV_CMD_DO_SET_RELAY,
        mavlink.MAV_CMD_DO_REPEAT_RELAY,
        mavlink.MAV_CMD_DO_REPEAT_SERVO,
        mavlink.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL,
        mavlink.MAV_CMD_SET_CAMERA_MODE,
        mavlink.MAV_CMD_SET_CAMERA_ZOOM,
        mavlink.MAV_CMD_SET_CAMERA_FOCUS,
        mavlink.MAV_CMD_IMAGE_START_CAPTURE,
        mavlink.MAV_CMD_IMAGE_STOP_CAPTURE,
        mavlink.MAV_CMD_VIDEO_START_CAPTURE,
        mavlink.MAV_CMD_VIDEO_STOP_CAPTURE,
        mavlink.MAV_CMD_NAV_ATTITUDE_TIME,
    )
)


def float32(value: float) -> float:
    """The value as the wire's 32-bit float carries it."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


@dataclass(frozen=True)
class Item:
    """One item. x and y are degrees × 1e7 for commands with a position, plain integers else."""

    command: int
    frame: int = FRAME_NONE
    params: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    x: int = 0
    y: int = 0
    z: float = 0.0
    current: int = 0
    autocontinue: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "params", tuple(float32(p) for p in self.params))
        object.__setattr__(self, "z", float32(self.z))

    @property
    def has_position(self) -> bool:
        """Whether x and y are a place."""
        return self.command not in WITHOUT_POSITION

    @property
    def is_nav(self) -> bool:
        """Whether the vehicle flies to it, instead of doing it in passing."""
        return self.command <= LAST_NAV_COMMAND

    @property
    def lat_deg(self) -> float:
        """Latitude of an item with a position."""
        return self.x / DEGREE_1E7

    @property
    def lon_deg(self) -> float:
        """Longitude of an item with a position."""
        return self.y / DEGREE_1E7

    def to_message(self, sysid: int, compid: int, seq: int, mission_type: int) -> Message:
        """The MISSION_ITEM_INT for a vehicle."""
        return mavlink.MAVLink_mission_item_int_message(
            sysid,
            compid,
            seq,
            self.frame,
            self.command,
            self.current,
            self.autocontinue,
            *self.params,
            self.x,
            self.y,
            self.z,
            mission_type,
        )


def item_from_message(message: Message) -> Item:
    """The item in a MISSION_ITEM_INT."""
    return Item(
        message.command,
        message.frame,
        (message.param1, message.param2, message.param3, message.param4),
        message.x,
        message.y,
        message.z,
        message.current,
        message.autocontinue,
    )


def at(
    command: int,
    frame: int,
    lat_deg: float,
    lon_deg: float,
    height_m: float,
    p1: float = 0.0,
) -> Item:
    """An item at a place, coordinates rounded to 1e-7 degrees and the height to centimetres."""
    x, y = round(lat_deg * DEGREE_1E7), round(lon_deg * DEGREE_1E7)
    return Item(command, frame, (p1, 0.0, 0.0, 0.0), x, y, round(height_m, 2))


@dataclass(frozen=True)
class Mission:
    """Everything one vehicle holds: items (item 0 is home), fence and rally points.

    An empty `items` means an empty mission; an empty `fence` or `rally` leaves what is on board.
    `parameters` are settings of the autopilot that the mission relies on, such as fence heights;
    `notes` name what the file it was read from holds besides.
    """

    items: tuple[Item, ...] = ()
    fence: tuple[Item, ...] = ()
    rally: tuple[Item, ...] = ()
    parameters: tuple[tuple[str, float], ...] = ()
    notes: tuple[str, ...] = field(default=(), compare=False)

    def of_type(self, mission_type: int) -> tuple[Item, ...]:
        """The items of one mission type."""
        return {MISSION: self.items, FENCE: self.fence, RALLY: self.rally}[mission_type]


def offset_m(origin: Place, place: Place) -> Offset:
    """East, north and up from one place to another nearby; errors below 1 mm within 1 km."""
    lat = math.radians(origin[0])
    root = 1.0 - _ECCENTRICITY2 * math.sin(lat) ** 2
    height = origin[2]
    north_radius = _EQUATOR_M * (1.0 - _ECCENTRICITY2) / root**1.5 + height
    east_radius = _EQUATOR_M / math.sqrt(root) + height
    turn = (place[1] - origin[1] + 180.0) % 360.0 - 180.0
    east = math.radians(turn) * east_radius * math.cos(math.radians((origin[0] + place[0]) / 2))
    north = math.radians(place[0] - origin[0]) * north_radius
    return east, north, place[2] - origin[2]


def distance_m(a: Place, b: Place) -> float:
    """Straight distance between two places nearby."""
    return math.hypot(*offset_m(a, b))


def closest_m(start: Place, end: Place, place: Place) -> float:
    """Least distance to a place on the straight way from start to end."""
    sx, sy, sz = offset_m(place, start)
    ex, ey, ez = offset_m(place, end)
    dx, dy, dz = ex - sx, ey - sy, ez - sz
    square = dx * dx + dy * dy + dz * dz
    t = 0.0 if square == 0 else min(max(-(sx * dx + sy * dy + sz * dz) / square, 0.0), 1.0)
    return math.hypot(sx + t * dx, sy + t * dy, sz + t * dz)
