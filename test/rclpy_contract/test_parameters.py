"""Parameter callbacks, /parameter_events and the parameter services."""

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from rclpy_contract.environment import names, spin_until
from rclpy_contract.observations import RECORDED, agrees, attempt, normalise


class _Callbacks:
    """A node ``c`` with parameters i, d, s and all kinds of callbacks, as in the recording."""

    def __init__(self):
        known = names()
        self.result = (
            known["Parameter"]
            and __import__(
                "rcl_interfaces.msg", fromlist=["SetParametersResult"]
            ).SetParametersResult
        )
        event_type = __import__("rcl_interfaces.msg", fromlist=["ParameterEvent"]).ParameterEvent
        self.node = Node("c")
        self.log, self.events = [], []
        for name, value in (("i", 1), ("d", 1.0), ("s", "x")):
            self.node.declare_parameter(name, value)
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.node.create_subscription(event_type, "/parameter_events", self._event, 100)
        self.node.add_pre_set_parameters_callback(self._pre)
        self.node.add_on_set_parameters_callback(self._on1)
        self.node.add_on_set_parameters_callback(self._on2)
        self.node.add_post_set_parameters_callback(self._post)
        self.published = 0

    def _event(self, event):
        if event.node == "/c":
            self.events.append(event)

    def _value(self):
        return self.node.get_parameter("i").value

    def _pre(self, parameters):
        self.log.append(("pre", [parameter.name for parameter in parameters]))
        if any(parameter.name == "d" for parameter in parameters):
            return [*parameters, Parameter("s", value="added")]
        return parameters

    def _on1(self, parameters):
        self.log.append(("on1", [(p.name, p.value) for p in parameters], self._value()))
        return self.result(successful=True)

    def _on2(self, parameters):
        self.log.append(("on2", [parameter.name for parameter in parameters]))
        if any(parameter.value == 13 for parameter in parameters):
            return self.result(successful=False, reason="13 is unlucky")
        return self.result(successful=True)

    def _post(self, parameters):
        self.log.append(("post", [parameter.name for parameter in parameters], self._value()))

    def shown_events(self):
        return [
            (
                event.node,
                [p.name for p in event.new_parameters],
                [p.name for p in event.changed_parameters],
                [p.name for p in event.deleted_parameters],
            )
            for event in self.events
        ]

    def cs(self, *pairs, at=False):
        """Set parameters; returns (result, callback log, events) as the recording has them."""
        self.log.clear()
        self.events.clear()
        given = [Parameter(name, value=value) for name, value in pairs]
        result = (
            self.node.set_parameters_atomically(given) if at else self.node.set_parameters(given)
        )
        results = [result] if at else result
        expected = sum(1 for one in results if one.successful)
        assert spin_until(self.executor, lambda: len(self.events) >= expected)
        return result, list(self.log), self.shown_events()


def test_callbacks_and_events():
    """Pre-set, on-set and post-set callbacks, and one event per successful set."""
    rclpy.init(args=[])
    node = _Callbacks()
    # Events of the declarations are not part of the recording.
    spin_until(node.executor, lambda: False, 0.2)
    recorded = RECORDED["parameter_callbacks"]
    for number in range(10):
        line = recorded[number]
        came = attempt(line["did"], {"cs": node.cs})
        assert agrees(line["saw"], came), f"{number}: {line}\n{came}"
    node.log.clear()
    node.events.clear()
    node.node.declare_parameter("newp", 1)
    node.node.undeclare_parameter("newp")
    assert spin_until(node.executor, lambda: node.events)
    assert repr((node.log, node.shown_events())) == recorded[10]["saw"]
    node.events.clear()
    node.cs(("i", 21))
    shown = repr(node.events[0]).partition("node='/c'")[2]
    assert shown == recorded[11]["saw"].partition("node='/c'")[2]
    assert node.events[0].stamp.sec > 0


def test_bad_on_set_callbacks():
    """A callback that returns nothing or raises leaves ``set_parameters`` and sets nothing."""
    rclpy.init(args=[])
    node = Node("c3")
    node.declare_parameter("i", 1)
    nothing = lambda _parameters: None  # noqa: E731

    def boom(_parameters):
        raise ValueError("boom")

    node.add_on_set_parameters_callback(nothing)
    with pytest.raises(AttributeError, match="has no attribute 'successful'"):
        node.set_parameters([Parameter("i", value=2)])
    node.remove_on_set_parameters_callback(nothing)
    node.add_on_set_parameters_callback(boom)
    with pytest.raises(ValueError, match="boom"):
        node.set_parameters([Parameter("i", value=2)])
    assert node.get_parameter("i").value == 1


def test_callbacks_run_last_added_first():
    """On-set callbacks run in the reverse order of adding."""
    rclpy.init(args=[])
    from rcl_interfaces.msg import SetParametersResult

    node, order = Node("c4"), []
    node.declare_parameter("i", 1)
    for name in ("first added", "second added"):

        def callback(_parameters, name=name):
            order.append(name)
            return SetParametersResult(successful=True)

        node.add_on_set_parameters_callback(callback)
    node.set_parameters([Parameter("i", value=2)])
    assert repr(order) == RECORDED["parameter_callbacks"][15]["saw"]


def test_removing_unknown_callback():
    """Removing what was not added is an error."""
    rclpy.init(args=[])
    with pytest.raises(ValueError, match="not in list"):
        Node("c5").remove_on_set_parameters_callback(print)


def test_on_set_callback_sees_declarations():
    """``declare_parameter`` asks the on-set callbacks, which may refuse."""
    rclpy.init(args=[])
    from rcl_interfaces.msg import SetParametersResult

    node, seen, answer = Node("c6"), [], [True]

    def callback(parameters):
        seen.extend((parameter.name, parameter.value) for parameter in parameters)
        return SetParametersResult(successful=answer[0], reason="" if answer[0] else "no")

    node.add_on_set_parameters_callback(callback)
    node.declare_parameter("x", 1)
    assert seen == [("x", 1)]
    answer[0] = False
    with pytest.raises(rclpy.exceptions.InvalidParameterValueException) as caught:
        node.declare_parameter("y", 1)
    assert "Invalid parameter value (1) for parameter. Reason: no: y" in str(caught.value)


def test_parameter_services():
    """The six services as a remote client sees them."""
    rclpy.init(args=[])
    known = names()
    server, client = Node("s"), Node("client")
    server.declare_parameter("i", 1, known["P"](description="d"))
    server.declare_parameter("ro", 1, known["P"](read_only=True))
    server.declare_parameter("a.b", 1)
    server.declare_parameter("a.c.d", 1)
    server.declare_parameter("un", Parameter.Type.STRING)
    executor = SingleThreadedExecutor()
    executor.add_node(server)
    executor.add_node(client)

    def call(kind, name, request):
        caller = client.create_client(kind, f"s/{name}")
        assert spin_until(executor, caller.service_is_ready)
        future = caller.call_async(request)
        assert spin_until(executor, future.done)
        client.destroy_client(caller)
        return future.result()

    def message(name, **value):
        from rcl_interfaces.msg import Parameter as ParameterMsg

        return ParameterMsg(name=name, value=known["ParameterValue"](**value))

    environment = known | {"call": call, "PM": message, "s": server}
    for line in RECORDED["parameter_services"]:
        came = attempt(line["did"], environment)
        assert agrees(line["saw"], came), f"{line['did']}\n{line['saw']}\n{normalise(came)}"


def test_events_of_starting_node():
    """A starting node announces each of its parameters in an event of its own."""
    rclpy.init(args=[])
    from rcl_interfaces.msg import ParameterEvent

    watcher, seen = Node("watcher"), []

    def note(event):
        if event.node == "/z":
            seen.append((event.node, [parameter.name for parameter in event.new_parameters]))

    watcher.create_subscription(ParameterEvent, "/parameter_events", note, 100)
    executor = SingleThreadedExecutor()
    executor.add_node(watcher)
    node = Node("z")
    node.declare_parameter("a", 1)
    node.declare_parameters("", [("b", 1), ("c", 1)])
    assert spin_until(executor, lambda: len(seen) >= 5)
    assert repr(seen) == RECORDED["start_events"][0]["saw"]
