"""Security enclaves: named on the network, and never mistaken for security."""

from __future__ import annotations

import time

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node

_LIMIT_S = 30.0


def test_others_are_told_the_enclave_of_the_command_line():
    """As in the recorded participant, whose USER_DATA says enclave=/;."""
    mine, other = Context(), Context()
    rclpy.init(args=["x", "--ros-args", "--enclave", "/fleet/one"], context=mine, domain_id=57)
    rclpy.init(args=[], context=other, domain_id=57)
    nodes = [Node("here", context=mine), Node("there", context=other)]
    wanted = [("here", "/", "/fleet/one"), ("there", "/", "/")]
    end = time.monotonic() + _LIMIT_S
    while sorted(nodes[1].get_node_names_and_namespaces_with_enclaves()) != wanted:
        assert time.monotonic() < end
    for node, context in zip(nodes, (mine, other), strict=True):
        node.destroy_node()
        context.shutdown()


def test_security_that_is_asked_for_is_not_left_out_silently(monkeypatch):
    """Who sets ROS_SECURITY_ENABLE expects encryption."""
    monkeypatch.setenv("ROS_SECURITY_ENABLE", "true")
    with pytest.raises(NotImplementedError, match="ROS_SECURITY_ENABLE"):
        rclpy.init(args=[], context=Context())
    monkeypatch.setenv("ROS_SECURITY_ENABLE", "false")
    context = Context()
    rclpy.init(args=[], context=context, domain_id=58)
    assert context.ok()
    context.shutdown()
