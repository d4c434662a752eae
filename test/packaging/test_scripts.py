"""The scripts that a newcomer runs first."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = ("scripts/demo", "scripts/test", "scripts/check", ".ci/run")


@pytest.mark.parametrize("name", [*SCRIPTS, "scripts/_setup.sh"])
def test_scripts_are_sound(name: str) -> None:
    """Each script parses; those that are run are executable and stop at the first error."""
    path = ROOT / name
    subprocess.run(["bash", "-n", str(path)], check=True)
    if name in SCRIPTS:
        assert os.access(path, os.X_OK)
        assert "set -euo pipefail" in path.read_text()


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout without .venv, just large enough for the set-up."""
    (tmp_path / "scripts").mkdir()
    for name in ("scripts/_setup.sh", "scripts/demo", "constraints.txt", "setup.cfg", "setup.py"):
        shutil.copy(ROOT / name, tmp_path / name)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def _demo(checkout: Path, interpreter: str) -> subprocess.CompletedProcess[str]:
    """Run scripts/demo with a stand-in for Python, written in shell."""
    path = checkout / "python"
    path.write_text(f"#!/bin/sh\n{interpreter}\n")
    path.chmod(0o755)
    return subprocess.run(
        [str(checkout / "scripts" / "demo")],
        env={"PATH": os.environ["PATH"], "PYTHON": str(path)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_missing_system_package_is_named(checkout: Path) -> None:
    """A Python without venv, as Debian ships it, leads to the package to install."""
    done = _demo(
        checkout,
        'case "$2" in *ensurepip*) exit 1;; *print*) echo 3.12;; esac',
    )
    assert done.returncode == 1
    assert "sudo apt install python3.12-venv" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (checkout / ".venv").exists()


def test_an_unsupported_python_is_named(checkout: Path) -> None:
    """Without a supported Python the script says which ones are."""
    done = _demo(checkout, "exit 1")
    assert done.returncode == 1
    assert "JFTO needs Python 3.10 to 3.13" in done.stderr


def test_a_failed_installation_shows_its_errors_and_is_retried(checkout: Path) -> None:
    """The installer's errors are shown, and no stamp is left that would skip the next set-up."""
    make_venv = f"mkdir -p {checkout}/.venv/bin; cp $0 {checkout}/.venv/bin/python;"
    done = _demo(
        checkout,
        f'case "$*" in *"pip install"*) echo "ERROR: no network"; exit 1;; '
        f'*"venv {checkout}"*) {make_venv} exit 0;; esac',
    )
    assert done.returncode == 1
    assert "ERROR: no network" in done.stderr
    assert ".venv/setup.log" in done.stderr
    assert not (checkout / ".venv" / "stamp").exists()


@pytest.mark.parametrize("sourced", [False, True])
def test_the_wheels_of_ros_come_only_where_no_ros_is(checkout: Path, sourced: bool) -> None:
    """Where `import rclpy` works before the set-up, the extra is left out and old wheels go."""
    make_venv = f"mkdir -p {checkout}/.venv/bin; cp $0 {checkout}/.venv/bin/python;"
    old = checkout / ".venv/lib/python3.12/site-packages/ros_rclpy-7.1.6.dist-info"
    old.mkdir(parents=True)
    done = _demo(
        checkout,
        f'case "$*" in *"import rclpy"*) exit {int(not sourced)};; '
        '*"pip --version"*) exit 0;; '
        f'*"pip install"*) echo "$*"; echo "ERROR: enough seen"; exit 1;; '
        f'*"venv {checkout}"*) {make_venv} exit 0;; esac',
    )
    log = (checkout / ".venv/setup.log").read_text()
    assert done.returncode == 1
    assert (".[bench,dev,ros]" in log) is not sourced
    assert not (sourced and old.exists())
