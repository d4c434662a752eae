"""Life of a process: signals, shutdown, exceptions. Each script has a node ``n`` with a timer."""

import signal

import pytest

from rclpy_contract.scripts import INIT, start

_NODE = """
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
n = Node("n")
n.create_timer(0.05, lambda: None)
# Not from a callback: a signal that meets one ends spin() without an exception, in rclpy too.
threading.Timer(0.2, print, ["ready"], {"flush": True}).start()
def caught(error):
    print("caught", type(error).__module__, type(error).__name__, repr(str(error)))
    print("ok", rclpy.ok())
"""
_LIMIT_S = 60


def _await_line(process, text):
    """Read until a line; fails where the process ends without it."""
    for line in process.stdout:
        if line.strip() == text:
            return
    pytest.fail(f"the script ended without {text!r}: {process.stderr.read()}")


def _run(body, number=None, *, init=INIT, lines=("ready",)):
    """Run a script and send a signal at each of some lines. Returns (status, stdout, stderr)."""
    with start(init + _NODE + body) as process:
        try:
            if number is not None:
                for line in lines:
                    _await_line(process, line)
                    process.send_signal(number)
            out, err = process.communicate(timeout=_LIMIT_S)
        finally:
            process.kill()
    return process.returncode, out.replace("ready\n", ""), err


_SPIN_CAUGHT = """
try:
    rclpy.spin(n)
except BaseException as error:
    caught(error)
"""


def test_uncaught_sigint():
    """SIGINT ends a spinning program as Python does."""
    status, _, err = _run("rclpy.spin(n)", signal.SIGINT)
    assert status == -signal.SIGINT
    assert err.strip().endswith("KeyboardInterrupt")


def test_uncaught_sigterm():
    """SIGTERM comes out of ``spin`` as ExternalShutdownException."""
    status, _, err = _run("rclpy.spin(n)", signal.SIGTERM)
    assert status == 1
    assert err.strip().endswith("rclpy.executors.ExternalShutdownException")


def test_try_shutdown_after_sigint():
    """``try_shutdown`` is the clean end after SIGINT."""
    body = _SPIN_CAUGHT + "n.destroy_node()\nrclpy.try_shutdown()\nprint('clean end')\n"
    status, out, _ = _run(body, signal.SIGINT)
    assert status == 0
    assert out.startswith("caught builtins KeyboardInterrupt ''\n")
    assert out.endswith("clean end\n")


def test_caught_sigterm():
    """After SIGTERM the context is shut down."""
    status, out, _ = _run(_SPIN_CAUGHT + "rclpy.try_shutdown()\n", signal.SIGTERM)
    assert status == 0
    assert out == "caught rclpy.executors ExternalShutdownException ''\nok False\n"


def test_sigint_in_multi_threaded_executor():
    """The same with several threads."""
    body = """
executor = MultiThreadedExecutor()
executor.add_node(n)
try:
    executor.spin()
except BaseException as error:
    caught(error)
rclpy.try_shutdown()
"""
    status, out, _ = _run(body, signal.SIGINT)
    assert status == 0
    assert out.startswith("caught builtins KeyboardInterrupt ''\n")


def test_sigint_while_callback_sleeps():
    """SIGINT interrupts a callback that sleeps."""
    body = """
def sleepy():
    try:
        print("sleeping", flush=True)
        time.sleep(30)
    except BaseException as error:
        print("in callback", type(error).__name__)
        raise
m = Node("m")
m.create_timer(0.01, sleepy)
try:
    rclpy.spin(m)
except BaseException as error:
    caught(error)
rclpy.try_shutdown()
"""
    status, out, _ = _run(body, signal.SIGINT, lines=("sleeping",))
    assert status == 0
    assert out.startswith("in callback KeyboardInterrupt\ncaught builtins KeyboardInterrupt ''\n")


def test_sigint_in_spin_once_loop():
    """A loop around ``spin_once`` ends with KeyboardInterrupt."""
    body = """
try:
    while rclpy.ok():
        rclpy.spin_once(n, timeout_sec=0.1)
    print("left the loop")
except KeyboardInterrupt:
    print("caught KeyboardInterrupt")
rclpy.try_shutdown()
"""
    status, out, _ = _run(body, signal.SIGINT)
    assert (status, out) == (0, "caught KeyboardInterrupt\n")


def test_sigint_while_nobody_spins():
    """Without anybody spinning, SIGINT is Python's."""
    body = """
try:
    while rclpy.ok():
        time.sleep(0.1)
except KeyboardInterrupt:
    print("caught KeyboardInterrupt")
rclpy.try_shutdown()
"""
    status, out, _ = _run(body, signal.SIGINT)
    assert (status, out) == (0, "caught KeyboardInterrupt\n")


def test_sigint_with_spinning_thread():
    """A thread that spins ends with ExternalShutdownException, the main one is interrupted."""
    body = """
def spin():
    try:
        rclpy.spin(n)
    except BaseException as error:
        print("thread caught", type(error).__name__, flush=True)
thread = threading.Thread(target=spin, daemon=True)
thread.start()
try:
    time.sleep(60)
except KeyboardInterrupt:
    thread.join(30)
    print("main caught KeyboardInterrupt")
print("ok", rclpy.ok())
rclpy.try_shutdown()
"""
    status, out, _ = _run(body, signal.SIGINT)
    assert status == 0
    assert (
        out == "thread caught ExternalShutdownException\nmain caught KeyboardInterrupt\nok False\n"
    )


_NO_HANDLERS = """
from rclpy.signals import SignalHandlerOptions
rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
"""


def test_no_handlers_sigint():
    """Without rclpy's handlers SIGINT leaves the context alone."""
    status, out, _ = _run(_SPIN_CAUGHT + "rclpy.try_shutdown()\n", signal.SIGINT, init=_NO_HANDLERS)
    assert (status, out) == (0, "caught builtins KeyboardInterrupt ''\nok True\n")


def test_no_handlers_sigterm():
    """Without rclpy's handlers SIGTERM kills."""
    status, _, _ = _run("rclpy.spin(n)", signal.SIGTERM, init=_NO_HANDLERS)
    assert status == -signal.SIGTERM


_RETURNED = """
rclpy.spin(n)
print("spin returned")
print("ok", rclpy.ok())
"""


def test_shutdown_from_callback():
    """``rclpy.shutdown()`` in a callback lets ``spin`` return."""
    status, out, _ = _run("n.create_timer(0.02, rclpy.shutdown)\n" + _RETURNED)
    assert (status, out) == (0, "spin returned\nok False\n")


def test_shutdown_from_other_thread():
    """So it does from another thread."""
    body = "threading.Timer(0.2, rclpy.shutdown).start()\n" + _RETURNED
    status, out, _ = _run(body)
    assert (status, out) == (0, "spin returned\nok False\n")


def test_executor_shutdown_from_other_thread():
    """``executor.shutdown()`` ends its ``spin`` and leaves the context running."""
    body = """
executor = SingleThreadedExecutor()
executor.add_node(n)
threading.Timer(0.2, executor.shutdown).start()
executor.spin()
print("spin returned")
print("ok", rclpy.ok())
rclpy.try_shutdown()
"""
    status, out, _ = _run(body)
    assert (status, out) == (0, "spin returned\nok True\n")


def test_system_exit_in_callback():
    """SystemExit in a callback ends the program with its status."""
    body = "def leave():\n    raise SystemExit(3)\nn.create_timer(0.02, leave)\nrclpy.spin(n)\n"
    status, _, _ = _run(body)
    assert status == 3


def test_uncaught_exception_in_callback():
    """Any other exception ends it with status 1."""
    body = "def boom():\n    raise ValueError('boom')\nn.create_timer(0.02, boom)\nrclpy.spin(n)\n"
    status, _, err = _run(body)
    assert status == 1
    assert err.strip().endswith("ValueError: boom")


def test_after_shutdown():
    """After shutdown, what touches the network fails; names, time and log still work."""
    body = """
p = n.create_publisher(String, "a", 10)
rclpy.shutdown()
def show(what, call):
    try:
        print(what, "->", call())
    except Exception as error:
        print(what, "-> raises", type(error).__name__)
show("publish", lambda: p.publish(String()))
show("info", lambda: n.get_logger().info("x"))
show("get_name", n.get_name)
show("now", lambda: n.get_clock().now().nanoseconds > 0)
show("create_publisher", lambda: n.create_publisher(String, "b", 10))
show("create_timer", lambda: n.create_timer(1, print))
show("spin_once", lambda: rclpy.spin_once(n))
show("Node", lambda: Node("z"))
show("topics", n.get_topic_names_and_types)
show("destroy_node", n.destroy_node)
rclpy.init()
show("ok", rclpy.ok)
show("again", lambda: Node("z2").get_name())
rclpy.shutdown()
"""
    status, out, err = _run(body)
    assert status == 0
    assert out.splitlines() == [
        "publish -> raises RCLError",
        "info -> True",
        "get_name -> n",
        "now -> True",
        "create_publisher -> raises RCLError",
        "create_timer -> raises RCLError",
        "spin_once -> raises TypeError",
        "Node -> raises NotInitializedException",
        "topics -> raises RCLError",
        "destroy_node -> None",
        "ok -> True",
        "again -> z2",
    ]
    assert "[n]: x" in err


def test_on_shutdown_callback():
    """Callbacks on shutdown do not stop SIGINT from reaching the program."""
    body = "n.context.on_shutdown(lambda: None)\n" + _SPIN_CAUGHT + "rclpy.try_shutdown()\n"
    status, out, _ = _run(body, signal.SIGINT)
    assert status == 0
    assert out.startswith("caught builtins KeyboardInterrupt ''\n")


@pytest.mark.parametrize("spun", [False, True])
def test_end_without_shutdown(spun):
    """A script may simply end."""
    body = (
        "p = n.create_publisher(String, 'a', 10)\nn.create_subscription(String, 'a', print, 10)\n"
    )
    if spun:
        body += "p.publish(String())\nrclpy.spin_once(n, timeout_sec=5.0)\n"
    status, out, _ = _run(body + "print('end')\n")
    assert status == 0
    assert out.endswith("end\n")


def test_second_sigint():
    """A second SIGINT while the first is dealt with does no harm."""
    body = """
def busy():
    try:
        print("busy", flush=True)
        time.sleep(60)
    except KeyboardInterrupt:
        print("first", flush=True)
        time.sleep(60)
n.create_timer(0.01, busy)
try:
    rclpy.spin(n)
except BaseException as error:
    caught(error)
rclpy.try_shutdown()
"""
    status, out, _ = _run(body, signal.SIGINT, lines=("busy", "first"))
    assert status == 0
    assert out.startswith("caught builtins KeyboardInterrupt ''\n")
