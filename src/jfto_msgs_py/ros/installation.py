"""Which ROS 2 this interpreter has: one that was sourced, or the wheels of the extra `[ros]`."""

from __future__ import annotations

import importlib
import importlib.util
import os
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Literal

from jfto_msgs_py.environment import version_of
from jfto_msgs_py.errors import InputError

# The wheels bring this one only.
_WHEELS_RMW = "rmw_fastrtps_cpp"
_WHEELS_DISTRIBUTION = "jazzy"
_GREATEST_DOMAIN = 232
_DISCOVERY = "ROS_AUTOMATIC_DISCOVERY_RANGE"
# Where Fast DDS 2 and 3 are told of a user's settings, which win over ours.
_PROFILES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
_LOCAL_PROFILE = Path(__file__).with_name("fast_dds.xml")
BOTH_WAYS = (
    'pip install -c constraints.txt ".[ros]" (Linux x86_64), or on a ROS computer: '
    "source /opt/ros/jazzy/setup.bash"
)


class RosMissingError(InputError):
    """No ROS 2 that this interpreter could use."""


@dataclass(frozen=True)
class RosInstallation:
    """The ROS 2 that `import rclpy` finds.

    `source` is "wheels" (the extra `[ros]`) or "system"; `versions` holds what is known of
    packages; `discovery` is how far nodes look for one another.
    """

    source: Literal["wheels", "system"]
    distribution: str
    rmw: str
    versions: dict[str, str]
    domain: str
    discovery: str

    def __str__(self) -> str:
        versions = ", ".join(f"{name} {version}" for name, version in self.versions.items())
        where = "wheels" if self.source == "wheels" else "system"
        return (
            f"{self.distribution} ({where}), {self.rmw}, {versions or 'versions unknown'}, "
            f"domain {self.domain}, discovery {self.discovery}"
        )


def find_ros() -> RosInstallation | None:
    """What this interpreter has; None where it has no rclpy. Imports nothing of ROS."""
    found = importlib.util.find_spec("rclpy")
    if found is None or found.origin is None:
        return None
    from_wheels = _wheels_folder() == Path(found.origin).parents[1]
    names = ("rclpy", "rmw-fastrtps-cpp", "common-interfaces")
    versions = {name: version_of(f"ros-{name}") for name in names} if from_wheels else {}
    distribution = os.environ.get("ROS_DISTRO", "unknown")
    return RosInstallation(
        source="wheels" if from_wheels else "system",
        distribution=_WHEELS_DISTRIBUTION if from_wheels else distribution,
        rmw=os.environ.get("RMW_IMPLEMENTATION") or f"{_WHEELS_RMW} (default)",
        versions={name: version for name, version in versions.items() if version},
        domain=os.environ.get("ROS_DOMAIN_ID") or "0",
        discovery=_discovery(),
    )


def require_ros() -> RosInstallation:
    """Make sure that `import rclpy` works, and keep discovery on this computer unless asked for.

    Where it stays there, nodes announce themselves more often than by default, so that they find
    one another in a fraction of a second: over a radio that would be a burden.

    Raises RosMissingError where there is no ROS 2 or none that loads, two at once, wheels that lack
    the wanted middleware, or a domain that cannot be.
    """
    os.environ.setdefault(_DISCOVERY, "LOCALHOST")
    if not any(os.environ.get(name) for name in _PROFILES) and _discovery() == "LOCALHOST":
        os.environ[_PROFILES[0]] = str(_LOCAL_PROFILE)
    _require_domain()
    found = find_ros()
    if found is None:
        raise RosMissingError(
            f"This needs ROS 2 Jazzy, and no rclpy was found. Get it by {BOTH_WAYS}. "
            "Planning, missions and reports work without."
        )
    if os.environ.get("AMENT_PREFIX_PATH") and _sourced_rclpy() and _wheels_folder() is not None:
        raise RosMissingError(
            "A sourced ROS 2 and the ROS 2 wheels meet in this process, whose libraries do not "
            "mix. Use a shell that has not sourced setup.bash, or an environment without the "
            "extra [ros]."
        )
    wanted = os.environ.get("RMW_IMPLEMENTATION", "")
    if found.source == "wheels" and wanted not in ("", _WHEELS_RMW):
        raise RosMissingError(
            f"RMW_IMPLEMENTATION is {wanted}, and the ROS 2 wheels have {_WHEELS_RMW} only. Unset "
            "it, or use ROS 2 from apt."
        )
    try:
        importlib.import_module("rclpy")
    except ImportError as error:
        raise RosMissingError(
            f"rclpy is there but cannot be loaded: {error}. Make the environment anew, or get "
            f"ROS 2 by {BOTH_WAYS}."
        ) from None
    return found


def _require_domain() -> None:
    """Refuse a ROS domain that has no ports."""
    domain = os.environ.get("ROS_DOMAIN_ID", "")
    if domain and not (domain.isdecimal() and int(domain) <= _GREATEST_DOMAIN):
        raise RosMissingError(
            f"ROS_DOMAIN_ID is {domain!r}, must be a number from 0 to {_GREATEST_DOMAIN}; above "
            "101 Linux may have given its ports away."
        )


def _discovery() -> str:
    told = os.environ.get(_DISCOVERY, "LOCALHOST")
    peers = os.environ.get("ROS_STATIC_PEERS", "")
    return f"{told} and {peers}" if peers else told


def _wheels_folder() -> Path | None:
    """Where the wheels' rclpy lies."""
    try:
        return Path(str(metadata.distribution("ros-rclpy").locate_file("")))
    except metadata.PackageNotFoundError:
        return None


def _sourced_rclpy() -> bool:
    """Whether a sourced prefix has an rclpy of its own."""
    prefixes = os.environ["AMENT_PREFIX_PATH"].split(os.pathsep)
    return any(
        next(Path(prefix).glob("lib/python3*/site-packages/rclpy"), None) is not None
        for prefix in prefixes
        if prefix
    )
