"""The life of a node's process: start, spin, end on SIGINT or SIGTERM within two seconds."""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import rclpy
from rclpy.context import Context
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor

from jfto_msgs_py.errors import JftoError, ScenarioError

# How long a node may take to end after it was told to; then it is ended as it is.
END_S = 1.5
_SPIN_S = 1.0
EXIT_FORCED = 1


class Ending:
    """Ends the process in time after SIGINT or SIGTERM, whatever its threads are doing.

    Signals no longer raise KeyboardInterrupt, which could come in the middle of anything, and a
    second one, as terminals and launch files send, changes nothing. rclpy hears of the first by
    itself and lets the executor return. A thread waits for it too, and ends a process that is held
    up: in a computation, in the middleware, or on a computer that is too busy.
    """

    def __init__(self) -> None:
        self._status = 0
        self._read, write = os.pipe()
        os.set_blocking(write, False)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: None)
        signal.set_wakeup_fd(write, warn_on_full_buffer=False)
        threading.Thread(target=self._wait, name="ending", daemon=True).start()

    def end_with(self, status: int) -> None:
        """Status of a process that has to be ended from here on.

        0 while there is nothing to lose: before the node works, and when it has been released.
        """
        self._status = status

    def _wait(self) -> None:
        os.read(self._read, 1)
        threading.Event().wait(END_S)
        if self._status == EXIT_FORCED:
            print(f"Held up, so ended {END_S:g} s after the signal.", file=sys.stderr)
        end_process(self._status)


def end_process(status: int) -> NoReturn:
    """End this process now, without waiting for threads of its own or of the middleware."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(status)


def run_node(make: Callable[[], Any], arguments: Sequence[str] | None = None) -> int:
    """Run one node until it is told to stop; returns the exit status.

    `arguments` is the command line, `sys.argv` where None. Bad parameters end it with the status
    of their error before anything is done. To be called in the main thread of a process that is for
    this node only.
    """
    ending = Ending()
    rclpy.init(args=None if arguments is None else list(arguments))
    node, executor = None, None
    status = 0
    try:
        node = make()
        node.start()
        # Modules and message classes stay: to walk through them all, as Python does at times, holds
        # up a slot by a tenth of a second.
        gc.collect()
        gc.freeze()
        executor = make_executor(answers_later=node.answers_later)
        executor.add_node(node)
        ending.end_with(EXIT_FORCED)
        _spin(node, executor)
    except ExternalShutdownException:
        pass
    except JftoError as error:
        problems = error.problems if isinstance(error, ScenarioError) else [str(error)]
        print("\n".join(problems), file=sys.stderr)
        status = error.exit_status
    except Exception:
        # A signal ends the context under whatever is being done, which then fails in many ways.
        if rclpy.ok():
            raise
    finally:
        if node is not None:
            node.released()
            ending.end_with(status)
            node.destroy_node()
        rclpy.try_shutdown()
        # The participant goes with the last that refers to it, and takes its shared memory along.
        node = executor = None
        gc.unfreeze()
        gc.collect()
    return status


def make_executor(*, answers_later: bool, context: Context | None = None) -> Executor:
    """The executor that wakes up cheapest: by events, where this rclpy has one, else by wait sets.

    The latter tells the middleware anew what it waits for, message by message, which takes about as
    long as all that a node does with a pose. The former cannot await a service's coroutine or take
    guard conditions, so nodes that answer later get wait sets.
    """
    if not answers_later:
        try:
            from rclpy.experimental import EventsExecutor
        except ImportError:
            pass
        else:
            return EventsExecutor(context=context)
    return SingleThreadedExecutor(context=context)


def _spin(node: Any, executor: Executor) -> None:
    """Spin; an illegal request to change the lifecycle state, which rclpy raises, ends nothing."""
    from rclpy._rclpy_pybind11 import RCLError

    try:
        while rclpy.ok():
            try:
                # Without an end to its wait the events executor of the wheels spins on a clock that
                # overflows: it takes a whole core and nothing reaches it.
                executor.spin_once(timeout_sec=_SPIN_S)
            except RCLError as error:
                if not rclpy.ok():
                    return
                node.get_logger().error(f"Refused: {error}")
    finally:
        executor.shutdown(timeout_sec=0.0)
