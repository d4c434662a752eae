"""Where a mission's camera looks: heading, gimbal, or a region of interest."""

from __future__ import annotations

import math

from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.mission_file import FileItem
from jfto_msgs_py.records.plan import Vector
from jfto_planner.coverage.places import Places

# MAV_CMD numbers (mavlink.io, common.xml).
_CONDITION_YAW, _MOUNT_CONTROL, _GIMBAL_PITCH_YAW = 115, 205, 1000
_ROI_LOCATION, _ROI_NONE, _ROI = 195, 197, 201
_OTHER_ROI = (196, 198)
_ROI_MODE_NONE, _ROI_MODE_LOCATION, _MOUNT_AT_PLACE = 0, 3, 4
_YAW_LOCK = 16


class CameraAim:
    """The camera's aim as items change it. Degrees; pitch is -90 straight down."""

    def __init__(self, *, keeps_heading: bool = False) -> None:
        self.notes: list[str] = []
        # Whether the file's parameters tell ArduCopter to keep a heading beyond a waypoint.
        self._keeps_heading = keeps_heading
        self._pitch_deg = -90.0
        self._gimbal_yaw_deg = 0.0
        self._gimbal_locked = False
        self._heading_deg: float | None = None
        self._last_deg: float | None = None
        self._fresh = False
        self._own = False
        # Whether the heading in force is a command's (115) that ArduCopter would have dropped.
        self.held = False
        self._region_m: Vector | None = None

    def take(self, item: FileItem, places: Places) -> bool:
        """Whether an item turns the camera, which then is done. Raises WaypointError."""
        if item.command == _CONDITION_YAW:
            self._turn(item)
        elif item.command in (_MOUNT_CONTROL, _GIMBAL_PITCH_YAW):
            self._gimbal(item)
        elif item.command in (_ROI_LOCATION, _ROI):
            self._look_at(item, places)
        elif item.command == _ROI_NONE:
            self._region_m = None
        elif item.command in _OTHER_ROI:
            raise WaypointError(
                f"{item.place}: command {item.command} points the camera in a way that cannot be "
                "told from the file. Use a location (195) or angles (205)."
            )
        else:
            return False
        return True

    def _turn(self, item: FileItem) -> None:
        angle, _, direction, relative = item.params[:4]
        if math.isnan(angle):
            raise WaypointError(f"{item.place}: heading is None, must be a number. Give it one.")
        if relative == 1:
            if self._last_deg is None:
                raise WaypointError(
                    f"{item.place}: turns by {angle:g}° from a heading that the file does not "
                    "give. Write it as an absolute heading (parameter 4 = 0)."
                )
            angle = self._last_deg + (-angle if direction < 0 else angle)
        self._heading_deg = self._last_deg = angle % 360.0
        self._fresh, self._own, self.held = True, False, False

    def _gimbal(self, item: FileItem) -> None:
        pitch, second, third = item.params[:3]
        if item.command == _MOUNT_CONTROL:
            if item.params[6] == _MOUNT_AT_PLACE:
                raise WaypointError(
                    f"{item.place}: points the mount at a place (mode 4). Use a region of interest "
                    "(195) instead."
                )
            roll, yaw, locked = second, third, False
            if roll and not math.isnan(roll):
                self._say(f"a roll of the camera is not used (first {item.place})")
        else:
            flags = item.params[4]
            yaw, locked = second, bool(int(flags) & _YAW_LOCK)
        if math.isnan(pitch):
            self._say(f"a gimbal command without an angle is not used (first {item.place})")
            return
        # Angles end the looking at a region.
        self._region_m = None
        self._pitch_deg = pitch
        self._gimbal_yaw_deg = 0.0 if math.isnan(yaw) else yaw
        self._gimbal_locked = locked and not math.isnan(yaw)

    def _look_at(self, item: FileItem, places: Places) -> None:
        if item.command == _ROI and item.params[0] not in (_ROI_MODE_NONE, _ROI_MODE_LOCATION):
            raise WaypointError(
                f"{item.place}: region of interest of mode {item.params[0]:g}. Use a location "
                "(mode 3, or command 195)."
            )
        here = item.command == _ROI_LOCATION or item.params[0] == _ROI_MODE_LOCATION
        # ArduCopter takes a place of zeros for none.
        nowhere = not any(item.params[4:])
        self._region_m = places.spot(item).position_m if here and not nowhere else None

    def reach(self, item: FileItem) -> None:
        """Take a waypoint's own heading, its fourth parameter, where it gives one."""
        own_deg = 0.0 if math.isnan(item.params[3]) else item.params[3] % 360.0
        if self._fresh:
            self._fresh = False
        elif own_deg:
            self._heading_deg = self._last_deg = own_deg
            self._own, self.held = True, False
        elif self._own:
            self._heading_deg, self._own = None, False
        else:
            self.held = self._heading_deg is not None and not self._keeps_heading

    def angles(self, position_m: Vector, place: str, course_deg: float) -> tuple[float, float]:
        """Yaw and pitch of a photo from here; `course_deg` where no heading was given."""
        if self._region_m is not None:
            east, north, up = (b - a for a, b in zip(position_m, self._region_m, strict=True))
            level = math.hypot(east, north)
            if level < 1e-3 and abs(up) < 1e-3:
                raise WaypointError(
                    f"{place}: is at the region of interest itself. Move one of them."
                )
            # Straight down has no heading of its own.
            bearing = math.degrees(math.atan2(east, north)) if level > 1e-3 else course_deg
            return bearing % 360.0, math.degrees(math.atan2(up, level))
        heading = course_deg if self._heading_deg is None else self._heading_deg
        base = 0.0 if self._gimbal_locked else heading
        return (base + self._gimbal_yaw_deg) % 360.0, self._pitch_deg

    def _say(self, text: str) -> None:
        # One line for each kind, however often it is met.
        kind = text.partition("(")[0]
        if not any(known.startswith(kind) for known in self.notes):
            self.notes.append(text)
