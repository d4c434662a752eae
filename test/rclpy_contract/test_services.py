"""Service clients and servers, blocking and awaiting calls."""

import time

import pytest
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

from rclpy_contract.environment import Spinner, spin_for, spin_until, wait_until


def _serve(_request, response):
    response.success, response.message = True, "ok"
    return response


def _pair(**options):
    rclpy.init(args=[])
    node, executor = Node("n"), SingleThreadedExecutor()
    executor.add_node(node)
    node.create_service(Trigger, "s", _serve, **options)
    client = node.create_client(Trigger, "s", **options)
    assert client.wait_for_service(20.0) is True
    return node, executor, client


def test_service_client():
    """The recorded story: waiting, wrong requests, a call, time-outs, giving up."""
    node, executor, client = _pair()
    assert client.service_is_ready() is True
    nobody = node.create_client(Trigger, "none")
    start = time.monotonic()
    assert nobody.wait_for_service(0.3) is False
    assert time.monotonic() - start >= 0.29
    assert nobody.wait_for_service(timeout_sec=0) is False
    assert nobody.service_is_ready() is False
    for wrong in (Trigger, SetBool.Request(), None):
        with pytest.raises(TypeError, match=r"^$"):
            client.call_async(wrong)
    with pytest.raises(TypeError, match=r"^$"):
        client.call("x")
    future = client.call_async(Trigger.Request())
    assert (future.done(), future.cancelled(), future.result()) == (False, False, None)
    executor.spin_until_future_complete(future, timeout_sec=20.0)
    assert future.done() is True
    assert repr(future.result()) == "std_srvs.srv.Trigger_Response(success=True, message='ok')"
    assert future.exception() is None
    lost = nobody.call_async(Trigger.Request())
    start = time.monotonic()
    assert executor.spin_until_future_complete(lost, timeout_sec=0.3) is None
    assert time.monotonic() - start >= 0.29
    assert (lost.done(), lost.result()) == (False, None)
    assert rclpy.spin_until_future_complete(node, lost, timeout_sec=0.05) is None
    assert len(nobody._pending_requests) == 1
    assert nobody.remove_pending_request(lost) is None
    assert len(nobody._pending_requests) == 0
    lost = nobody.call_async(Trigger.Request())
    lost.cancel()
    assert (lost.cancelled(), lost.done(), lost.result()) == (True, False, None)
    assert len(nobody._pending_requests) == 0


def test_blocking_call():
    """``call`` works while another thread spins."""
    _, executor, client = _pair()
    with Spinner(executor):
        response = client.call(Trigger.Request())
    assert (response.success, response.message) == (True, "ok")


def test_blocking_call_times_out():
    """``call`` returns None on time-out."""
    node, executor, _ = _pair()
    nobody = node.create_client(Trigger, "none")
    with Spinner(executor):
        start = time.monotonic()
        assert nobody.call(Trigger.Request(), timeout_sec=0.3) is None
        assert time.monotonic() - start >= 0.29


def test_call_in_callback_deadlocks():
    """A blocking call in a callback of a single-threaded executor gets no answer."""
    node, executor, client = _pair()
    results = []

    def blocked():
        timer.cancel()
        results.append(client.call(Trigger.Request(), timeout_sec=0.5))

    timer = node.create_timer(0.01, blocked)
    assert spin_until(executor, lambda: results)
    assert results == [None]


def test_call_in_callback_with_threads():
    """With several threads and reentrant groups it is answered."""
    group = ReentrantCallbackGroup()
    node, single, client = _pair(callback_group=group)
    single.shutdown()
    executor, results = MultiThreadedExecutor(4), []
    executor.add_node(node)

    def call():
        timer.cancel()
        results.append(client.call(Trigger.Request()))

    timer = node.create_timer(0.01, call, group)
    with Spinner(executor):
        assert wait_until(lambda: results)
    assert results[0].message == "ok"


def test_awaiting_in_own_group_deadlocks():
    """Awaiting a call keeps the callback's group, so one group for all waits for itself."""
    node, executor, client = _pair()
    results = []

    async def call():
        timer.cancel()
        results.append((await client.call_async(Trigger.Request())).message)

    timer = node.create_timer(0.01, call)
    spin_for(executor, 0.5)
    assert results == []


def test_awaiting_other_groups():
    """With client and server in another, reentrant group the call is answered."""
    node, executor, client = _pair(callback_group=ReentrantCallbackGroup())
    results = []

    async def call():
        timer.cancel()
        results.append((await client.call_async(Trigger.Request())).message)

    timer = node.create_timer(0.01, call)
    assert spin_until(executor, lambda: results)
    assert results == ["ok"]


def test_coroutine_as_service_callback():
    """A service callback may be a coroutine."""
    rclpy.init(args=[])
    node, executor = Node("n"), SingleThreadedExecutor()
    executor.add_node(node)
    group, gate = ReentrantCallbackGroup(), rclpy.task.Future()

    async def serve(_request, response):
        response.message = await gate
        return response

    node.create_service(Trigger, "s", serve, callback_group=group)
    client = node.create_client(Trigger, "s", callback_group=group)
    assert client.wait_for_service(20.0)
    future = client.call_async(Trigger.Request())
    node.create_timer(0.05, lambda: gate.set_result("done"), group)
    executor.spin_until_future_complete(future, 20.0)
    assert future.result().message == "done"


@pytest.mark.parametrize(
    ("answer", "error"),
    [("raise", ValueError), (None, TypeError), ("text", TypeError)],
)
def test_failing_service_callbacks(answer, error):
    """A service callback that fails leaves ``spin``, and the client waits for ever."""
    rclpy.init(args=[])
    server, node = Node("server"), Node("client")

    def serve(_request, _response):
        if answer == "raise":
            raise ValueError("srv boom")
        return answer

    server.create_service(Trigger, "s", serve)
    client = node.create_client(Trigger, "s")
    executor = SingleThreadedExecutor()
    executor.add_node(server)
    executor.add_node(node)
    assert client.wait_for_service(20.0)
    future = client.call_async(Trigger.Request())
    with pytest.raises(error):
        spin_until(executor, lambda: False)
    spin_for(executor, 0.1)
    assert (future.result(), future.done()) == (None, False)
