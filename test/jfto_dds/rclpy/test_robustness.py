"""Broken payloads from the network, starts and stops, and what a shutdown leaves."""

import contextlib
import random
import subprocess
import sys
import threading
import time
from pathlib import Path

import rclpy
from cyclonedds.core import DDSException
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import Trigger

from jfto_dds.wire.participant import Participant
from jfto_dds.wire.qos_settings import QosSettings

_LIMIT_S = 30.0
_BENCH = Path(__file__).parents[3] / "bench" / "dds.py"


def _spin_until(executor, condition):
    end = time.monotonic() + _LIMIT_S
    while not condition() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    return condition()


def _write_junk(writer, payloads):
    """Write payloads of which Cyclone itself refuses some; returns how many went out."""
    sent = 0
    for payload in payloads:
        with contextlib.suppress(DDSException):
            writer.write(payload)
            sent += 1
    return sent


def test_malformed_messages_do_no_harm(capfd):
    """Two thousand broken payloads are refused, dropped and counted; a good one still arrives."""
    rclpy.init(args=[])
    node, got = Node("victim"), []
    subscription = node.create_subscription(Float64MultiArray, "a", got.append, 5000)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    other = Participant(rclpy.get_default_context().get_domain_id())
    settings = QosSettings(keep_all=True)
    writer = other.create_writer(
        other.add_node("/", "fuzzer"), "rt/a", "std_msgs/msg/Float64MultiArray", settings
    )
    assert _spin_until(executor, lambda: writer.matched_count() == 1)
    rng = random.Random(7)
    huge = b"\0\1\0\0" + bytes(8) + b"\xff\xff\xff\xff"
    empty = Float64MultiArray._TYPE_SUPPORT.serialize(Float64MultiArray())
    junk = [
        rng.choice((huge, empty[:6], empty + rng.randbytes(5), b"\0\1\0\0" + rng.randbytes(9)))
        for _ in range(2000)
    ]
    sent = _write_junk(writer, junk)
    good = Float64MultiArray(data=[1.0])
    writer.write(Float64MultiArray._TYPE_SUPPORT.serialize(good))
    assert _spin_until(executor, lambda: good in got)
    assert subscription._malformed_count + len(got) == sent + 1
    assert capfd.readouterr().err.count("Dropped malformed message") < 100
    other.close()


def test_malformed_requests_do_no_harm():
    """A service survives requests that are none."""
    rclpy.init(args=[])
    node = Node("server")
    node.create_service(Trigger, "s", lambda request, response: response)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    other = Participant(rclpy.get_default_context().get_domain_id())
    writer = other.create_writer(
        other.add_node("/", "fuzzer"),
        "rq/sRequest",
        "std_srvs/srv/Trigger_Request",
        QosSettings(),
        service=True,
        identity={"clientid": "nobody"},
    )
    assert _spin_until(executor, lambda: writer.matched_count() == 1)
    header = b"\0\1\0\0"
    _write_junk(writer, [header, header + bytes(15), header + bytes(16), header + bytes(21)])
    client = node.create_client(Trigger, "s")
    assert _spin_until(executor, client.service_is_ready)
    future = client.call_async(Trigger.Request())
    assert _spin_until(executor, future.done)
    other.close()


def test_many_nodes_come_and_go():
    """Nodes, endpoints and contexts can be made and destroyed over and over."""
    for _ in range(20):
        rclpy.init(args=[])
        node, got = Node("n"), []
        node.create_subscription(String, "a", got.append, 10)
        publisher = node.create_publisher(String, "a", 10)
        publisher.publish(String(data="x"))
        rclpy.spin_once(node, timeout_sec=5.0)
        assert got
        node.destroy_node()
        rclpy.shutdown()


def test_shutdown_while_messages_pour_in():
    """Closing a context while another thread publishes and this one receives does not hang."""
    for _ in range(5):
        rclpy.init(args=[])
        node = Node("n")
        node.create_subscription(String, "a", lambda _message: None, 10)
        publisher = node.create_publisher(String, "a", 10)
        stopped = threading.Event()

        def pour(publisher=publisher, stopped=stopped):
            try:
                while True:
                    publisher.publish(String(data="x"))
            except RuntimeError:
                stopped.set()

        thread = threading.Thread(target=pour)
        thread.start()
        for _ in range(50):
            rclpy.spin_once(node, timeout_sec=1.0)
        rclpy.shutdown()
        assert stopped.wait(_LIMIT_S)
        thread.join()


def test_start_and_stop_cycles():
    """A talker and a listener start, meet and end, several times, without a hang."""
    done = subprocess.run(
        [sys.executable, str(_BENCH), "cycles", "--count", "2"],
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2 cycles without a hang" in done.stdout


def test_reliable_stream_loses_nothing():
    """Two thousand messages between two processes arrive in order."""
    done = subprocess.run(
        [sys.executable, str(_BENCH), "throughput", "--count", "2000"],
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2000 received, 0 lost" in done.stdout
