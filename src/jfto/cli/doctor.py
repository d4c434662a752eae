"""jfto doctor: what this computer has and lacks."""

from __future__ import annotations

import importlib
import os
import platform
import sys
import time
from dataclasses import dataclass

import click

from jfto import __version__
from jfto.cli.options import json_option, print_json
from jfto_msgs_py.environment import version_of

# In the order in which they are looked at.
_LIBRARIES = (
    "numpy",
    "scipy",
    "numba",
    "torch",
    "cvxpy",
    "clarabel",
    "pymavlink",
    "rosbags",
    "rasterio",
    "pyogrio",
    "shapely",
    "pyproj",
    "matplotlib",
    "plotly",
    "Jinja2",
    "PyYAML",
    "click",
    "rich",
)
# Import name where it differs from the distribution's.
_MODULES = {"Jinja2": "jinja2", "PyYAML": "yaml"}
# Used by what needs them only; planning works without.
_OPTIONAL = {
    "torch": "learned policies",
    "cvxpy": "the reference power solver",
    "clarabel": "the reference power solver",
    "pymavlink": "flight",
    "rosbags": "recording bags",
    "pyogrio": "files of areas and no-fly zones",
}


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at; `needed` says that planning cannot do without it."""

    name: str
    good: bool
    needed: bool
    state: str
    cure: str = ""


@click.command("doctor")
@click.option(
    "--compile",
    "compiling",
    is_flag=True,
    help="Compile all numeric kernels now: half a minute, once, that no later command waits for.",
)
@json_option
def command(compiling: bool, as_json: bool) -> int:
    """Say what is installed, what is missing, and what to do about it."""
    findings = examine()
    if compiling:
        findings.append(_kernels(say=not as_json))
    if as_json:
        print_json({"findings": [vars(finding) for finding in findings]})
    else:
        for finding in findings:
            mark = "✓" if finding.good else ("✗" if finding.needed else "–")
            click.echo(f"{mark} {finding.name:<14} {finding.state}")
            if not finding.good and finding.cure:
                click.echo(f"  {'':<14} → {finding.cure}")
    missing = [finding for finding in findings if finding.needed and not finding.good]
    if missing and not as_json:
        click.echo(f"{len(missing)} of the needed parts missing or broken.")
    return 1 if missing else 0


def examine() -> list[Finding]:
    """Look at Python, libraries, terrain and ROS 2; imports every library, so it takes seconds."""
    return [_python(), *(_library(name) for name in _LIBRARIES), _terrain(), _cores(), _ros()]


def _python() -> Finding:
    good = (3, 10) <= sys.version_info < (3, 14)
    state = f"{platform.python_version()}, JFTO {__version__}"
    return Finding("Python", good, True, state, "Use Python 3.10 to 3.13.")


def _library(name: str) -> Finding:
    needed = name not in _OPTIONAL
    use = "" if needed else f", for {_OPTIONAL[name]}"
    version = version_of(name)
    if not version:
        cure = f"pip install -c constraints.txt {name}"
        return Finding(name, False, needed, f"not installed{use}", cure)
    try:
        importlib.import_module(_MODULES.get(name, name))
    except Exception as error:  # noqa: BLE001  a broken library may raise anything at import
        cure = f"pip install --force-reinstall -c constraints.txt {name}"
        return Finding(name, False, needed, f"{version}, does not load: {error}", cure)
    return Finding(name, True, needed, f"{version}{use}")


def _terrain() -> Finding:
    from jfto_msgs_py.errors import JftoError
    from jfto_world.terrain import load_dem

    try:
        dem = load_dem("jacksboro", center=None, size_m=(500.0, 500.0))
    except JftoError as error:
        cure = "Reinstall matplotlib, whose sample data holds it."
        return Finding("terrain", False, True, str(error), cure)
    return Finding("terrain", True, True, f"built-in, {dem.description}")


def _cores() -> Finding:
    return Finding("processor", True, False, f"{os.cpu_count()} cores, {platform.machine()}")


def _kernels(say: bool) -> Finding:
    from jfto.compile_kernels import compile_kernels

    def tell(part: str) -> None:
        if say:
            click.echo(f"  compiling {part} …")

    begin = time.monotonic()
    count = compile_kernels(tell)
    state = f"{count} compiled or loaded in {time.monotonic() - begin:.0f} s"
    return Finding("kernels", True, False, state)


def _ros() -> Finding:
    from jfto_msgs_py.ros.installation import RosMissingError, require_ros

    try:
        state, good = str(require_ros()), True
    except RosMissingError as error:
        state, good = str(error), False
    return Finding("ROS 2", good, False, state)
