"""The node of the transcripts, /uav1/demo, and one session on its graph for all tests."""

from __future__ import annotations

import threading

import numpy as np
import pytest


def _stamp(message, frame_id):
    from builtin_interfaces.msg import Time

    message.header.stamp = Time(sec=1700000000, nanosec=250000000)
    message.header.frame_id = frame_id
    return message


def demo_messages():
    """Messages that the recorded node published, by topic."""
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
    from geometry_msgs.msg import PoseStamped
    from nav_msgs.msg import Path as RosPath
    from sensor_msgs.msg import BatteryState, NavSatFix
    from std_msgs.msg import Float64MultiArray, MultiArrayDimension, String, UInt8MultiArray

    def pose(x, y, z):
        message = _stamp(PoseStamped(), "map")
        message.pose.position.x, message.pose.position.y, message.pose.position.z = x, y, z
        return message

    plan = _stamp(RosPath(), "map")
    plan.poses = [pose(0.0, 0.0, 1.0), pose(1.5, 0.0, 1.0)]
    matrix = Float64MultiArray(data=[1.0, 2.5, -3e-07, float("inf")])
    matrix.layout.dim = [
        MultiArrayDimension(label="row", size=2, stride=4),
        MultiArrayDimension(label="col", size=2, stride=2),
    ]
    diagnostics = _stamp(DiagnosticArray(), "")
    values = [
        KeyValue(key="neighbours", value="2"),
        KeyValue(key="rssi", value="-80.5"),
        KeyValue(key="ok", value="true"),
    ]
    diagnostics.status = [
        DiagnosticStatus(
            level=b"\x01", name="demo: link", message='weak: "x"', hardware_id="uav1", values=values
        ),
        DiagnosticStatus(level=b"\x00", name="demo: ok"),
    ]
    fix = _stamp(NavSatFix(latitude=46.5, longitude=7.25, altitude=float("nan")), "gps")
    fix.status.status, fix.status.service = 0, 1
    fix.position_covariance = np.array([1.0, 0, 0, 0, 1.0, 0, 0, 0, float("nan")])
    fix.position_covariance_type = 2
    nan = float("nan")
    battery = _stamp(
        BatteryState(
            voltage=22.200000762939453, temperature=nan, current=-5.5, charge=nan, capacity=nan,
            design_capacity=10.0, percentage=0.75, present=True,
            cell_voltage=[3.700000047683716, 3.6500000953674316], location="slot 1",
        ),
        "",
    )  # fmt: skip
    return {
        "/uav1/pose": pose(1.0, -2.5, 30.0),
        "/uav1/plan": plan,
        "/uav1/matrix": matrix,
        "/uav1/bytes": UInt8MultiArray(data=list(range(200))),
        "/diagnostics": diagnostics,
        "/uav1/fix": fix,
        "/uav1/battery": battery,
        "/uav1/status": String(data='héllo "q" #1: yes'),
    }


def _declare_parameters(node):
    from rcl_interfaces.msg import (
        FloatingPointRange,
        IntegerRange,
        ParameterDescriptor,
        SetParametersResult,
    )
    from rclpy.parameter import Parameter

    speed = ParameterDescriptor(
        description="cruise speed",
        additional_constraints="keep it low",
        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=10.0, step=0.5)],
    )
    retries = ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=10, step=2)])
    node.declare_parameter("speed", 1.5, speed)
    node.declare_parameter("retries", 4, retries)
    for name, value in {
        "name": "alpha", "flag": True, "ids": [1, 2, 3], "gains": [0.1, 2.0],
        "names": ["a", "b c"], "flags": [True, False], "blob": [b"\x01", b"\xff"],
    }.items():  # fmt: skip
        node.declare_parameter(name, value)
    node.declare_parameter("frame_id", "map", ParameterDescriptor(read_only=True))
    node.declare_parameter("dyn", 1, ParameterDescriptor(dynamic_typing=True))
    node.declare_parameter("unset", Parameter.Type.STRING)
    for name, value in {
        "empty_s": "", "numlike": "12", "boollike": "true", "multi": "line1\nline2", "big": 1e20,
        "nan": float("nan"), "whole": 3.0, "topo.k_min": 2, "topo.delta": 1,
    }.items():  # fmt: skip
        node.declare_parameter(name, value)

    def refuse(parameters):
        for parameter in parameters:
            if parameter.name == "name" and parameter.value == "bad":
                return SetParametersResult(successful=False, reason="name must not be bad")
            if parameter.name == "name" and parameter.value == "quiet":
                return SetParametersResult(successful=False)
        return SetParametersResult(successful=True)

    node.add_on_set_parameters_callback(refuse)


def _create_demo(context):
    from geometry_msgs.msg import PoseStamped
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
    from std_msgs.msg import String
    from std_srvs.srv import SetBool, Trigger

    node = Node("demo", namespace="/uav1", context=context)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    special = {
        "/uav1/plan": latched, "/uav1/matrix": latched, "/uav1/fix": qos_profile_sensor_data,
    }  # fmt: skip
    for topic, message in demo_messages().items():
        publisher = node.create_publisher(type(message), topic, special.get(topic, 10))
        if special.get(topic) is latched:
            publisher.publish(message)
        else:
            # Faster than the recorded node, so that tests need not wait.
            node.create_timer(0.05, lambda p=publisher, m=message: p.publish(m))
    node.heard = []
    node.create_subscription(String, "cmd", node.heard.append, 10)
    node.create_subscription(PoseStamped, "goal", node.heard.append, qos_profile_sensor_data)
    _declare_parameters(node)

    def arm(request, response):
        response.success, response.message = request.data, "armed" if request.data else "disarmed"
        return response

    def land(_request, response):
        response.success, response.message = True, 'landing: "now"'
        return response

    def slow(_request, response):
        threading.Event().wait(0.5)
        response.success = True
        return response

    node.create_service(SetBool, "arm", arm)
    node.create_service(Trigger, "land", land)
    node.create_service(Trigger, "slow", slow)
    node.create_client(Trigger, "/gcs/land")
    return node


@pytest.fixture(scope="module")
def demo():
    """The recorded node, spinning in a thread of its own context."""
    from rclpy.context import Context
    from rclpy.executors import MultiThreadedExecutor

    context = Context()
    context.init(args=[])
    node = _create_demo(context)
    executor = MultiThreadedExecutor(num_threads=2, context=context)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield node
    executor.shutdown()
    thread.join(20)
    node.destroy_node()
    context.shutdown()
    assert not thread.is_alive()


@pytest.fixture(scope="module")
def session(demo):
    """A session that knows the demo node."""
    from jfto.ros_cli.session import open_session

    with open_session(0.5) as session:
        assert session.spin_until(
            lambda: ("demo", "/uav1") in session.node.get_node_names_and_namespaces(), 20
        )
        session.discover(0.2)
        yield session
