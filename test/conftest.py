"""Tests of nodes run on the rclpy that is installed, or on jfto_dds where none is."""

from __future__ import annotations

import os
import signal

from jfto.nodes import use_stand_in_where_needed

# On loopback, with message fields checked (jfto_dds always does).
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
use_stand_in_where_needed()

# A shell that starts the tests in the background has them ignore SIGINT, and so would every
# program that a test starts and then interrupts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
