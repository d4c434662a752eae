"""The life of a node's process: start, spin, end on SIGINT or SIGTERM."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from jfto_msgs_py.errors import JftoError, ScenarioError


def run_node(make: Callable[[], Any], arguments: Sequence[str] | None = None) -> int:
    """Run one node until it is told to stop; returns the exit status.

    `arguments` is the command line, `sys.argv` where None. Bad parameters end it with the status
    of their error before anything is done.
    """
    rclpy.init(args=None if arguments is None else list(arguments))
    node = None
    try:
        node = make()
        node.start()
        # Modules and message classes stay: to walk through them all, as Python does at times, holds
        # up a slot by a tenth of a second.
        gc.collect()
        gc.freeze()
        _spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except JftoError as error:
        problems = error.problems if isinstance(error, ScenarioError) else [str(error)]
        print("\n".join(problems), file=sys.stderr)
        return error.exit_status
    except Exception:
        # A signal ends the context under whatever is being done, which then fails in many ways.
        if rclpy.ok():
            raise
        return 0
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0


def _spin(node: Any) -> None:
    """Spin; an illegal request to change the lifecycle state, which rclpy raises, ends nothing."""
    from rclpy._rclpy_pybind11 import RCLError

    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        while rclpy.ok():
            try:
                executor.spin()
            except RCLError as error:
                if not rclpy.ok():
                    return
                node.get_logger().error(f"Refused: {error}")
    finally:
        executor.shutdown()
