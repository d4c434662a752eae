"""Names of topics, services and frames: no other file spells one out."""

from __future__ import annotations

MAP_FRAME = "map"  # ENU metres about the plan's origin

ADJACENCY = "/jfto/topology/adjacency"
POWER_INTERVAL = "/jfto/topology/power_interval"
POWER_SCHEDULE = "/jfto/power/schedule"
ENERGY_LEFT = "/jfto/power/energy_left"
MARKERS = "/jfto/markers"
TERRAIN = "/jfto/terrain"
DIAGNOSTICS = "/diagnostics"
EVENTS = "/jfto/events"
LIFT_OFF = "/jfto/mission/lift_off"
MISSION_STATE = "/jfto/mission/state"
AIR_POWER = "/jfto/air/power"
AIR_ENERGY = "/jfto/air/energy"
AIR_RATE = "/jfto/air/rate"
AIR_DELIVERY = "/jfto/air/delivery"
AIR_GAIN = "/jfto/air/gain"
CLOCK = "/clock"
CLOCK_TAKEN = "/clock_taken"
REPLAN = "/jfto/planner/replan"
_MISSION_VERBS = ("upload", "check", "start", "pause", "resume", "abort", "land")
MISSION_SERVICES = tuple(f"/jfto/mission/{verb}" for verb in _MISSION_VERBS)


def mission(verb: str) -> str:
    """Service that gives the fleet an order."""
    return f"/jfto/mission/{verb}"


# What a recording of the graph holds, as a regular expression for `bag record --regex`.
RECORDED = (
    "^(/jfto/.*|/[^/]+/jfto/.*|/[^/]+/(pose|fix|battery)|/diagnostics|/rosout|/parameter_events)$"
)


def path(uav_id: str) -> str:
    """Planned waypoints of a UAV."""
    return f"/{uav_id}/jfto/path"


def trajectory(uav_id: str) -> str:
    """Planned trajectory of a UAV."""
    return f"/{uav_id}/jfto/trajectory"


def tx_power(uav_id: str) -> str:
    """Transmit-power setpoint in force, dBm."""
    return f"/{uav_id}/jfto/tx_power"


def tx_power_applied(uav_id: str) -> str:
    """Transmit power read back from a UAV's radio, dBm."""
    return f"/{uav_id}/jfto/tx_power_applied"


def pose(uav_id: str) -> str:
    """Measured pose of a UAV in the map frame."""
    return f"/{uav_id}/pose"


def fix(uav_id: str) -> str:
    """Measured geodetic position of a UAV."""
    return f"/{uav_id}/fix"


def battery(uav_id: str) -> str:
    """State of a UAV's flight battery."""
    return f"/{uav_id}/battery"
