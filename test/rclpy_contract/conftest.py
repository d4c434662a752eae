"""Runs this folder on the rclpy that is installed, or on jfto_dds where none is."""

import faulthandler
import importlib.util
import os
from pathlib import Path

import pytest

# A test that hangs ends the process with the stacks of its threads instead of blocking for ever.
_TEST_LIMIT_S = 240.0

# Of its own domain per process, on loopback, with message fields checked (jfto_dds always does).
os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 200)
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["RCUTILS_COLORIZED_OUTPUT"] = "0"

if importlib.util.find_spec("rclpy") is None:
    import jfto_dds

    jfto_dds.install()
    # Scripts that tests start find it too.
    paths = [str(Path(jfto_dds.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, paths))


@pytest.fixture(autouse=True)
def ended_context():
    """Shut the default context down after each test, whatever happened in it."""
    faulthandler.dump_traceback_later(_TEST_LIMIT_S, exit=True)
    yield
    import rclpy

    rclpy.try_shutdown()
    faulthandler.cancel_dump_traceback_later()
