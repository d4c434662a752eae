"""A DDS domain of this process's own, and recorded bags."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

import pytest

import jfto_dds

os.environ["ROS_DOMAIN_ID"] = str(1 + (os.getpid() + 67) % 200)
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["RCUTILS_COLORIZED_OUTPUT"] = "0"

if importlib.util.find_spec("rclpy") is None:
    jfto_dds.install()
# Commands that tests start find the same code.
_SOURCE = str(Path(jfto_dds.__file__).parents[1])
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [_SOURCE, os.environ.get("PYTHONPATH")]))

_BAGS = Path(__file__).parents[2] / "data" / "bags"


@pytest.fixture
def bags(monkeypatch) -> Path:
    """Folder of the bags, which is also the current one, in UTC as when they were recorded."""
    monkeypatch.chdir(_BAGS)
    monkeypatch.setenv("TZ", "UTC")
    return _BAGS
