"""Which network a process talks on: the ROS environment variables as Cyclone configuration.

Follows rmw_cyclonedds_cpp of Jazzy, with one deliberate difference: where nothing is said the
range is LOCALHOST, not SUBNET, and only the loopback interface is used.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from xml.sax.saxutils import quoteattr

_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
# Participants on one machine beyond this find no free port.
_MAX_PARTICIPANT_INDEX = 60
MAX_DOMAIN_ID = 232


class NetworkSettingError(ValueError):
    """An environment variable that selects the network has no legal value."""


def domain_id(environment: Mapping[str, str] = os.environ) -> int:
    """Read ``ROS_DOMAIN_ID`` (0 where unset); raises NetworkSettingError."""
    text = environment.get("ROS_DOMAIN_ID", "").strip()
    if not text:
        return 0
    if not text.isdecimal() or int(text) > MAX_DOMAIN_ID:
        msg = f"ROS_DOMAIN_ID is {text!r}, must be an integer from 0 to {MAX_DOMAIN_ID}."
        raise NetworkSettingError(msg)
    return int(text)


def security_is_wanted(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether ``ROS_SECURITY_ENABLE`` asks for encryption; only ``true`` does, as in rcl."""
    return environment.get("ROS_SECURITY_ENABLE", "") == "true"


def static_peers(environment: Mapping[str, str] = os.environ) -> list[str]:
    """Read ``ROS_STATIC_PEERS``, addresses separated by semicolons."""
    listed = environment.get("ROS_STATIC_PEERS", "").split(";")
    return [peer.strip() for peer in listed if peer.strip()]


def discovery_range(environment: Mapping[str, str] = os.environ) -> str:
    """Read the automatic discovery range; an unknown value counts as LOCALHOST, as in rcl."""
    if environment.get("ROS_LOCALHOST_ONLY", "") == "1":
        return "LOCALHOST"
    chosen = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper()
    return chosen if chosen in _RANGES else "LOCALHOST"


def configuration(environment: Mapping[str, str] = os.environ) -> str | None:
    """Compose the Cyclone configuration: ours, then what ``CYCLONEDDS_URI`` adds or overrides.

    Returns None where neither says anything, so that Cyclone's own defaults hold.
    """
    user = environment.get("CYCLONEDDS_URI", "")
    chosen = discovery_range(environment)
    if chosen == "SYSTEM_DEFAULT":
        return user or None
    # ROS_LOCALHOST_ONLY ignores static peers, in Jazzy too.
    localhost_only = environment.get("ROS_LOCALHOST_ONLY", "") == "1"
    peers = [] if localhost_only or chosen == "OFF" else static_peers(environment)
    general = ""
    if chosen == "LOCALHOST":
        if not peers and not user:
            general += '<Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>'
        peers = ["127.0.0.1", *peers]
    if chosen != "SUBNET":
        general += "<AllowMulticast>false</AllowMulticast>"
    if chosen == "OFF":
        discovery = (
            f"<ParticipantIndex>none</ParticipantIndex><Tag>ros_discovery_off_{os.getpid()}</Tag>"
        )
    else:
        listed = "".join(f"<Peer address={quoteattr(peer)}/>" for peer in peers)
        discovery = (
            "<ParticipantIndex>auto</ParticipantIndex>"
            f"<MaxAutoParticipantIndex>{_MAX_PARTICIPANT_INDEX}</MaxAutoParticipantIndex>"
            + (f"<Peers>{listed}</Peers>" if listed else "")
        )
    general = f"<General>{general}</General>" if general else ""
    ours = f"<CycloneDDS><Domain>{general}<Discovery>{discovery}</Discovery></Domain></CycloneDDS>"
    return f"{ours},{user}" if user else ours
