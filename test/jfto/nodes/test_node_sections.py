"""Sections of a scenario file that are for one node."""

from __future__ import annotations

from pathlib import Path

import pytest

from jfto.planning.scenario_file import load_node_parameters, load_scenario
from jfto.supervision.graph import graph_commands
from jfto.supervision.graph_table import GraphOptions
from jfto_msgs_py.errors import ScenarioError
from jfto_msgs_py.scenario.options import resolve
from jfto_topology.options import TopologyOptions

SHARED = "/**: {ros__parameters: {fleet: {count: 3}}}\n"


def _file(directory: Path, section: str) -> Path:
    path = directory / "scene.yaml"
    path.write_text(SHARED + section)
    return path


def test_a_nodes_own_parameters_are_kept_apart(tmp_path) -> None:
    """They are no scenario keys, but the graph's processes are given them."""
    section = "topology_node: {ros__parameters: {stale_after_s: 5, network: {k_min: 1}}}\n"
    loaded = load_scenario(_file(tmp_path, section))
    assert loaded.scenario.network.k_min == 1
    assert loaded.node_options == {"topology_node": {"stale_after_s": 5.0}}
    options = GraphOptions(
        loaded.path, tmp_path, tmp_path / "plan.json", sections=loaded.node_options
    )
    commands = {node.name: node.command for node in graph_commands(options)}
    assert "stale_after_s:=5.000000000" in commands["topology_node"]
    assert list(commands) == ["planner_node", "topology_node", "power_node"]


@pytest.mark.parametrize(
    ("line", "words"),
    [("stale_after_s: -5.0", "stale_after_s is -5"), ("stale_after: 5.0", "unknown key")],
)
def test_wrong_ones_are_problems_of_the_file(tmp_path, line, words) -> None:
    """With file and line, as all other problems."""
    section = f"topology_node:\n  ros__parameters:\n    {line}\n"
    with pytest.raises(ScenarioError, match=f"scene.yaml:4: .*{words}"):
        load_scenario(_file(tmp_path, section))


def test_one_nodes_parameters_are_the_shared_ones_and_its_own(tmp_path) -> None:
    """Its own win, whatever the sections of others say; those of ROS are none of ours."""
    section = (
        "/topology_node: {ros__parameters: {use_sim_time: true, watch_slots: 7, "
        "radio: {frequency_hz: 83.5e6}, network.k_min: 1}}\n"
        "/recorder: {ros__parameters: {anything: at all}}\n"
    )
    values = load_node_parameters(_file(tmp_path, section), "topology_node")
    scenario, options = resolve(values, TopologyOptions)
    assert (scenario.fleet.count, scenario.network.k_min) == (3, 1)
    assert scenario.radio.frequency_hz == 83.5e6
    assert options == TopologyOptions(watch_slots=7)
    section = "topology_node:\n  ros__parameters:\n    watch_slot: 7\n"
    values = load_node_parameters(_file(tmp_path, section), "topology_node")
    with pytest.raises(ScenarioError, match=r"scene.yaml:4: .*unknown key"):
        resolve(values, TopologyOptions)


def test_a_node_s_own_parameters_can_be_set_from_the_command_line() -> None:
    """Checked like those of its section; one that it has not is named."""
    demo = Path(__file__).parents[3] / "config/demo.yaml"
    loaded = load_scenario(demo, ("mavlink_bridge.pass_within_m=3", "network.k_min=1"))
    assert loaded.node_options["mavlink_bridge"]["pass_within_m"] == 3.0
    assert loaded.scenario.network.k_min == 1
    with pytest.raises(ScenarioError) as caught:
        load_scenario(demo, ("mavlink_bridge.style=holt", "mavlink_bridge.stile=hold"))
    style, unknown = caught.value.problems
    assert "style is 'holt'" in style
    assert "mavlink_bridge.stile" in unknown
