"""What surrounds this program: libraries that are installed, and programs that are not ours."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path

# Set by the start-up hook of the ROS 2 wheels, which runs an interpreter anew with their libraries.
_GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def version_of(distribution: str) -> str:
    """Installed version of a distribution, "" if it is absent."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return ""


def foreign_environment(environment: Mapping[str, str] | None = None) -> dict[str, str]:
    """Environment, this process's where None, without what the ROS 2 wheels put into it.

    They add the libraries of this interpreter's environment to LD_LIBRARY_PATH and leave a guard
    that keeps the wheels of another environment from doing the same for themselves.
    """
    given = dict(os.environ if environment is None else environment)
    if given.pop(_GUARD, None) is None:
        return given
    own = Path(sys.prefix).resolve()
    path = given.pop("LD_LIBRARY_PATH", "")
    kept = [part for part in path.split(os.pathsep) if part and not _is_below(part, own)]
    if kept:
        given["LD_LIBRARY_PATH"] = os.pathsep.join(kept)
    return given


def _is_below(part: str, folder: Path) -> bool:
    return Path(part).resolve().is_relative_to(folder)
