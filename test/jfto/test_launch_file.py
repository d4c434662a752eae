"""The launch file, as far as it can be judged without ROS 2."""

from __future__ import annotations

import ast
import configparser
import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from jfto.node_options import NODE_OPTIONS
from jfto_msgs_py.ros import topics
from jfto_msgs_py.scenario import Given
from jfto_msgs_py.scenario.value import check_value

ROOT = Path(__file__).parents[2]
LAUNCH = ROOT / "launch" / "jfto.launch.py"


def _tree() -> ast.Module:
    return ast.parse(LAUNCH.read_text(encoding="utf-8"), str(LAUNCH))


def test_it_starts_only_executables_that_are_installed() -> None:
    """Every node that it names is an entry point."""
    setup = configparser.ConfigParser()
    setup.read(ROOT / "setup.cfg")
    scripts = setup["options.entry_points"]["console_scripts"]
    installed = {line.split("=")[0].strip() for line in scripts.splitlines() if line.strip()}
    named = {
        call.args[0].value
        for call in ast.walk(_tree())
        if isinstance(call, ast.Call)
        and isinstance(call.func, ast.Name)
        and call.func.id == "_node"
    }
    assert {"planner_node", "topology_node", "power_node", "simulated_fleet"} <= named
    assert named <= installed


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


def test_it_needs_nothing_but_launch() -> None:
    """It is read before our own code is on the path."""
    modules = {
        node.module.split(".")[0] for node in _tree().body if isinstance(node, ast.ImportFrom)
    }
    assert modules <= {"launch", "launch_ros", "pathlib"}


def test_it_records_what_jfto_up_records() -> None:
    """It cannot import the expression, so it spells it out."""
    value = next(
        node.value
        for node in _tree().body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "RECORDED"
    )
    assert ast.literal_eval(value) == topics.RECORDED


class _Described(SimpleNamespace):
    """Stands for a class of ROS's launch packages, which no index but ROS's has."""

    def __init__(self, *arguments, **named) -> None:
        super().__init__(arguments=arguments, **named)


@pytest.fixture
def started(monkeypatch):
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
        values = {name: default for name, default, *_ in space["ARGUMENTS"]} | given

        class Chosen:
            def __init__(self, name: str) -> None:
                self.name = name

            def perform(self, _context) -> str:
                return values[self.name]

        space["_start"].__globals__["LaunchConfiguration"] = Chosen
        entities = space["_start"](None)
        return {getattr(each, "name", None) or each.cmd[2]: each for each in entities}

    return start


@pytest.mark.parametrize(
    ("given", "nodes"),
    [
        (
            {"speedup": "5"},
            {"planner_node", "simulated_fleet", "mavlink_bridge", "radio_node"},
        ),
        ({"backend": "sitl", "vehicles": "tcp:10.0.0.2:5760"}, {"planner_node", "mavlink_bridge"}),
        (
            {"backend": "real", "vehicles": "uav1=1@udpin:0.0.0.0:14550", "arm": "true"},
            {"planner_node", "mavlink_bridge"},
        ),
        ({"backend": "real"}, {"planner_node", "mavlink_bridge"}),
        ({"backend": "replay", "bag": "b"}, {"play"}),
    ],
)
def test_each_backend_starts_its_nodes_with_parameters_that_they_have(
    started, given, nodes
) -> None:
    """A parameter that a node does not declare would end it with status 2."""
    found = started(scenario="scene.yaml", **given)
    assert set(found) == {"topology_node", "power_node"} | nodes
    for name in set(found) - {"play"}:
        _scenario, own = found[name].parameters
        assert own.pop("use_sim_time") is (given.get("backend", "sim") in {"sim", "replay"})
        keys = NODE_OPTIONS[name]
        assert [
            check_value(keys[key], Given(value, "launch"))[1] for key, value in own.items()
        ] == [[]] * len(own)


def test_simulated_vehicles_and_the_bridge_meet(started) -> None:
    """One link, one plan, one speed-up; vehicles that are real are armed only where asked."""
    found = started(scenario="scene.yaml", speedup="5")
    fleet, bridge = (found[n].parameters[1] for n in ("simulated_fleet", "mavlink_bridge"))
    assert fleet["endpoint"].partition(":")[2] == bridge["endpoints"][0].partition(":")[2]
    assert fleet["plan_file"] == bridge["plan_file"]
    assert fleet["speedup"] == bridge["speedup"] == 5.0
    radio = found["radio_node"].parameters[1]
    assert radio["control"] == f"127.0.0.1:{fleet['control_port']}"
    real = started(scenario="scene.yaml", backend="real", vehicles="udpin:0.0.0.0:14550")
    assert "allow_arming" not in real["mavlink_bridge"].parameters[1]
