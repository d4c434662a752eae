"""Versions of what a result was made with."""

from __future__ import annotations

import platform
from importlib import metadata

from jfto import __version__

LIBRARIES = (
    "numpy",
    "scipy",
    "numba",
    "torch",
    "cvxpy",
    "clarabel",
    "pymavlink",
    "rosbags",
    "rasterio",
    "pyproj",
    "matplotlib",
    "plotly",
    "PyYAML",
    "click",
    "rich",
)


def version_of(library: str) -> str | None:
    """Installed version of a distribution, None if it is absent."""
    try:
        return metadata.version(library)
    except metadata.PackageNotFoundError:
        return None


def versions() -> dict[str, str]:
    """Versions of JFTO, Python and the libraries that a plan's figures depend on."""
    found = {"JFTO": __version__, "Python": platform.python_version()}
    for library in ("numpy", "scipy", "numba", "rasterio", "pyproj", "matplotlib", "plotly"):
        found[library] = version_of(library) or "absent"
    return found
