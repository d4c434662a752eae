"""The graph's topics and services: name, type, quality of service, and who offers them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from jfto_msgs_py.ros import qos, topics

# Stands for a UAV's id in names.
UAV = "<uav>"


@dataclass(frozen=True)
class Topic:
    """One topic; `by` and `to` are nodes, "any" standing for whoever looks."""

    name: str
    type: str
    qos: Callable[[], Any]
    by: tuple[str, ...]
    to: tuple[str, ...]
    doc: str


@dataclass(frozen=True)
class Service:
    """One service."""

    name: str
    type: str
    by: str
    doc: str


_PLANNER, _TOPOLOGY, _POWER, _PLAYER = "planner_node", "topology_node", "power_node", "pose_player"
_BRIDGE, _RADIO, _FLEET = "mavlink_bridge", "radio_node", "simulated_fleet"

TOPICS = (
    Topic(
        topics.path(UAV),
        "nav_msgs/msg/Path",
        qos.latched,
        (_PLANNER,),
        ("any",),
        "pad and waypoints, stamps are planned arrivals",
    ),
    Topic(
        topics.trajectory(UAV),
        "trajectory_msgs/msg/MultiDOFJointTrajectory",
        qos.latched,
        (_PLANNER,),
        (_TOPOLOGY, _POWER, _PLAYER, _BRIDGE),
        "planned motion, header stamp is lift-off",
    ),
    Topic(
        topics.pose(UAV),
        "geometry_msgs/msg/PoseStamped",
        qos.sensor,
        (_BRIDGE, _PLAYER),
        (_TOPOLOGY, _POWER, _FLEET),
        "measured pose, frame `map`: ENU metres about the plan's origin",
    ),
    Topic(
        topics.fix(UAV),
        "sensor_msgs/msg/NavSatFix",
        qos.sensor,
        (_BRIDGE,),
        ("any",),
        "measured geodetic position",
    ),
    Topic(
        topics.battery(UAV),
        "sensor_msgs/msg/BatteryState",
        qos.sensor,
        (_BRIDGE,),
        ("any",),
        "flight battery",
    ),
    Topic(
        topics.ADJACENCY,
        "std_msgs/msg/UInt8MultiArray",
        qos.latched,
        (_TOPOLOGY,),
        (_POWER, _FLEET),
        "[slot, uav, uav], 1 for an active link",
    ),
    Topic(
        topics.POWER_INTERVAL,
        "std_msgs/msg/Float64MultiArray",
        qos.latched,
        (_TOPOLOGY,),
        (_POWER,),
        "[slot, uav, bound], least and greatest power in W",
    ),
    Topic(
        topics.POWER_SCHEDULE,
        "std_msgs/msg/Float64MultiArray",
        qos.latched,
        (_POWER,),
        ("any",),
        "[slot, uav], power in W",
    ),
    Topic(
        topics.ENERGY_LEFT,
        "std_msgs/msg/Float64MultiArray",
        qos.latched,
        (_POWER,),
        (_TOPOLOGY,),
        "[uav], energy left to each radio in J, once a slot; label `uav;ids=…;t=…`",
    ),
    Topic(
        topics.tx_power(UAV),
        "std_msgs/msg/Float64",
        qos.latched,
        (_POWER,),
        (_RADIO,),
        "setpoint in force, dBm; -inf for silence",
    ),
    Topic(
        topics.tx_power_applied(UAV),
        "std_msgs/msg/Float64",
        qos.latched,
        (_RADIO,),
        ("any",),
        "power read back from the radio, dBm; -inf for silence",
    ),
    *(
        Topic(topic, "std_msgs/msg/Float64MultiArray", qos.default, (_FLEET,), (to,), doc)
        for topic, to, doc in (
            (
                topics.AIR_POWER,
                "any",
                "[uav], W really sent; every 0.5 s, as all of these",
            ),
            (topics.AIR_ENERGY, "any", "[uav], energy sent so far in J"),
            (topics.AIR_RATE, "any", "[uav, uav], bit/s over links, 0 where there is none"),
            (
                topics.AIR_DELIVERY,
                "any",
                "[uav, uav], share of packets that arrive",
            ),
            (
                topics.AIR_GAIN,
                _TOPOLOGY,
                "[uav, uav], path gain as received, 0: not heard",
            ),
        )
    ),
    Topic(
        topics.MARKERS,
        "visualization_msgs/msg/MarkerArray",
        qos.latched,
        (_TOPOLOGY,),
        ("any",),
        "paths, links (colour and width say the margin), UAVs",
    ),
    Topic(
        topics.TERRAIN,
        "visualization_msgs/msg/MarkerArray",
        qos.latched,
        (_TOPOLOGY,),
        ("any",),
        "the ground as a mesh, where `terrain_cell_m` asks for it",
    ),
    Topic(
        topics.DIAGNOSTICS,
        "diagnostic_msgs/msg/DiagnosticArray",
        qos.default,
        (_PLANNER, _TOPOLOGY, _POWER, _RADIO, _PLAYER, _BRIDGE, _FLEET),
        ("any",),
        "one status per UAV and node, once a second",
    ),
    Topic(
        topics.EVENTS,
        "rcl_interfaces/msg/Log",
        qos.events,
        (_PLANNER, _TOPOLOGY, _POWER, _RADIO, _PLAYER, _BRIDGE, _FLEET),
        ("any",),
        "what happened and what was done: kind in `function`, UAV or nothing in `file`",
    ),
    Topic(
        topics.MISSION_STATE,
        "diagnostic_msgs/msg/DiagnosticStatus",
        qos.latched,
        (_BRIDGE,),
        ("any",),
        "what the fleet is at (`phase`), the last order and what came of it (`order`, "
        "`order_state`, `order_text`), and what went wrong since (`alarm`, level ERROR)",
    ),
    Topic(
        topics.LIFT_OFF,
        "std_msgs/msg/Header",
        qos.latched,
        (_BRIDGE,),
        (_PLANNER, _FLEET),
        "when the flight began: time zero of the plan; once per flight. `frame_id` is the plan's "
        "tag: that of another plan is refused",
    ),
    Topic(
        topics.CLOCK,
        "rosgraph_msgs/msg/Clock",
        qos.clock,
        (_FLEET,),
        ("all with use_sim_time",),
        "time of the simulated vehicles, begun at the wall's and up to `speedup` times faster",
    ),
    Topic(
        topics.CLOCK_TAKEN,
        "std_msgs/msg/Header",
        qos.reports,
        (_PLANNER, _TOPOLOGY, _POWER, _RADIO, _PLAYER, _BRIDGE, _FLEET),
        (_FLEET,),
        "with use_sim_time: how far a node (`frame_id`) has come; the vehicles' time waits for it",
    ),
)
SERVICES = (
    Service(
        topics.REPLAN,
        "std_srvs/srv/Trigger",
        _PLANNER,
        "plan anew from the parameters; answers when the plan is published or has failed",
    ),
    *(
        Service(name, "std_srvs/srv/Trigger", _BRIDGE, doc)
        for name, doc in zip(
            topics.MISSION_SERVICES,
            (
                "upload all missions, read them back and compare: all or none",
                "hold the fleet at the gate before arming, and arm nobody: what speaks against it",
                "check, arm and start the fleet; answers when all fly. Needs allow_arming",
                "hold all that fly their mission",
                "let all go on that hold",
                "bring all home, at once and whatever else is under way",
                "let all land where they are, at once and whatever else is under way",
            ),
            strict=True,
        )
    ),
)
