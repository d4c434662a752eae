"""Photo positions of a mission file: waypoints, or where its camera is triggered."""

from __future__ import annotations

import math
from collections import Counter

from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.mission_file import FileItem, MissionDocument
from jfto_planner.coverage.camera_aim import CameraAim
from jfto_planner.coverage.photo_trigger import PhotoTrigger
from jfto_planner.coverage.places import Places, Spot
from jfto_planner.coverage.raw_waypoint import RawWaypoint

# MAV_CMD numbers (mavlink.io, common.xml).
_WAYPOINTS = (16, 82)
_PASSED = {19: "loiter for a time", 20: "return", 21: "landing", 22: "take-off", 93: "delay"}
_LAST_NAVIGATION = 95
_SPEED, _SET_HOME, _WITHIN = 178, 179, 114
_OTHERS = {177: "jump (177)", _SPEED: "speed (178)"}
# Photos nearer than this are one: a line's last and the next line's first, or crossing lines.
_SAME_M = 0.05


def photos_of_mission(
    document: MissionDocument, source: str, places: Places, notes: list[str]
) -> list[RawWaypoint]:
    """Photo positions of a mission, in its order.

    Where it triggers a camera (by distance, by time, photo by photo), these are the places of
    its photos along the lines; else all its waypoints. `notes` gets a line on all that is not used.
    Raises WaypointError.
    """
    keeps_heading = dict(document.parameters).get("WP_YAW_BEHAVIOR") == 0
    reader = _Reader(source, places, notes, keeps_heading=keeps_heading)
    reader.trigger.speed_mps = document.hover_speed_mps
    for item in document.items:
        reader.read(item)
    notes.extend(document.notes)
    found = reader.finish()
    for name, part in (("fence items", document.fence), ("rally points", document.rally)):
        if part:
            notes.append(f"{source}: its {len(part)} {name} are not used for photos")
    return found


class _Reader:
    """Flies through the items as a vehicle would, and keeps where photos are taken."""

    def __init__(
        self, source: str, places: Places, notes: list[str], *, keeps_heading: bool
    ) -> None:
        self._source, self._places, self._notes = source, places, notes
        self._aim = CameraAim(keeps_heading=keeps_heading)
        # Orders to the camera that wait until so far (m) before the next waypoint.
        self._within_m = 0.0
        self._waiting: list[FileItem] = []
        self.trigger = PhotoTrigger()
        self._here: Spot | None = None
        self._course_deg: float | None = None
        self._waypoints: list[RawWaypoint] = []
        self._photos: list[RawWaypoint] = []
        self._passed: Counter[str] = Counter()
        # Places whose heading is a command's that ArduCopter would have dropped.
        self._held: dict[str, list[str]] = {"waypoints": [], "photos": []}

    def read(self, item: FileItem) -> None:
        command = item.command
        if command in _WAYPOINTS:
            self._waypoint(item)
        elif command in _PASSED:
            self._passed[f"{_PASSED[command]} ({command})"] += 1
            if command == 22:
                self._here = self._places.take_off(item)
        elif command <= _LAST_NAVIGATION:
            raise WaypointError(
                f"{item.place}: command {command} is neither a waypoint nor a take-off, return or "
                "landing. Replace it by a waypoint (16)."
            )
        elif command == _WITHIN:
            self._within_m = max(item.params[0], 0.0)
        elif self._within_m and command in PhotoTrigger.COMMANDS:
            self._waiting.append(item)
        elif self._aim.take(item, self._places):
            pass
        elif self.trigger.take(item):
            if self.trigger.shoots_now and self._here is not None:
                self._shoot(self._here, item.place)
        else:
            self._other(item)

    def _other(self, item: FileItem) -> None:
        if item.command == _SET_HOME:
            raise WaypointError(
                f"{item.place}: moves home (179), from which later heights count. Take it out, or "
                "give heights above sea level or terrain."
            )
        if item.command == _SPEED and item.params[0] in (0, 1) and item.params[1] > 0:
            self.trigger.speed_mps = item.params[1]
        self._passed[_OTHERS.get(item.command, f"command {item.command}")] += 1

    def _waypoint(self, item: FileItem) -> None:
        spot = self._places.spot(item)
        if item.command == 82 and self.trigger.active:
            self._passed["curve of a spline (82), taken as straight"] += 1
        start = self._here
        if start is not None:
            east, north = (spot.position_m[k] - start.position_m[k] for k in range(2))
            if math.hypot(east, north) > 0.1:
                self._course_deg = math.degrees(math.atan2(east, north)) % 360.0
        self._aim.reach(item)
        for begin, end in self._parts(start, spot):
            for along in self.trigger.along(item.place, begin, end):
                self._shoot(self._places.between(begin, end, along), item.place)
            for waiting in self._waiting:
                self.trigger.take(waiting)
            self._waiting = []
        self._within_m = 0.0
        self._here = spot
        yaw_deg, pitch_deg = self._aim.angles(spot.position_m, item.place, 0.0)
        self._held["waypoints"] += [item.place] * self._aim.held
        self._waypoints.append(RawWaypoint(item.place, spot.position_m, yaw_deg, pitch_deg))

    def _parts(self, start: Spot | None, end: Spot) -> list[tuple[Spot | None, Spot]]:
        """The leg, divided where orders wait for its last metres (114)."""
        if start is None or not self._waiting:
            return [(start, end)]
        length_m = math.dist(start.position_m[:2], end.position_m[:2])
        share = max(1.0 - self._within_m / length_m, 0.0) if length_m > 0 else 0.0
        middle = self._places.between(start, end, share)
        return [(start, middle), (middle, end)]

    def _shoot(self, spot: Spot, place: str) -> None:
        yaw_deg, pitch_deg = self._aim.angles(spot.position_m, place, self._course_deg or 0.0)
        self._held["photos"] += [place] * self._aim.held
        self._photos.append(RawWaypoint(place, spot.position_m, yaw_deg, pitch_deg))

    def finish(self) -> list[RawWaypoint]:
        if not self.trigger.used:
            found = self._waypoints
        else:
            if self.trigger.due_here and self._here is not None:
                self._shoot(self._here, self._source)
            found = _once(self._photos)
            twice = len(self._photos) - len(found)
            self._notes.append(
                f"{self._source}: {len(found)} photo positions laid out where its camera is "
                f"triggered; its {len(self._waypoints)} waypoints only mark the way"
                + (
                    f"; {twice} photos at a place that has one already are left out"
                    if twice
                    else ""
                )
            )
        if self._passed:
            listed = ", ".join(f"{name} × {count}" for name, count in self._passed.items())
            self._notes.append(f"{self._source}: passed over: {listed}")
        self._notes.extend(f"{self._source}: {text}" for text in self._aim.notes)
        held = self._held["photos" if self.trigger.used else "waypoints"]
        if held:
            self._notes.append(
                f"{held[0]}: the last heading (115) is taken to hold here too, though ArduCopter "
                f"drops it at the next waypoint ({len(held)} times)"
            )
        if not found:
            raise WaypointError(
                f"{self._source} holds no waypoint to photograph from: "
                f"{', '.join(self._passed) or 'it has no items'}. Write one or more into it."
            )
        return found


def _once(photos: list[RawWaypoint]) -> list[RawWaypoint]:
    """Photos without those at a place that has one already."""
    taken: dict[tuple[int, ...], list[RawWaypoint]] = {}
    found = []
    for photo in photos:
        cell = tuple(math.floor(value / _SAME_M) for value in photo.position_m)
        near = (
            other
            for x in (-1, 0, 1)
            for y in (-1, 0, 1)
            for z in (-1, 0, 1)
            for other in taken.get((cell[0] + x, cell[1] + y, cell[2] + z), ())
        )
        if all(math.dist(photo.position_m, other.position_m) > _SAME_M for other in near):
            taken.setdefault(cell, []).append(photo)
            found.append(photo)
    return found
