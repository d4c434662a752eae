"""Executors, callback groups, guard conditions, and exceptions in callbacks."""

import threading

import pytest
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

from rclpy_contract.environment import Spinner, names, spin_until, wait_until
from rclpy_contract.observations import RECORDED, agrees, attempt


class _Gauge:
    """Counts how many of its callbacks run at the same time."""

    def __init__(self):
        self.lock = threading.Lock()
        self.running = self.most = self.ended = 0
        self.together = threading.Event()

    def __call__(self):
        with self.lock:
            self.running += 1
            self.most = max(self.most, self.running)
            if self.running > 1:
                self.together.set()
        # Long enough to meet another callback if one may run; short if one is met.
        self.together.wait(0.3)
        with self.lock:
            self.running -= 1
            self.ended += 1


@pytest.mark.parametrize(
    ("groups", "threads", "together"),
    [
        ("M", 1, False),
        ("R", 1, False),
        ("M", 4, False),
        ("MM", 4, True),
        ("R", 4, True),
        ("self M", 4, False),
        ("self R", 4, True),
    ],
)
def test_overlap(groups, threads, together):
    """Callbacks overlap only in several threads and where their groups let them."""
    rclpy.init(args=[])
    node, gauge = Node("n"), _Gauge()
    kinds = {"M": MutuallyExclusiveCallbackGroup, "R": ReentrantCallbackGroup}
    made = [kinds[kind]() for kind in groups.removeprefix("self ")]
    if groups.startswith("self"):
        node.create_timer(0.02, gauge, made[0])
    else:
        for group in (made * 2)[:2]:
            node.create_timer(0.02, gauge, group)
    executor = SingleThreadedExecutor() if threads == 1 else MultiThreadedExecutor(threads)
    executor.add_node(node)
    with Spinner(executor):
        assert wait_until(lambda: gauge.ended >= 2)
    assert (gauge.most > 1) is together


@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used")
def test_executor_interface():
    """Adding and removing nodes, tasks, shutdown: the recorded lines in order."""
    rclpy.init(args=[])
    import os

    known = names()
    known.update(ex=SingleThreadedExecutor(), a=Node("a"), b=Node("b"))
    # The recording's machine had two cores.
    cores = len(os.sched_getaffinity(0))
    for number in range(7, 31):
        line = RECORDED["executors"][number]
        saw = str(cores) if number == 15 else line["saw"]
        came = attempt(line["did"], known)
        assert agrees(saw, came), f"{line}\n{came}"


def test_spin_once_inside_callback():
    """A callback may spin its executor once; other callbacks run meanwhile."""
    rclpy.init(args=[])
    node, log = Node("n"), []
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    group = ReentrantCallbackGroup()

    def outer():
        timer.cancel()
        executor.spin_once(timeout_sec=0.2)
        log.append("after")

    timer = node.create_timer(0.01, outer, group)
    assert spin_until(executor, lambda: log)
    assert log == ["after"]


def test_global_spin_once_inside_callback():
    """``rclpy.spin_once(node)`` in a callback takes the node away from its executor."""
    rclpy.init(args=[])
    node, log = Node("n"), []
    executor = SingleThreadedExecutor()
    executor.add_node(node)

    def outer():
        timer.cancel()
        rclpy.spin_once(node, timeout_sec=0.05)
        log.append("after")

    timer = node.create_timer(0.01, outer)
    assert spin_until(executor, lambda: log)
    assert node.executor is None
    assert node not in executor.get_nodes()


@pytest.mark.parametrize("kind", [SingleThreadedExecutor, MultiThreadedExecutor])
def test_exception_leaves_spin(kind):
    """An exception in a callback comes out of ``spin``; the executor can go on."""
    rclpy.init(args=[])
    node = Node("n")

    def boom():
        raise ValueError("boom")

    node.create_timer(0.01, boom)
    executor = kind()
    executor.add_node(node)
    with pytest.raises(ValueError, match="boom"):
        executor.spin()
    with pytest.raises(ValueError, match="boom"):
        executor.spin()
    assert rclpy.ok() is True
    if kind is SingleThreadedExecutor:
        with pytest.raises(ValueError, match="boom"):
            executor.spin_once(timeout_sec=5.0)
    executor.shutdown()


def test_subscription_exception_leaves_spin():
    """The same for a subscription."""
    rclpy.init(args=[])
    node = Node("n")
    node.create_subscription(String, "a", lambda _message: 1 / 0, 10)
    publisher = node.create_publisher(String, "a", 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    assert wait_until(lambda: publisher.get_subscription_count() == 1)
    publisher.publish(String())
    with pytest.raises(ZeroDivisionError):
        spin_until(executor, lambda: False)


def test_guard_condition():
    """However often it is triggered, a guard condition's callback runs once per spin."""
    rclpy.init(args=[])
    node, log = Node("n"), []
    guard = node.create_guard_condition(lambda: log.append(1))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    guard.trigger()
    guard.trigger()
    for _ in range(4):
        executor.spin_once(timeout_sec=0.05)
    assert log == [1]
    assert node.destroy_guard_condition(guard) is True


def test_order_of_callbacks():
    """Of what is ready at once: timer, subscription, guard condition, service, then its reply."""
    rclpy.init(args=[])
    node, log = Node("n"), []
    node.create_subscription(String, "a", lambda _message: log.append("subscription"), 10)
    publisher = node.create_publisher(String, "a", 10)

    def serve(_request, response):
        log.append("service")
        return response

    node.create_service(Trigger, "s", serve)
    client = node.create_client(Trigger, "s")
    executor = SingleThreadedExecutor()
    assert wait_until(lambda: publisher.get_subscription_count() and client.service_is_ready())
    timer = node.create_timer(0.001, lambda: (log.append("timer"), timer.cancel()))
    guard = node.create_guard_condition(lambda: log.append("guard"))
    guard.trigger()
    publisher.publish(String())
    future = client.call_async(Trigger.Request())
    future.add_done_callback(lambda _future: log.append("client future"))
    assert wait_until(timer.is_ready)
    threading.Event().wait(0.05)
    executor.add_node(node)
    assert spin_until(executor, lambda: "client future" in log)
    assert log == ["timer", "subscription", "guard", "service", "client future"]


def test_async_subscription_callback():
    """A coroutine as callback may await a future that a timer completes."""
    rclpy.init(args=[])
    node, log = Node("n"), []
    group = ReentrantCallbackGroup()
    ready = rclpy.task.Future()

    async def listen(message):
        log.append(f"{message.data} {await ready}")

    node.create_subscription(String, "a", listen, 10, callback_group=group)
    publisher = node.create_publisher(String, "a", 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    assert wait_until(lambda: publisher.get_subscription_count() == 1)
    publisher.publish(String(data="x"))
    node.create_timer(0.05, lambda: ready.set_result("later"), group)
    assert spin_until(executor, lambda: log)
    assert log == ["x later"]
