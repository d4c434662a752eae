"""The launch file, as far as it can be judged where ROS's launch packages are not."""

from __future__ import annotations

import ast
import configparser
import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
import yaml

from jfto.cli.up import graph_of
from jfto.node_options import NODE_OPTIONS
from jfto.planning.scenario_file import SCENARIO_NAME, load_scenario
from jfto.supervision.graph import graph_commands
from jfto.supervision.graph_table import EXIT_STATUSES, RECORDER
from jfto_msgs_py.scenario import Given
from jfto_msgs_py.scenario.value import check_value

ROOT = Path(__file__).parents[2]
LAUNCH = ROOT / "launch" / "jfto.launch.py"
SCENE = """\
/**: {ros__parameters: {fleet: {count: 3}, waypoints: {source: uniform, count: 9}}}
mavlink_bridge: {ros__parameters: {roster: ["uav1=1@tcp:a:1"], style: hold}}
topology_node: {ros__parameters: {watch_slots: 7}}
"""
# What two starts cannot have in common: ports that are free, and the time.
DRAWN = {"endpoint", "endpoints", "control", "control_port", "start_time_s"}


def _tree() -> ast.Module:
    return ast.parse(LAUNCH.read_text(encoding="utf-8"), str(LAUNCH))


def test_nodes_of_the_graph_are_executables_that_are_installed() -> None:
    """Every node of the table is an entry point of its name."""
    setup = configparser.ConfigParser()
    setup.read(ROOT / "setup.cfg")
    scripts = setup["options.entry_points"]["console_scripts"]
    installed = {line.split("=")[0].strip() for line in scripts.splitlines() if line.strip()}
    assert set(EXIT_STATUSES) - {RECORDER} <= installed


def test_it_is_installed_where_ros2_launch_looks() -> None:
    """share/jfto/launch, and its one public function has the name that launch calls."""
    setup = configparser.ConfigParser()
    setup.read(ROOT / "setup.cfg")
    pattern = setup["options.data_files"]["share/jfto/launch"]
    assert LAUNCH in set(ROOT.glob(pattern))
    public = [
        node.name
        for node in _tree().body
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")
    ]
    assert public == ["generate_launch_description"]


def test_its_arguments_are_known_before_our_code_is_loaded() -> None:
    """`ros2 launch --show-args` needs launch alone; what is ours is loaded when it starts."""
    modules = {
        node.module.split(".")[0] for node in _tree().body if isinstance(node, ast.ImportFrom)
    }
    assert modules <= {"launch", "launch_ros", "pathlib"}


def test_what_it_loads_of_ours_needs_no_library_but_yaml() -> None:
    """It runs in ROS's own interpreter, which has none of what pip brings."""
    used = {
        node.module
        for node in ast.walk(_tree())
        if isinstance(node, ast.ImportFrom) and node.module.startswith("jfto")
    }
    assert "jfto.supervision.graph_table" in used
    code = f"""
import importlib, sys
for module in {sorted(used)}: importlib.import_module(module)
import jfto.node_options
print(*{{name.split(".")[0] for name in sys.modules}})"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    heavy = {"rclpy", "numpy", "scipy", "numba", "torch", "pymavlink", "rasterio", "pyproj", "mcap"}
    assert "yaml" in loaded
    assert not loaded & heavy


class _Described(SimpleNamespace):
    """Stands for a class of ROS's launch packages, which no index but ROS's has."""

    def __init__(self, *arguments, **named) -> None:
        super().__init__(arguments=arguments, **named)


@pytest.fixture
def scene(tmp_path) -> Path:
    """A scenario with sections for single nodes."""
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    return path


@pytest.fixture
def started(monkeypatch, scene):
    """What the launch file starts for arguments, by the name of the node or the command."""

    def start(**given):
        for module, names in {
            "launch": ["LaunchDescription"],
            "launch.actions": ["DeclareLaunchArgument", "ExecuteProcess", "OpaqueFunction"],
            "launch.substitutions": ["LaunchConfiguration"],
            "launch_ros.actions": ["Node"],
        }.items():
            found = ModuleType(module)
            for name in names:
                setattr(found, name, _Described)
            monkeypatch.setitem(sys.modules, module, found)
        space = runpy.run_path(str(LAUNCH))
        values = {name: default for name, default, *_ in space["ARGUMENTS"]}
        values |= {"scenario": str(scene), "directory": str(scene.parent / "kept")} | given

        class Chosen:
            def __init__(self, name: str) -> None:
                self.name = name

            def perform(self, _context) -> str:
                return values[self.name]

        space["_start"].__globals__["LaunchConfiguration"] = Chosen
        entities = space["_start"](None)
        return {getattr(each, "name", None) or " ".join(each.cmd): each for each in entities}

    return start


@pytest.mark.parametrize(
    ("given", "up"),
    [
        ({"speedup": "5", "record": "true"}, {"vehicles": ("sim",), "speedup": 5.0}),
        (
            {"backend": "sitl", "vehicles": "tcp:10.0.0.2:5760"},
            {"vehicles": ("tcp:10.0.0.2:5760",)},
        ),
        (
            {
                "backend": "real",
                "vehicles": "uav1=1@udpin:0.0.0.0:1,uav2=2@udpin:0.0.0.0:1,uav3=3@udpin:0.0.0.0:1",
                "arm": "true",
            },
            {
                "vehicles": (
                    "uav1=1@udpin:0.0.0.0:1",
                    "uav2=2@udpin:0.0.0.0:1,uav3=3@udpin:0.0.0.0:1",
                ),
                "arm": True,
            },
        ),
    ],
)
def test_it_starts_what_jfto_up_starts(started, scene, given, up) -> None:
    """The same processes in the same order, with the same parameters, and those are declared."""
    launched = started(**given)
    choices = {
        "poses": "none", "vehicles": (), "key_file": None, "speedup": 1.0, "arm": False,
        "record": "record" in given, "start_delay": 10.0, "horizon": 10, "use_sim_time": False,
    } | up  # fmt: skip
    kept = scene.parent / "kept"
    supervised = graph_commands(graph_of(load_scenario(scene), kept, None, choices))
    if "record" in given:
        recorder = supervised.pop(0)
        first = next(iter(launched))
        assert first.split()[:4] == ["ros2", "run", "jfto", "jfto"]
        assert launched.pop(first).cmd[4:] == recorder.command[3:]
    assert list(launched) == [command.name for command in supervised]
    for command in supervised:
        file, own = launched[command.name].parameters
        assert launched[command.name].executable == command.name
        assert command.command[6] == file == str(kept / SCENARIO_NAME)
        assert _common(own) == _common(_parameters(command.command))
        keys = NODE_OPTIONS[command.name]
        for key, value in own.items():
            assert key == "use_sim_time" or check_value(keys[key], Given(value, "launch"))[1] == []


def _parameters(command: list[str]) -> dict:
    pairs = [text.split(":=", 1) for text in command[7:] if text != "-p"]
    return {key: yaml.safe_load(value) for key, value in pairs}


def _common(parameters: dict) -> dict:
    return {key: value for key, value in parameters.items() if key not in DRAWN}


def test_simulated_vehicles_and_the_bridge_meet(started) -> None:
    """One link, one plan, one speed-up; the scenario's roster is for others."""
    found = started(speedup="5")
    fleet, bridge = (found[n].parameters[1] for n in ("simulated_fleet", "mavlink_bridge"))
    assert [fleet["endpoint"].replace("udpto", "udpin")] == bridge["endpoints"]
    assert fleet["plan_file"] == bridge["plan_file"]
    assert fleet["speedup"] == bridge["speedup"] == 5.0
    assert "roster" not in bridge
    radio = found["radio_node"].parameters[1]
    assert radio["control"] == f"127.0.0.1:{fleet['control_port']}"


def test_what_a_node_keeps_outlives_its_restart(started, scene) -> None:
    """One that dies comes back with its lift-off, its energy account and its flight."""
    found = started(backend="real", vehicles="tcp:a:1")
    kept = scene.parent / "kept"
    files = {n: found[n].parameters[1]["state_file"] for n in found if n != "topology_node"}
    assert files == {
        "planner_node": str(kept / "lift_off.json"),
        "power_node": str(kept / "energy.json"),
        "mavlink_bridge": str(kept / "flight_state.json"),
    }
    assert all(node.respawn for node in found.values())
    assert "allow_arming" not in found["mavlink_bridge"].parameters[1]


def test_a_replay_has_topology_and_power_and_the_time_of_its_bag(started) -> None:
    """The planner's trajectories and the poses are played."""
    found = started(backend="replay", bag="flight/bag")
    assert list(found)[:2] == ["topology_node", "power_node"]
    assert " ".join(list(found)[2:]).startswith("ros2 bag play flight/bag --clock")
    assert found["topology_node"].parameters[1] == {
        "use_sim_time": True,
        "horizon_slots": 10,
        "watch_slots": 7,
    }
    with pytest.raises(RuntimeError, match="needs bag"):
        started(backend="replay")
