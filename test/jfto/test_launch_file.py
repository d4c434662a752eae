"""The launch file, as far as it can be judged without ROS 2."""

from __future__ import annotations

import ast
import configparser
from pathlib import Path

ROOT = Path(__file__).parents[2]
LAUNCH = ROOT / "launch" / "jfto.launch.py"


def _tree() -> ast.Module:
    return ast.parse(LAUNCH.read_text(encoding="utf-8"), str(LAUNCH))


def test_it_starts_only_executables_that_are_installed() -> None:
    """Every node that it names is an entry point; the bridge comes with the vehicles' part."""
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
    assert {"planner_node", "topology_node", "power_node", "pose_player"} <= named
    assert named - {"mavlink_bridge"} <= installed


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
    assert modules <= {"launch", "launch_ros"}
