"""A node that has one of everything, /uav1/demo, and one session on its graph for all tests."""

from __future__ import annotations

import click
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import SetBool

from jfto.cli.main import cli
from jfto.ros_cli.session import open_session
from support.spinning import LIMIT_S, spinning_node


def _fill_demo(node):
    pose = PoseStamped()
    pose.header.frame_id = "map"
    pose.pose.position.x = 1.5
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    matrix = Float64MultiArray(data=[1.0, 2.5, float("inf")])
    for topic, message, qos in (
        ("pose", pose, qos_profile_sensor_data),
        ("matrix", matrix, latched),
        ("status", String(data='héllo "q" #1: yes'), 10),
        ("level", DiagnosticStatus(level=b"\x02", name="link"), 10),
    ):
        publisher = node.create_publisher(type(message), topic, qos)
        publisher.publish(message)
        if qos is not latched:
            node.create_timer(0.05, lambda p=publisher, m=message: p.publish(m))
    node.came = []
    node.create_subscription(PoseStamped, "goal", node.came.append, 10)
    span = FloatingPointRange(from_value=0.0, to_value=10.0)
    node.declare_parameter("speed", 1.5, ParameterDescriptor(floating_point_range=[span]))
    node.declare_parameter("name", "alpha")
    node.declare_parameter("ids", [1, 2, 3])
    node.declare_parameter("topo.k_min", 2)
    node.declare_parameter("unset", Parameter.Type.STRING)

    def arm(request, response):
        response.success, response.message = request.data, "armed" if request.data else "disarmed"
        return response

    node.create_service(SetBool, "arm", arm)


@pytest.fixture(scope="module")
def demo():
    """The node, spinning."""
    with spinning_node("demo", "/uav1") as node:
        _fill_demo(node)
        yield node


@pytest.fixture(scope="module")
def session(demo):
    """A session that knows the whole of the demo node."""
    with open_session() as session:
        node = session.node
        assert session.spin_until(
            lambda: (
                ("demo", "/uav1") in node.get_node_names_and_namespaces()
                and "/uav1/arm" in dict(node.get_service_names_and_types())
                and all(map(node.count_publishers, ("/uav1/matrix", "/uav1/level")))
                and node.count_subscribers("/uav1/goal")
            ),
            LIMIT_S,
        )
        yield session


@pytest.fixture
def run(session, capsys):
    """Run a command on the session; its status and what it printed."""

    def run(*arguments):
        capsys.readouterr()
        try:
            status = cli.main(list(arguments), "jfto", standalone_mode=False, obj=session)
        except click.exceptions.Exit as end:
            status = end.exit_code
        return status, capsys.readouterr().out

    return run
