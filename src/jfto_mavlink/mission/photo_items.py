"""Steps of a route as the items that an ArduCopter is sent for them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.protocol.item import FRAME_HOME, FRAME_NONE, Item, Place, at
from jfto_msgs_py.records.plan import Route
from jfto_msgs_py.types import Array
from jfto_world.mission.steps import Kind, Step
from jfto_world.terrain.frame import LocalFrame

# The camera is turned to a place so far away, level: a few metres beside the waypoint do not
# matter, and the Earth is still flat.
LOOK_M = 1000.0
# Heights of which the autopilot loses nothing however often it is sent them.
_KEPT_M = 0.25
_ROI_LOCATION = float(mavlink.MAV_ROI_LOCATION)


# Command and its first parameters.
_ORDERS: dict[Kind, Callable[[Step], tuple[float, ...]]] = {
    Kind.TILT: lambda step: (mavlink.MAV_CMD_DO_MOUNT_CONTROL, step.value),
    Kind.TURN: lambda step: (mavlink.MAV_CMD_CONDITION_YAW, step.value),
    Kind.SHOOT: lambda _: (mavlink.MAV_CMD_IMAGE_START_CAPTURE, 0.0, 1.0, 1.0),
    Kind.EVERY: lambda step: (mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST, step.value, 0.0, 1.0),
    Kind.NO_MORE: lambda _: (mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST,),
    Kind.WITHIN: lambda step: (mavlink.MAV_CMD_CONDITION_DISTANCE, step.value),
    Kind.SERIES: lambda step: (
        mavlink.MAV_CMD_IMAGE_START_CAPTURE,
        0.0,
        step.value,
        step.other,
    ),
}


@dataclass(frozen=True)
class PhotoItems:
    """Makes items of one route's steps.

    `points_m` (K, 3) are its waypoints, ENU, `places` the same as latitude, longitude and height
    above home, of which `home_alt_m` is the altitude.
    """

    route: Route
    points_m: Array
    places: Sequence[Place]
    frame: LocalFrame
    home_alt_m: float
    settings: MissionSettings

    def of(self, step: Step) -> Item:
        """The item of a step; raises MissionError for a gate without a moment of lift-off."""
        if step.kind is Kind.GO:
            hold_s = self.settings.hold_s if self.settings.style == "hold" else 0.0
            place = self.places[step.waypoint]
            return at(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_HOME, *place, hold_s)
        if step.kind is Kind.LOOK:
            return self._look(step)
        if step.kind is Kind.GATE:
            return self._gate(self.route.arrival_s[step.waypoint])
        if step.kind is Kind.SHOOT and self.settings.shutter == "digicam":
            # x is param5, the shooting command.
            return Item(mavlink.MAV_CMD_DO_DIGICAM_CONTROL, FRAME_NONE, x=1)
        if step.kind is Kind.TILT and self.settings.mount == "gimbal_manager":
            return _do(mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, step.value)
        command, *params = _ORDERS[step.kind](step)
        return _do(int(command), *params)

    def _look(self, step: Step) -> Item:
        east, north, up = self.points_m[step.waypoint]
        yaw, pitch = math.radians(step.value), math.radians(step.other)
        far = (
            east + LOOK_M * math.sin(yaw),
            north + LOOK_M * math.cos(yaw),
            up + LOOK_M * math.tan(pitch),
        )
        lat, lon, alt = (float(value) for value in self.frame.to_geodetic(far))
        height_m = round((alt - self.home_alt_m) / _KEPT_M) * _KEPT_M
        return at(mavlink.MAV_CMD_DO_SET_ROI, FRAME_HOME, lat, lon, height_m, _ROI_LOCATION)

    def _gate(self, arrival_s: float) -> Item:
        """Wait for a second of the minute: with hour and minute, a late one would wait a day."""
        if self.settings.start_unix_s is None:
            raise MissionError(303, "time gates need the planned moment of lift-off.")
        leave = math.ceil(self.settings.start_unix_s + arrival_s + self.settings.gate_slack_s)
        return _do(mavlink.MAV_CMD_NAV_DELAY, -1.0, -1.0, -1.0, float(leave % 60))


def _do(command: int, p1: float = 0.0, p2: float = 0.0, p3: float = 0.0, p4: float = 0.0) -> Item:
    return Item(command, FRAME_NONE, (p1, p2, p3, p4))
