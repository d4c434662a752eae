"""The node graph of a scenario, for `ros2 launch jfto jfto.launch.py scenario:=…`.

scenario      parameter file, absolute or relative to the working directory
backend       sim: simulated vehicles; sitl, real: vehicles behind `vehicles`; replay: play `bag`
vehicles      roster entries, as `jfto fly --vehicles` takes them
plan          plan file: loaded, or planned and kept there if it does not exist
record        true: record the graph's topics to a bag in the working directory
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

# name, default, allowed values (none: any), what it is
ARGUMENTS = (
    ("scenario", None, (), "Scenario, a ROS 2 parameter file."),
    ("backend", "sim", ("sim", "sitl", "real", "replay"), "Where poses come from."),
    ("vehicles", "", (), "Roster for sitl and real, for example uav1=1@udpin:0.0.0.0:14550."),
    ("bag", "", (), "Bag to play, for replay."),
    ("plan", "", (), "Plan file: loaded, or made if it does not exist."),
    ("use_sim_time", "false", ("true", "false"), "Take the time from /clock."),
    ("record", "false", ("true", "false"), "Record the graph's topics."),
    ("rviz", "false", ("true", "false"), "Open RViz."),
    ("foxglove", "false", ("true", "false"), "Serve Foxglove on port 8765."),
)
INPUTS_REGEX = "/[^/]+/(pose|fix|battery)"
OUTPUTS_REGEX = "/jfto/.*|/[^/]+/jfto/.*|/[^/]+/(pose|fix|battery)|/diagnostics|/rosout"


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
    backend, is_replay = given["backend"], given["backend"] == "replay"
    if backend in {"sitl", "real"} and not given["vehicles"]:
        raise RuntimeError(f"backend:={backend} needs vehicles:=…, the roster.")
    if is_replay and not given["bag"]:
        raise RuntimeError("backend:=replay needs bag:=…, the bag to play.")
    # A replay has the planner's trajectories in its bag, and the bag's clock.
    sim_time = given["use_sim_time"] == "true" or is_replay
    started = [
        _node("topology_node", given, sim_time),
        _node("power_node", given, sim_time),
    ]
    if not is_replay:
        started.insert(0, _node("planner_node", given, sim_time, plan_file=given["plan"]))
    if is_replay:
        play = ["ros2", "bag", "play", given["bag"], "--clock", "--regex"]
        wanted = f"{INPUTS_REGEX}|/[^/]+/jfto/(path|trajectory)"
        started.append(ExecuteProcess(cmd=[*play, wanted], output="screen"))
    elif backend == "sim" and not given["vehicles"]:
        started.append(_node("pose_player", given, sim_time))
    else:
        started.append(_node("mavlink_bridge", given, sim_time, vehicles=given["vehicles"]))
    if given["record"] == "true":
        record = ["ros2", "bag", "record", "-s", "mcap", "--regex", OUTPUTS_REGEX]
        started.append(ExecuteProcess(cmd=record, output="screen"))
    if given["rviz"] == "true":
        started.append(Node(package="rviz2", executable="rviz2", arguments=["-f", "map"]))
    if given["foxglove"] == "true":
        started.append(Node(package="foxglove_bridge", executable="foxglove_bridge"))
    return started


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
