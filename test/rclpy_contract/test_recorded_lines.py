"""Recorded lines that are plain Python are tried again as they stand, section by section."""

import warnings

import pytest
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future

from rclpy_contract.environment import names, plain_qos
from rclpy_contract.observations import differences

# Declaring a parameter by its name alone, and a pool of one thread, warn on purpose.
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


def _check(section, environment, prepare=None):
    found = differences(section, environment, prepare)
    assert not found, f"{len(found)} lines came out differently:\n" + "\n".join(found)


def _without_note(_number, line):
    return line.split("   (")[0]


def test_before_and_after_init():
    """A node needs ``init``, which can be called once."""
    with pytest.raises(rclpy.exceptions.NotInitializedException, match="cannot create node"):
        Node("a")
    assert rclpy.ok() is False
    assert rclpy.init(args=[]) is None
    with pytest.raises(RuntimeError, match=r"Context.init\(\) must only be called once"):
        rclpy.init(args=[])
    assert rclpy.ok() is True


def test_node_names():
    """Node names and namespaces: what is legal, what is shown, what is refused."""
    rclpy.init(args=[])
    node = Node("n", namespace="/uav1")
    logged = Node("q5", enable_logger_service=True)
    _check("names", names() | {"n": node, "q5": logged})


def test_topic_and_service_names():
    """Topic and service names are expanded, validated and refused as rcl does."""
    rclpy.init(args=[])
    _check("topics", names() | {"n": Node("n", namespace="/uav1")})


def test_destroying():
    """What is destroyed says so; a destroyed node still answers some questions."""
    rclpy.init(args=[])
    known = names()
    node = Node("n", namespace="/uav1")
    publisher = node.create_publisher(known["String"], "d", 10)
    node.destroy_publisher(publisher)
    timer = node.create_timer(1, known["cb"])
    node.destroy_timer(timer)
    subscription = node.create_subscription(known["String"], "d", known["cb"], 10)
    node.destroy_subscription(subscription)
    _check("destroying", known | {"n": node, "p": publisher, "t": timer, "s": subscription})


def test_free_functions_and_node_arguments(tmp_path, monkeypatch):
    """init, shutdown and ok; arguments of the process and of one node."""
    monkeypatch.chdir(tmp_path)
    rclpy.init(args=[])
    node = Node("n")

    def prepare(number, line):
        if number == 19:
            # The recording set this parameter for the lines that follow.
            rclpy.init(args=["--ros-args", "-p", "x:=5"])
        return line

    _check("context", names() | {"n": node}, prepare)


def test_parameter_values():
    """Which Python value has which parameter type."""
    _check("parameter_types", names())


def test_declaring_getting_and_setting_parameters():
    """Declaration, access, types, ranges, read-only; one node runs through both sections."""
    rclpy.init(args=[])
    node = Node("n")

    def sp(*pairs):
        given = [Parameter(name, value=value) for name, value in pairs]
        return [(result.successful, result.reason) for result in node.set_parameters(given)]

    environment = names() | {"n": node, "sp": sp}
    environment["u"] = Node("u", allow_undeclared_parameters=True)
    _check("declare", environment)
    _check("get_set", environment, _without_note)


def test_parameter_overrides():
    """Overrides win over defaults, keep their type, and are declared on request."""
    rclpy.init(args=[])
    known = names()
    given = [("a", 5), ("b", "text"), ("ns.c", 1.0), ("d", 3)]
    overrides = [Parameter(name, value=value) for name, value in given]
    known["o"] = Node("o", parameter_overrides=overrides)
    known["o2"] = Node("o2", parameter_overrides=overrides[:1])
    _check("overrides", known, _without_note)


def test_overrides_meet_ranges_and_read_only():
    """An override must fit the range, and may set a read-only parameter."""
    rclpy.init(args=[])
    known = names()
    node = Node("o3", parameter_overrides=[Parameter("a", value=99)])
    descriptor = known["P"](integer_range=[known["I"](from_value=0, to_value=10)])
    with pytest.raises(rclpy.exceptions.InvalidParameterValueException) as caught:
        node.declare_parameter("a", 1, descriptor)
    assert "Parameter a out of range. Min: 0, Max: 10, value: 99" in str(caught.value)
    node = Node("o4", parameter_overrides=[Parameter("a", value=9)])
    assert node.declare_parameter("a", 5, known["P"](read_only=True)).value == 9
    node = Node(
        "o7",
        parameter_overrides=[Parameter("a", value=5)],
        automatically_declare_parameters_from_overrides=True,
    )
    with pytest.raises(rclpy.exceptions.ParameterAlreadyDeclaredException, match=r"\['a'\]"):
        node.declare_parameter("a", 2)


def test_qos_profiles():
    """Profiles, presets, enumerations and compatibility."""
    _check("qos", names() | {"q": plain_qos})


def test_qos_of_created_endpoints():
    """Endpoints show the profile that was asked for; discovery shows what is in force."""
    rclpy.init(args=[])
    _check("qos_actual", names() | {"q": plain_qos, "n": Node("n")})


def test_publishing():
    """What ``publish`` accepts, and what a publisher offers."""
    rclpy.init(args=[])
    known = names()
    node = Node("n")
    publisher = node.create_publisher(known["PoseStamped"], "ps", 10)
    _check("publishing", known | {"n": node, "p": publisher})


def test_message_constructors():
    """Constructors, defaults and constants, with fields checked."""
    _check("constructor", names())


def test_message_assignment():
    """What can be assigned to which field, with fields checked."""
    rclpy.init(args=[])
    known = names() | {"n": Node("n")}

    def prepare(_number, line):
        known.update(
            a=known["PoseStamped"](),
            b=known["Float64MultiArray"](),
            u=known["UInt8MultiArray"](),
            pa=known["Path"](),
            nf=known["NavSatFix"](),
            bs=known["BatteryState"](),
        )
        return line

    _check("assignment", known, prepare)


def test_array_defaults():
    """Array fields are array.array, numpy arrays or lists."""
    _check("array_defaults", names())


def test_message_introspection():
    """Equality, hash, copy, pickle, field types, slots."""
    _check("introspection", names() | {"a": names()["PoseStamped"]()})


def test_serialization():
    """Bytes of messages, and what broken bytes do."""
    _check("serialization", names())


def test_rosidl_runtime():
    """Messages to YAML, CSV and dictionaries, and back."""
    rosidl = pytest.importorskip("rosidl_runtime_py")
    from rosidl_runtime_py import utilities

    known = names() | {"rosidl_runtime_py": rosidl}
    for module in (rosidl, utilities):
        known.update({key: getattr(module, key) for key in dir(module) if not key.startswith("_")})
    _check("rosidl_runtime", known)


def test_time_and_duration():
    """Construction, arithmetic and comparison of times and durations."""
    _check("time", names())


def test_clocks():
    """Kinds of clock, reading and sleeping."""
    rclpy.init(args=[])
    _check("clocks", names() | {"n": Node("n")})


def test_futures():
    """Results, exceptions, cancelling and callbacks of futures."""
    done, failed, watched, log = Future(), Future(), Future(), []
    failed.set_exception(ValueError("e"))
    watched.add_done_callback(lambda future: log.append(("cb", future.done())))
    _check("future", names() | {"f": done, "g": failed, "h": watched, "L": log})
    with pytest.raises(ValueError, match="x"):
        done.result()


def test_done_callback_that_raises():
    """Without an executor a failing done callback only warns."""
    future = Future()

    def fail(_future):
        raise ZeroDivisionError

    future.add_done_callback(fail)
    with warnings.catch_warnings(record=True):
        warnings.simplefilter("always")
        assert future.set_result(1) is None
    assert future.result() == 1


def test_done_callback_in_executor():
    """With an executor done callbacks run in it, not in ``set_result``."""
    rclpy.init(args=[])
    executor = rclpy.executors.SingleThreadedExecutor()
    future, log = Future(executor=executor), []
    future.add_done_callback(lambda _future: log.append(1))
    future.set_result(None)
    assert log == []
    executor.spin_once(timeout_sec=1.0)
    assert log == [1]
