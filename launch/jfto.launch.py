"""The node graph of a scenario, for `ros2 launch jfto jfto.launch.py scenario:=…`.

scenario      parameter file, absolute or relative to the working directory
backend       sim: simulated vehicles; sitl, real: vehicles behind `vehicles`; replay: play `bag`
vehicles      for sitl and real: links, or roster entries as `jfto up --vehicles` takes them,
              separated by commas; left out: the scenario's section mavlink_bridge
speedup       sim: how much faster than the wall the vehicles' time runs, which all nodes keep
arm           true: let the start service arm vehicles that are real
plan          plan file: loaded, or planned and kept there if it does not exist
record        true: record the graph's topics to a bag in the working directory
"""

import tempfile
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

# name, default, allowed values (none: any), what it is
ARGUMENTS = (
    ("scenario", None, (), "Scenario, a ROS 2 parameter file."),
    ("backend", "sim", ("sim", "sitl", "real", "replay"), "Where poses come from."),
    ("vehicles", "", (), "For sitl and real: udpin:0.0.0.0:14550, or uav1=1@udpin:0.0.0.0:14550,…"),
    ("speedup", "1.0", (), "For sim: how much faster than the wall."),
    ("arm", "false", ("true", "false"), "Let the start service arm real vehicles."),
    ("bag", "", (), "Bag to play, for replay."),
    ("plan", "", (), "Plan file: loaded, or made if it does not exist."),
    ("use_sim_time", "false", ("true", "false"), "Take the time from /clock."),
    ("record", "false", ("true", "false"), "Record the graph's topics."),
    ("rviz", "false", ("true", "false"), "Open RViz."),
    ("foxglove", "false", ("true", "false"), "Serve Foxglove on port 8765."),
)
# Where the simulated vehicles send to and the bridge listens.
SIM_LINK = "127.0.0.1:14550"
# Where the simulated fleet takes the powers of its radios.
SIM_CONTROL_PORT = 14551
INPUTS_REGEX = "/[^/]+/(pose|fix|battery)"
# As jfto_msgs_py.ros.topics has it.
RECORDED = (
    "^(/jfto/.*|/[^/]+/jfto/.*|/[^/]+/(pose|fix|battery)|/diagnostics|/rosout|/parameter_events)$"
)


def generate_launch_description():
    """Declare the arguments; what they ask for is started when they are known."""
    declared = []
    for name, default, choices, text in ARGUMENTS:
        options = {"description": text}
        if default is not None:
            options["default_value"] = default
        if choices:
            options["choices"] = list(choices)
        declared.append(DeclareLaunchArgument(name, **options))
    return LaunchDescription([*declared, OpaqueFunction(function=_start)])


def _start(context):
    """Processes for the arguments as given."""
    given = {name: LaunchConfiguration(name).perform(context) for name, *_ in ARGUMENTS}
    is_replay, is_sim = given["backend"] == "replay", given["backend"] == "sim"
    if is_replay and not given["bag"]:
        raise RuntimeError("backend:=replay needs bag:=…, the bag to play.")
    # A replay has the planner's trajectories in its bag, and the bag's clock.
    sim_time = given["use_sim_time"] == "true" or is_replay or is_sim
    if not (is_replay or given["plan"]):
        # Planner, bridge and simulation meet in this file.
        given["plan"] = str(Path(tempfile.mkdtemp(prefix="jfto-")) / "plan.json")
    started = [
        _node("topology_node", given, sim_time),
        _node("power_node", given, sim_time),
    ]
    if is_replay:
        play = ["ros2", "bag", "play", given["bag"], "--clock", "--regex"]
        wanted = f"{INPUTS_REGEX}|/[^/]+/jfto/(path|trajectory)"
        started.append(ExecuteProcess(cmd=[*play, wanted], output="screen"))
    else:
        plan = {"plan_file": given["plan"], "await_lift_off": True}
        started.append(_node("planner_node", given, sim_time, **plan))
        started += _vehicles(given, sim_time)
    if given["record"] == "true":
        record = ["ros2", "bag", "record", "-s", "mcap", "--regex", RECORDED]
        record += ["--use-sim-time"] if sim_time else []
        started.append(ExecuteProcess(cmd=record, output="screen"))
    if given["rviz"] == "true":
        started.append(Node(package="rviz2", executable="rviz2", arguments=["-f", "map"]))
    if given["foxglove"] == "true":
        started.append(Node(package="foxglove_bridge", executable="foxglove_bridge"))
    return started


def _vehicles(given, sim_time):
    """The bridge, and simulated vehicles where they are asked for."""
    own = {"plan_file": given["plan"]}
    if given["backend"] == "sim":
        speedup = float(given["speedup"])
        fleet = {"endpoint": f"udpto:{SIM_LINK}", "speedup": speedup, **own}
        fleet["control_port"] = SIM_CONTROL_PORT
        radio = {"driver": "sim", "control": f"127.0.0.1:{SIM_CONTROL_PORT}"}
        own |= {"endpoints": [f"udpin:{SIM_LINK}"], "speedup": speedup}
        own |= {"vehicle_stamps": True, "allow_arming": True}
        return [
            _node("simulated_fleet", given, sim_time, **fleet),
            _node("mavlink_bridge", given, sim_time, **own),
            _node("radio_node", given, sim_time, **radio),
        ]
    named = [text for text in given["vehicles"].split(",") if text]
    own["roster" if "=" in given["vehicles"] else "endpoints"] = named
    own["allow_arming"] = given["arm"] == "true"
    return [_node("mavlink_bridge", given, sim_time, **own)]


def _node(name, given, sim_time, **own):
    """One of our nodes with the scenario's parameters and its own, started again if it dies."""
    own = {key: value for key, value in own.items() if value}
    return Node(
        package="jfto",
        executable=name,
        name=name,
        output="screen",
        emulate_tty=True,
        parameters=[given["scenario"], {"use_sim_time": sim_time, **own}],
        respawn=True,
        respawn_delay=0.5,
    )
