"""The names that recorded lines use, and helpers that wait on conditions."""

import array
import copy
import inspect
import pickle
import threading
import time

import numpy as np
import rclpy
import rclpy.clock
import rclpy.duration
import rclpy.exceptions
import rclpy.executors
import rclpy.expand_topic_name
import rclpy.lifecycle
import rclpy.parameter
import rclpy.qos
import rclpy.serialization
import rclpy.task
import rclpy.time
import rclpy.timer
import rclpy.utilities
import rclpy.validate_full_topic_name
import rclpy.validate_namespace
import rclpy.validate_node_name
import rclpy.validate_topic_name
from rclpy.node import Node

# Under load a callback can be late by seconds; what does not happen at all must still end.
LIMIT_S = 20.0


def names():
    """Build a fresh dictionary of everything that recorded lines refer to."""
    import builtin_interfaces.msg
    import diagnostic_msgs.msg
    import geometry_msgs.msg
    import nav_msgs.msg
    import rcl_interfaces.msg
    import rcl_interfaces.srv
    import sensor_msgs.msg
    import std_msgs.msg
    import std_srvs.srv
    from rclpy.parameter_client import AsyncParameterClient

    found = {}
    for module, listed in (
        (
            std_msgs.msg,
            """Bool Byte ByteMultiArray Char Empty Float32 Float64 Float64MultiArray Int8 Int32
            Int64 MultiArrayLayout String UInt8 UInt8MultiArray UInt16 UInt64""",
        ),
        (geometry_msgs.msg, "Point Pose PoseStamped Quaternion Vector3"),
        (nav_msgs.msg, "Path"),
        (sensor_msgs.msg, "BatteryState NavSatFix"),
        (diagnostic_msgs.msg, "DiagnosticStatus"),
        (std_srvs.srv, "SetBool Trigger"),
        (rcl_interfaces.msg, "ParameterType ParameterValue"),
        (rclpy.clock, "Clock ClockType JumpThreshold ROSClock"),
        (rclpy.duration, "Duration"),
        (rclpy.time, "Time"),
        (rclpy.timer, "Rate Timer"),
        (rclpy.parameter, "Parameter get_parameter_value parameter_value_to_python"),
        (rclpy.serialization, "deserialize_message serialize_message"),
        (rclpy.executors, "MultiThreadedExecutor SingleThreadedExecutor"),
        (
            rclpy.qos,
            """DurabilityPolicy HistoryPolicy LivelinessPolicy QoSPresetProfiles QoSProfile
            QoSReliabilityPolicy ReliabilityPolicy qos_check_compatible
            qos_profile_action_status_default qos_profile_best_available qos_profile_default
            qos_profile_parameter_events qos_profile_parameters qos_profile_sensor_data
            qos_profile_services_default qos_profile_system_default qos_profile_unknown""",
        ),
    ):
        found.update({name: getattr(module, name) for name in listed.split()})
    kinds = rclpy.clock.ClockType
    found.update(
        AsyncParameterClient=AsyncParameterClient,
        DM=builtin_interfaces.msg.Duration,
        F=rcl_interfaces.msg.FloatingPointRange,
        I=rcl_interfaces.msg.IntegerRange,
        Node=Node,
        P=rcl_interfaces.msg.ParameterDescriptor,
        Q=rclpy.qos,
        R_=kinds.ROS_TIME,
        ST=kinds.STEADY_TIME,
        SY=kinds.SYSTEM_TIME,
        T=rclpy.parameter.Parameter.Type,
        TL=rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL,
        TM=builtin_interfaces.msg.Time,
        array=array,
        cb=lambda *_arguments: None,
        copy=copy,
        inspect=inspect,
        np=np,
        pickle=pickle,
        rclpy=rclpy,
        time=time,
    )
    for name in dir(rcl_interfaces.srv):
        if name[0].isupper() and "_" not in name:
            found[name] = getattr(rcl_interfaces.srv, name)
    return found


def spin_until(executor, condition, limit_s=LIMIT_S):
    """Spin until a condition holds; returns whether it does."""
    end = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end:
            return False
        executor.spin_once(timeout_sec=0.05)
    return True


def wait_until(condition, limit_s=LIMIT_S):
    """Wait for what other threads do; returns whether it came."""
    tick = threading.Event()
    end = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end:
            return False
        tick.wait(0.005)
    return True


def spin_for(executor, seconds):
    """Spin for a while, to see that something does not happen."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=max(0.0, end - time.monotonic()))


class Spinner:
    """Spins an executor in a thread of its own; the exception that ended it is kept."""

    def __init__(self, executor):
        self.executor = executor
        self.error = None
        self._thread = threading.Thread(target=self._run)

    def _run(self):
        try:
            self.executor.spin()
        except BaseException as error:  # noqa: BLE001 - for the test to look at
            self.error = error

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_exception):
        self.executor.shutdown()
        self._thread.join(LIMIT_S)
        assert not self._thread.is_alive(), "the executor did not stop"


def plain_qos(profile):
    """A QoS profile as the recording writes it."""
    return {
        "history": profile.history.name,
        "depth": profile.depth,
        "reliability": profile.reliability.name,
        "durability": profile.durability.name,
        "lifespan_ns": profile.lifespan.nanoseconds,
        "deadline_ns": profile.deadline.nanoseconds,
        "liveliness": profile.liveliness.name,
        "lease_ns": profile.liveliness_lease_duration.nanoseconds,
        "avoid_ros_namespace_conventions": profile.avoid_ros_namespace_conventions,
    }
