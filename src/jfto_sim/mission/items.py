"""Mission items as the vehicle stores them: what it accepts, keeps and reads back; the lists."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from jfto_sim.dialect import Message, mavlink
from jfto_sim.geodesy import LOCATION_ALT_MAX_M
from jfto_sim.parameters import as_float32

MISSION, FENCE, RALLY = 0, 1, 2
MISSION_CAPACITY = 650
CAPACITY = {MISSION: MISSION_CAPACITY, FENCE: 83, RALLY: 19}

_DEGREES_MAX = 200.0  # below what 1e-7 degree in 32 bits can hold
GLOBAL, RELATIVE, TERRAIN = 0, 3, 10
_FRAMES = {0: GLOBAL, 2: GLOBAL, 5: GLOBAL, 3: RELATIVE, 6: RELATIVE, 10: TERRAIN, 11: TERRAIN}

WAYPOINT, LOITER_UNLIM, LOITER_TURNS, LOITER_TIME, RTL, LAND, TAKEOFF = 16, 17, 18, 19, 20, 21, 22
SPLINE, GUIDED_ENABLE, DELAY, PAYLOAD_PLACE = 82, 92, 93, 94
JUMP, CHANGE_SPEED, SET_HOME, SET_ROI, MOUNT_CONTROL = 177, 178, 179, 201, 205
CONDITION_DELAY, CONDITION_DISTANCE, CONDITION_YAW = 112, 114, 115
DIGICAM, CAM_TRIGG_DIST, GIMBAL_PITCHYAW, IMAGE_START, IMAGE_STOP = 203, 206, 1000, 2000, 2001
VTOL_TAKEOFF, VTOL_LAND, JUMP_TAG, DO_JUMP_TAG, FENCE_ENABLE = 84, 85, 600, 601, 207

NAMES = {
    WAYPOINT: "WP", LOITER_UNLIM: "LoitUnlim", LOITER_TURNS: "LoitTurns", LOITER_TIME: "LoitTime",
    RTL: "RTL", LAND: "Land", TAKEOFF: "Takeoff", VTOL_TAKEOFF: "VTOLTakeoff",
    VTOL_LAND: "VTOLLand", 30: "ChangeAlt", 31: "LoitAltitude", SPLINE: "SplineWP",
    GUIDED_ENABLE: "GuidedEnable", DELAY: "Delay", PAYLOAD_PLACE: "PayloadPlace",
    CONDITION_DELAY: "CondDelay", CONDITION_DISTANCE: "CondDist", CONDITION_YAW: "CondYaw",
    JUMP: "Jump", CHANGE_SPEED: "ChangeSpeed", SET_HOME: "SetHome", 181: "SetRelay",
    182: "RepeatRelay", 183: "SetServo", 184: "RepeatServo", 189: "LandStart", SET_ROI: "SetROI",
    202: "DigiCamCfg", DIGICAM: "DigiCamCtrl", 204: "MountConfigure", MOUNT_CONTROL: "MountControl",
    CAM_TRIGG_DIST: "SetCamTrigDst", FENCE_ENABLE: "FenceEnable", 208: "Parachute", 211: "Gripper",
    218: "AuxFunction", 222: "GuidedLimits", 600: "JumpTag", 601: "JumpToTag",
    GIMBAL_PITCHYAW: "GimbalPitchYaw", IMAGE_START: "ImageStartCapture",
    IMAGE_STOP: "ImageStopCapture", 2500: "VideoStartCapture", 2501: "VideoStopCapture",
    42600: "Winch", 42703: "NavAttitudeTime", 531: "SetCamZoom", 532: "SetCamFocus",
    194: "SetReverse", 215: "SetRepeatDist", 216: "Sprayer",
}  # fmt: skip

LOCATED = frozenset(
    {WAYPOINT, LOITER_UNLIM, LOITER_TURNS, LOITER_TIME, LAND, TAKEOFF, 30, 31, SPLINE, VTOL_TAKEOFF,
     VTOL_LAND, PAYLOAD_PLACE, SET_HOME, SET_ROI, 189}
)  # fmt: skip
NAV = frozenset(
    {WAYPOINT, LOITER_UNLIM, LOITER_TURNS, LOITER_TIME, RTL, LAND, TAKEOFF, 30, 31, SPLINE,
     GUIDED_ENABLE, DELAY, PAYLOAD_PLACE, VTOL_TAKEOFF, VTOL_LAND, 42703, 42702, 83}
)  # fmt: skip
# run by the mission library itself, which reports none of them as reached
UNREPORTED = frozenset(
    {181, 182, 183, 184, 194, 200, 202, DIGICAM, CAM_TRIGG_DIST, FENCE_ENABLE, 208, 211, 216, 218,
     531, 532, JUMP_TAG, GIMBAL_PITCHYAW, IMAGE_START, IMAGE_STOP, 2500, 2501}
)  # fmt: skip
_YAW_MAY_BE_NAN = frozenset({WAYPOINT, LAND, TAKEOFF, VTOL_TAKEOFF, VTOL_LAND})


@dataclass(frozen=True)
class Item:
    """One stored item. Position in 1e-7 degree and metres; `frame` as it is read back."""

    command: int
    frame: int = GLOBAL
    params: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    x: int = 0
    y: int = 0
    z_m: float = 0.0

    @property
    def is_nav(self) -> bool:
        """Whether the vehicle flies it (DO and CONDITION items are not flown)."""
        return self.command in NAV

    @property
    def reported(self) -> bool:
        """Whether it is reported as reached; the mission library's own items are not."""
        return self.command not in UNREPORTED

    @property
    def name(self) -> str:
        """What the autopilot calls it in its texts."""
        return NAMES.get(self.command, "?")


def _fault_of_params(message: Message) -> int:
    values = (message.param1, message.param2, message.param3, message.param4)
    for k, value in enumerate(values):
        if k == 3 and message.command in _YAW_MAY_BE_NAN and math.isnan(value):
            continue
        if not math.isfinite(value):
            return mavlink.MAV_MISSION_INVALID_PARAM1 + k
    return 0


def _fault_of_command(message: Message) -> int:
    if message.command == 0:
        return mavlink.MAV_MISSION_INVALID
    fault = _fault_of_params(message)
    return fault or (0 if message.command in NAMES else mavlink.MAV_MISSION_UNSUPPORTED)


def _fault_of_place(message: Message, x: int, y: int) -> int:
    if abs(x) > 900_000_000:
        return mavlink.MAV_MISSION_INVALID_PARAM5_X
    if abs(y) > 1_800_000_000:
        return mavlink.MAV_MISSION_INVALID_PARAM6_Y
    if not math.isfinite(message.z) or abs(message.z) >= LOCATION_ALT_MAX_M:
        return mavlink.MAV_MISSION_INVALID_PARAM7
    return 0 if message.frame in _FRAMES else mavlink.MAV_MISSION_UNSUPPORTED_FRAME


def place_of(message: Message) -> tuple[int, int] | None:
    """Latitude and longitude (1e-7 degree) of either form of item, None where there is none."""
    if message.get_type() != "MISSION_ITEM":
        return message.x, message.y
    if not all(abs(v) < _DEGREES_MAX for v in (message.x, message.y)):
        return None
    return int(as_float32(message.x * 1e7)), int(as_float32(message.y * 1e7))


def parse(message: Message) -> tuple[Item | None, int]:
    """Item of a MISSION_ITEM_INT or MISSION_ITEM and 0, or None and the MAV_MISSION_RESULT."""
    command = message.command
    fault = _fault_of_command(message)
    if fault:
        return None, fault
    place = place_of(message)
    if place is None:
        return None, mavlink.MAV_MISSION_INVALID_PARAM5_X
    x, y = place
    params = _kept_params(command, message)
    if command == DIGICAM:
        # shooting command and command identity travel in x and y, as plain numbers
        return Item(command, GLOBAL, params, int(message.x) & 0xFF, int(message.y) & 0xFF), 0
    if command not in LOCATED:
        return Item(command, GLOBAL, params), 0
    fault = _fault_of_place(message, x, y)
    if fault:
        return None, fault
    z_m = math.trunc(message.z * 100.0) / 100.0
    return Item(command, _FRAMES[message.frame], params, x, y, z_m), 0


def _kept_params(command: int, message: Message) -> tuple[float, float, float, float]:
    """What of param1..4 survives storage: integers are cut, the unused ones are lost."""
    p1, p2, p3, p4 = message.param1, message.param2, message.param3, message.param4
    whole = float(int(p1) & 0xFFFF)
    kept = {
        LOITER_UNLIM: (0.0, 0.0, 0.0, 0.0),
        LAND: (whole, 0.0, 0.0, 1.0),
        LOITER_TIME: (whole, 0.0, -1.0 if p3 < 0 else 1.0, 0.0),
        LOITER_TURNS: (float(int(p1)), 0.0, _kept_radius(p3), 0.0),
        MOUNT_CONTROL: (p1, p2, p3, 0.0),
    }
    if command in kept:
        return kept[command]
    if command in (WAYPOINT, SPLINE, TAKEOFF, VTOL_TAKEOFF):
        return whole, 0.0, 0.0, 0.0
    if command in (SET_HOME, SET_ROI, 189, VTOL_LAND, 30, 31):
        return float(int(p1)), 0.0, 0.0, 0.0
    if command in (JUMP, JUMP_TAG, DO_JUMP_TAG, RTL):
        return float(int(p1)), float(int(p2)), 0.0, 0.0
    return p1, p2, p3, p4


def _kept_radius(radius_m: float) -> float:
    """Whole metres up to 255, tens of metres beyond."""
    size = abs(radius_m)
    return math.copysign(int(size) if size < 256 else 10 * int(size / 10), radius_m)


@dataclass
class Store:
    """Items by mission type; they outlive a restart."""

    lists: dict[int, list[Item]] = field(
        default_factory=lambda: {MISSION: [], FENCE: [], RALLY: []}
    )

    def count(self, kind: int) -> int:
        """How many items a list holds."""
        return len(self.lists[kind])

    @property
    def mission(self) -> list[Item]:
        """The mission, home included as item 0."""
        return self.lists[MISSION]

    def truncate(self, count: int) -> bool:
        """Shorten the mission; true if that changed it."""
        if count >= len(self.mission):
            return False
        del self.mission[count:]
        return True

    def put(self, seq: int, item: Item) -> None:
        """Replace or append one mission item."""
        if seq < len(self.mission):
            self.mission[seq] = item
        else:
            self.mission.append(item)

    def replace(self, kind: int, items: list[Item]) -> None:
        """Replace a whole fence or rally list."""
        self.lists[kind] = items
