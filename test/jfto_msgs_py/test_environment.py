"""Programs that are not ours get an environment without the ROS 2 wheels."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from jfto_msgs_py.environment import foreign_environment

GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def test_what_the_wheels_added_is_taken_out_and_the_users_own_stays():
    """Library folders of this interpreter's environment go, others and other variables stay."""
    own = str(Path(sys.prefix) / "lib")
    given = {GUARD: "1", "LD_LIBRARY_PATH": f"{own}:/opt/vendor/lib", "HOME": "/home/me"}
    assert foreign_environment(given) == {"LD_LIBRARY_PATH": "/opt/vendor/lib", "HOME": "/home/me"}
    assert "LD_LIBRARY_PATH" not in foreign_environment({GUARD: "1", "LD_LIBRARY_PATH": own})


def test_without_wheels_nothing_changes():
    """A library path that a sourced ROS 2 or the user has set is passed on."""
    given = {"LD_LIBRARY_PATH": "/opt/ros/jazzy/lib"}
    assert foreign_environment(given) == given


def test_a_shell_hears_nothing_of_the_wheels():
    """The environment of this process, as a foreign program would get it."""
    shown = subprocess.run(
        ["env"], env=foreign_environment(), capture_output=True, text=True, check=True
    )
    assert GUARD not in shown.stdout
    assert str(Path(sys.prefix) / "lib") not in shown.stdout.partition("LD_LIBRARY_PATH=")[2]
