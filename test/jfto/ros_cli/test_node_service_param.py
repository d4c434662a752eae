"""`jfto node`, `service` and `param` beside a real node."""

from __future__ import annotations

import pytest
import yaml


def test_nodes_are_listed(run):
    """Full names, one a line; our own is hidden but for -a."""
    assert run("node", "list") == (0, "/uav1/demo\n")
    assert run("node", "list", "-c") == (0, "1\n")
    assert "/_ros2cli_" in run("node", "list", "-a")[1]


def test_node_info_has_all_four_kinds(run):
    """What a node publishes, subscribes to, serves and calls, each with its type."""
    _, out = run("node", "info", "/uav1/demo")
    heads = [line for line in out.splitlines() if line.startswith("  ") and line[2] != " "]
    assert heads == ["  Subscribers:", "  Publishers:", "  Service Servers:", "  Service Clients:"]
    assert "    /uav1/goal: geometry_msgs/msg/PoseStamped\n" in out
    assert "    /uav1/arm: std_srvs/srv/SetBool\n" in out


def test_service_is_found_and_called(run):
    """Listed with its type; the answer to a call is printed."""
    assert "/uav1/arm [std_srvs/srv/SetBool]\n" in run("service", "list", "-t")[1]
    status, out = run("service", "call", "/uav1/arm", "std_srvs/srv/SetBool", "{data: true}")
    assert status == 0
    assert "std_srvs.srv.SetBool_Response(success=True, message='armed')" in out


def test_parameters_are_listed(run):
    """Of one node, or of all under the node's name; with types on request."""
    assert "  topo.k_min\n" in run("param", "list", "/uav1/demo")[1]
    assert run("param", "list")[1].startswith("/uav1/demo:\n  ")
    assert "  speed (type: double)\n" in run("param", "list", "--param-type", "uav1/demo")[1]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("speed", "Double value is: 1.5\n"),
        ("name", "String value is: alpha\n"),
        ("topo.k_min", "Integer value is: 2\n"),
        ("ids", "Integer values are: [1, 2, 3]\n"),
    ],
)
def test_value_is_printed_with_its_type(name, text, run):
    """As ros2cli does, or the value alone."""
    assert run("param", "get", "/uav1/demo", name) == (0, text)
    value = text.partition(": ")[2]
    assert run("param", "get", "--hide-type", "/uav1/demo", name) == (0, value)


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("speed", "2.5", 2.5),
        ("name", "bravo", "bravo"),
        ("name", "2020-01-01", "2020-01-01"),
        ("name", "a: b: c", "a: b: c"),
        ("ids", "[4, 5]", [4, 5]),
        ("topo.k_min", "3", 3),
    ],
)
def test_value_is_set(name, text, value, run, demo):
    """YAML says of what type it is; what is no number, truth or list is a text."""
    before = demo.get_parameter(name)
    try:
        assert run("param", "set", "/uav1/demo", name, text) == (0, "Set parameter successful\n")
        found = demo.get_parameter(name).value
        assert (list(found) if isinstance(value, list) else found) == value
    finally:
        demo.set_parameters([before])


def test_dump_is_a_parameter_file(run):
    """All parameters that have a value, one that has none notwithstanding."""
    tree = yaml.safe_load(run("param", "dump", "/uav1/demo")[1])["/uav1/demo"]["ros__parameters"]
    assert (tree["speed"], tree["ids"], tree["topo.k_min"]) == (1.5, [1, 2, 3], 2)
    assert "unset" not in tree
