"""Nodes in this process on a ROS domain of their own, and waiting on conditions."""

from __future__ import annotations

import time

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock

from jfto_msgs_py.ros.run_node import make_executor
from jfto_msgs_py.ros.stamps import encode_time
from support.domains import next_domain
from support.fleets import START_NS

# Under load a message can be late by seconds; what does not come at all must still end.
LIMIT_S = 90.0
# More than there are timers and messages under way.
_DUE = 30

# Three UAVs within reach of each other, ten slots.
SCENARIO = {
    "fleet.count": 3,
    "fleet.energy_j": [50.0],
    "network.k_min": 1,
    "network.delta": 1,
    "mission.slot_count": 10,
    "starts.count": 3,
}


class Graph:
    """Nodes under test and an observer beside them. Use as a context manager.

    Time is simulated where a test sets it with `at`.
    """

    def __init__(self, *, answers_later: bool = True) -> None:
        self.context = Context()
        rclpy.init(args=[], context=self.context, domain_id=next_domain())
        self.executor = make_executor(answers_later=answers_later, context=self.context)
        self.observer = Node("observer", context=self.context)
        self.executor.add_node(self.observer)
        self._clock = self.observer.create_publisher(Clock, "/clock", 10)
        self._nodes = [self.observer]

    def __enter__(self) -> Graph:
        return self

    def __exit__(self, *exception: object) -> None:
        self.executor.shutdown()
        for node in reversed(self._nodes):
            node.destroy_node()
        self.context.try_shutdown()

    def add(self, kind, *arguments, start=True, **parameters):
        """A node with the scenario's and further parameters; started."""
        values = SCENARIO | {name.replace("__", "."): value for name, value in parameters.items()}
        node = kind(
            *arguments,
            context=self.context,
            parameter_overrides=[Parameter(name, value=value) for name, value in values.items()],
        )
        self._nodes.append(node)
        self.executor.add_node(node)
        if start:
            node.start()
        return node

    @property
    def newest(self):
        """The node that was added last; executors list theirs in no order."""
        return self._nodes[-1]

    def remove(self, node) -> None:
        """Take a node off the graph."""
        self._nodes.remove(node)
        self.executor.remove_node(node)
        node.destroy_node()

    def until(self, condition, limit_s: float = LIMIT_S) -> None:
        """Spin until a condition holds."""
        end = time.monotonic() + limit_s
        while not condition():
            assert time.monotonic() < end, "it did not happen"
            self.executor.spin_once(timeout_sec=0.05)

    def at(self, seconds: float) -> None:
        """Set the simulated time, counted from the fleets' start; all nodes have it after."""
        stamp_ns = START_NS + round(seconds * 1e9)
        message = Clock(clock=encode_time(stamp_ns))
        self.until(lambda: self._clock.get_subscription_count() >= len(self._nodes) - 1)
        self._clock.publish(message)
        self.until(lambda: all(node.now_ns() == stamp_ns for node in self._nodes[1:]))
        # Timers that have become due run now: the events executor would count a second jump twice.
        for _ in range(_DUE):
            self.executor.spin_once(timeout_sec=0.0)

    def collect(self, kind, topic, profile) -> list:
        """List that messages on a topic are added to."""
        got: list = []
        self.observer.create_subscription(kind, topic, got.append, profile)
        return got
