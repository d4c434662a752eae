"""Tests of nodes run on the rclpy that is installed, or on jfto_dds where none is."""

from __future__ import annotations

import os

from jfto.nodes import use_stand_in_where_needed

# On loopback, with message fields checked (jfto_dds always does).
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
use_stand_in_where_needed()
