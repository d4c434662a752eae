"""Messages as YAML and back."""

from __future__ import annotations

import pytest
import yaml
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import BatteryState, NavSatFix
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import ByteMultiArray, String

from jfto.ros_cli import RosCommandError
from jfto.ros_cli.messages import TextLimits, fill, message_class, to_plain, to_yaml


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (NavSatFix, {"position_covariance": [float(n) for n in range(9)], "altitude": 3.5}),
        (BatteryState, {"cell_voltage": [3.5, 4.0], "present": True, "location": "slot: 1"}),
        (DiagnosticArray, {"status": [{"level": 2, "values": [{"key": "a", "value": "b"}]}]}),
        (SolidPrimitive, {"type": 1, "dimensions": [1.0, 2.0, 3.0]}),
        (ByteMultiArray, {"data": [1, 255]}),
        (PoseStamped, {"header": {"stamp": {"sec": 7}}, "pose": {"position": {"x": 1.5}}}),
    ],
)
def test_what_is_printed_can_be_sent(kind, values):
    """A message filled from YAML prints as YAML that fills an equal one."""
    message, again = kind(), kind()
    fill(message, values)
    printed = yaml.safe_load(to_yaml(message))
    for name, value in values.items():
        if not isinstance(value, (dict, list)):
            assert printed[name] == value
    fill(again, printed)
    assert again == message


def test_stamps_that_are_now_take_the_time_of_sending():
    """`auto` headers and `now` stamps are filled at any depth."""
    now = Time(sec=5, nanosec=6)
    one, other = PoseStamped(), PoseStamped()
    fill(one, {"header": "auto", "pose": {"position": {"x": 1}}}, now)
    fill(other, {"header": {"stamp": "now", "frame_id": "map"}}, now)
    assert one.header.stamp == other.header.stamp == now
    assert (one.header.frame_id, other.header.frame_id) == ("", "map")


@pytest.mark.parametrize(
    ("kind", "values", "text"),
    [
        (NavSatFix, {"position_covariance": [1.0, 2.0]}, "NavSatFix.position_covariance"),
        (NavSatFix, {"position_covariance": 1.0}, r"double\[9\] and cannot be 1.0"),
        (NavSatFix, {"altitude": "high"}, "cannot be 'high'"),
        (NavSatFix, {"status": {"status": 300}}, "NavSatStatus.status is of type int8"),
        (SolidPrimitive, {"dimensions": [1.0] * 4}, "SolidPrimitive.dimensions"),
        (DiagnosticArray, {"status": [{"nope": 1}]}, "DiagnosticStatus has no field 'nope'"),
        (DiagnosticArray, {"status": [1]}, "DiagnosticArray.status"),
        (String, {"data": ["a"]}, "cannot be"),
    ],
)
def test_field_that_cannot_be_set_is_named(kind, values, text):
    """Also where a value is too large, or an array too long: rclpy itself would not notice."""
    with pytest.raises(RosCommandError, match=text):
        fill(kind(), values)


def test_limits_cut_arrays_and_texts():
    """Beyond a length comes `...`; one that just fits is whole."""
    message = BatteryState(cell_voltage=[1.0, 2.0, 3.0], location="abcd")
    plain = to_plain(message, "", TextLimits(3))
    assert (plain["cell_voltage"], plain["location"]) == ([1.0, 2.0, 3.0], "abc...")
    plain = to_plain(message, "", TextLimits(2))
    assert plain["cell_voltage"] == [1.0, 2.0, "..."]


@pytest.mark.parametrize("name", ["std_msgs/msg/String", "std_msgs/String"])
def test_class_is_found_by_either_name(name):
    """The full name, and the short one that ROS 1 had."""
    assert message_class(name) is String
