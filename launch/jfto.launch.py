"""The node graph of a scenario, for `ros2 launch jfto jfto.launch.py scenario:=…`.

It starts the processes of `jfto.supervision.graph_table`, which `jfto up` and `jfto run` start too.
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
    (
        "directory",
        "",
        (),
        "Where plan, lift-off, energy, flight and logs are kept; else a new one.",
    ),
    ("plan", "", (), "Plan file: loaded, or made if it does not exist."),
    ("use_sim_time", "false", ("true", "false"), "Take the time from /clock."),
    ("record", "false", ("true", "false"), "Record the graph's topics to the directory."),
    ("rviz", "false", ("true", "false"), "Open RViz."),
    ("foxglove", "false", ("true", "false"), "Serve Foxglove on port 8765."),
)
# What a replay takes from its bag: the planner's words and the measurements.
INPUTS_REGEX = "/[^/]+/(pose|fix|battery)|/[^/]+/jfto/(path|trajectory)"
RESPAWN = {"respawn": True, "respawn_delay": 0.5, "output": "screen"}


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
    from jfto.supervision.graph_table import graph_table, recorder_arguments

    given = {name: LaunchConfiguration(name).perform(context) for name, *_ in ARGUMENTS}
    options = _options(given)
    started = []
    if options.record:
        record = ["ros2", "run", "jfto", "jfto", *recorder_arguments(options)]
        started.append(ExecuteProcess(cmd=record, **RESPAWN))
    started += [_node(row, options.scenario) for row in graph_table(options)]
    if given["backend"] == "replay":
        play = ["ros2", "bag", "play", given["bag"], "--clock", "--regex", INPUTS_REGEX]
        started.append(ExecuteProcess(cmd=play, output="screen"))
    if given["rviz"] == "true":
        started.append(Node(package="rviz2", executable="rviz2", arguments=["-f", "map"]))
    if given["foxglove"] == "true":
        started.append(Node(package="foxglove_bridge", executable="foxglove_bridge"))
    return started


def _options(given):
    """What is run, with the scenario written out beside what it keeps."""
    from jfto.pipeline.directory import PLAN_NAME, write_scenario
    from jfto.planning.scenario_file import SCENARIO_NAME, load_scenario
    from jfto.supervision.graph_table import (
        HORIZON_SLOTS,
        START_DELAY_S,
        GraphOptions,
        suited_to,
    )

    is_replay = given["backend"] == "replay"
    if is_replay and not given["bag"]:
        raise RuntimeError("backend:=replay needs bag:=…, the bag to play.")
    loaded = load_scenario(given["scenario"])
    directory = Path(given["directory"] or tempfile.mkdtemp(prefix="jfto-")).resolve()
    write_scenario(loaded, directory / SCENARIO_NAME)
    plan = Path(given["plan"]).resolve() if given["plan"] else directory / PLAN_NAME
    return GraphOptions(
        directory / SCENARIO_NAME,
        directory,
        # A replay has the planner's words in its bag, and the bag's clock.
        plan=None if is_replay else plan,
        vehicles=None if is_replay else _vehicles(given, loaded),
        record=given["record"] == "true",
        use_sim_time=is_replay or given["use_sim_time"] == "true",
        sections=loaded.node_options,
        suited=suited_to(START_DELAY_S, HORIZON_SLOTS),
    )


def _vehicles(given, loaded):
    """Who flies, as `jfto up --vehicles` would have it."""
    from jfto.supervision.vehicles import FROM_SCENARIO, choose_vehicles
    from jfto_mavlink.fleet.roster import SIMULATED

    texts = [text for text in given["vehicles"].split(",") if text] or [FROM_SCENARIO]
    return choose_vehicles(
        [SIMULATED] if given["backend"] == "sim" else texts,
        loaded.scenario.fleet.ids,
        loaded.node_options.get("mavlink_bridge", {}),
        speedup=float(given["speedup"]) if given["backend"] == "sim" else 1.0,
        arm=given["arm"] == "true",
    )


def _node(row, scenario):
    """One of our nodes with all its parameters, started again if it dies."""
    return Node(
        package="jfto",
        executable=row.name,
        name=row.name,
        emulate_tty=True,
        parameters=[str(scenario), {key: _plain(value) for key, value in row.parameters.items()}],
        **RESPAWN,
    )


def _plain(value):
    """A parameter as launch takes it: no paths, lists for tuples."""
    if isinstance(value, Path):
        return str(value)
    return list(value) if isinstance(value, tuple) else value
