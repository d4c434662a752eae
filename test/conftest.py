"""Tests of nodes run on the rclpy that is installed, each worker in a ROS domain of its own."""

from __future__ import annotations

import os
import signal
from collections import Counter
from pathlib import Path

import pytest

from jfto_msgs_py.ros.installation import require_ros
from support.domains import OWN
from support.vehicles import pilots, vehicles

__all__ = ["pilots", "vehicles"]

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["RCUTILS_COLORIZED_OUTPUT"] = "0"
os.environ["ROS_DOMAIN_ID"] = str(OWN)
# Commands that tests start find the same code.
_SOURCE = str(Path(__file__).parents[1] / "src")
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [_SOURCE, os.environ.get("PYTHONPATH")]))
require_ros()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Workers begin with the files that take longest, so that none is left with one at the end."""
    if not hasattr(config, "workerinput"):
        return
    seconds: Counter[Path] = Counter()
    for item in items:
        slow = item.get_closest_marker("slow")
        seconds[item.path] += 0 if slow is None else (*slow.args, 2)[0]
    items.sort(key=lambda item: -seconds[item.path])


# A shell that starts the tests in the background has them ignore SIGINT, and so would every
# program that a test starts and then interrupts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
