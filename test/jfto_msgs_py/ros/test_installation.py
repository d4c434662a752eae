"""Which ROS 2 is used is found before anything of it is loaded, and said."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from jfto_msgs_py.ros.installation import RosMissingError, find_ros, require_ros

SOURCE = str(Path(__file__).parents[3] / "src")


@pytest.fixture
def wheels():
    """The tests' own ROS 2, where it is the wheels'."""
    found = find_ros()
    if found is None or found.source != "wheels":
        pytest.skip("this environment has ROS 2 from its system")
    return found


def test_what_is_there_is_said(wheels, monkeypatch):
    """Distribution, middleware, versions, domain and discovery range."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    monkeypatch.setenv("ROS_STATIC_PEERS", "10.0.0.2")
    text = str(find_ros())
    assert text.startswith("jazzy (wheels), rmw_fastrtps_cpp (default), rclpy 7.1.6")
    assert text.endswith("domain 7, discovery SUBNET and 10.0.0.2")


def test_discovery_stays_on_this_computer_unless_asked_for(monkeypatch):
    """The variable of ROS is set where the user has not set it, and kept where he has."""
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE")
    require_ros()
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    require_ros()
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "SUBNET"


PROFILES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")


@pytest.mark.parametrize(
    "environment",
    [
        {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"},
        {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_STATIC_PEERS": "10.0.0.2"},
        {"FASTDDS_DEFAULT_PROFILES_FILE": "mine.xml"},
    ],
)
def test_nodes_announce_themselves_often_on_this_computer_only(monkeypatch, environment):
    """Not over a network, and not where the user has settings of his own."""
    for name in PROFILES:
        monkeypatch.delenv(name, raising=False)
    require_ros()
    assert Path(os.environ.pop(PROFILES[0])).read_text().startswith("<?xml")
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    require_ros()
    assert PROFILES[0] not in os.environ


@pytest.mark.slow
def test_the_middleware_takes_our_settings(wheels, tmp_path):
    """A file that it cannot read, it complains of."""
    code = (
        "from jfto_msgs_py.ros.installation import require_ros; require_ros()\n"
        "import rclpy; rclpy.init(args=[]); rclpy.create_node('one').destroy_node()"
    )
    broken = tmp_path / "broken.xml"
    broken.write_text("<profiles>")

    def output(**more: str) -> str:
        environment = {name: each for name, each in os.environ.items() if name not in PROFILES}
        environment |= {"PYTHONPATH": SOURCE, **more}
        done = subprocess.run(
            [sys.executable, "-c", code],
            env=environment, capture_output=True, text=True, check=True,
        )  # fmt: skip
        return done.stdout + done.stderr

    assert output() == ""
    assert "XMLPARSER" in output(FASTRTPS_DEFAULT_PROFILES_FILE=str(broken))


def test_wheels_without_the_wanted_middleware_say_so(wheels, monkeypatch):
    """Rather than end inside ROS with a status of its own."""
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")
    with pytest.raises(RosMissingError, match=r"is rmw_zenoh_cpp, .* have rmw_fastrtps_cpp only"):
        require_ros()


def test_a_sourced_ros_and_wheels_are_not_mixed(wheels, monkeypatch, tmp_path):
    """Their libraries would meet in one process."""
    (tmp_path / "lib/python3.12/site-packages/rclpy").mkdir(parents=True)
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'ws'}:{tmp_path}")
    with pytest.raises(RosMissingError, match=r"Use a shell that has not sourced setup\.bash"):
        require_ros()


@pytest.mark.parametrize(
    "command",
    [
        ["-m", "jfto", "up", "config/demo.yaml"],
        ["-m", "jfto", "topic", "list"],
        ["-m", "jfto.nodes", "power_node"],
    ],
)
def test_without_any_ros_one_sentence_names_both_ways(command):
    """Status 2, for commands that need the graph; an interpreter that hides rclpy stands for one
    that has none.
    """
    hidden = (
        "import importlib.util, runpy, sys\n"
        "found = importlib.util.find_spec\n"
        "importlib.util.find_spec = lambda name, *a: None if name == 'rclpy' else found(name, *a)\n"
        f"sys.argv = {command[1:]!r}\n"
        f"runpy.run_module({command[1]!r}, run_name='__main__', alter_sys=True)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", hidden],
        capture_output=True,
        text=True,
        cwd=Path(SOURCE).parent,
        env={**os.environ, "PYTHONPATH": SOURCE},
        timeout=120,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "pip install" in done.stderr
    assert "source /opt/ros/jazzy/setup.bash" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("domain", ["500", "abc", "-1"])
def test_a_domain_that_cannot_be_is_refused(domain, monkeypatch):
    """Before anything of ROS is asked, whose words for it help nobody."""
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    with pytest.raises(RosMissingError, match=r"must be a number from 0 to 232"):
        require_ros()
