"""Gives each test process a DDS domain of its own, on loopback, and a limit per test."""

import faulthandler
import json
import os
from pathlib import Path

import pytest

_TEST_LIMIT_S = 240.0
_DATA = Path(__file__).parents[1] / "data" / "ros2"

os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 200)
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["RCUTILS_COLORIZED_OUTPUT"] = "0"

import jfto_dds  # noqa: E402 - the environment decides how it works

jfto_dds.install()
# Programs that tests start find it too.
_PATHS = [str(Path(jfto_dds.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, _PATHS))


@pytest.fixture(autouse=True)
def limit():
    """End a test that hangs, with the stacks of its threads; leave no context behind."""
    faulthandler.dump_traceback_later(_TEST_LIMIT_S, exit=True)
    yield
    import rclpy

    rclpy.try_shutdown()
    faulthandler.cancel_dump_traceback_later()


@pytest.fixture(scope="session")
def recorded_types():
    """Hashes, fields and encoded examples recorded from a real ROS 2."""
    return json.loads((_DATA / "cdr.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def recorded_wire():
    """What a real node announced and sent."""
    return json.loads((_DATA / "wire.json").read_text(encoding="utf-8"))
