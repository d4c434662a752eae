"""The graph: names of topics, services and nodes, hidden ones apart, and the QoS that fits them."""

from __future__ import annotations

from typing import Any

from rclpy.exceptions import NameValidationException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rclpy.validate_full_topic_name import validate_full_topic_name

from jfto.ros_cli import RosCommandError
from jfto.ros_cli.session import Session

NamesAndTypes = list[tuple[str, list[str]]]
# A node that begins on a busy computer finds the others that late.
_APPEAR_LIMIT_S = 5.0
_DEPTH = 10


def topics(node: Any, *, hidden: bool = False) -> NamesAndTypes:
    """Topics and their types, sorted by name."""
    return shown(node.get_topic_names_and_types(), hidden=hidden)


def services(node: Any, *, hidden: bool = False) -> NamesAndTypes:
    """Services and their types, sorted by name."""
    return shown(node.get_service_names_and_types(), hidden=hidden)


def shown(found: NamesAndTypes, *, hidden: bool) -> NamesAndTypes:
    """Names and types sorted by name, without those that are hidden."""
    return sorted(entry for entry in found if hidden or not topic_or_service_is_hidden(entry[0]))


def nodes(node: Any, *, hidden: bool = False) -> list[str]:
    """Full names of all nodes, sorted; one that is there twice is named twice."""
    return sorted(
        f"{namespace.rstrip('/')}/{name}"
        for name, namespace in node.get_node_names_and_namespaces()
        if hidden or not name.startswith("_")
    )


def find_node(session: Session, name: str) -> str:
    """Full name of a node, waited for a while; raises RosCommandError where it does not come."""
    full = name if name.startswith("/") else f"/{name}"
    if not session.spin_until(lambda: full in nodes(session.node, hidden=True), _APPEAR_LIMIT_S):
        raise RosCommandError(f"No node {full}. `jfto node list` names those that are there.")
    return full


def find_topic(session: Session, name: str) -> tuple[str, list[str]]:
    """Full name and types of a topic, waited for a while; raises RosCommandError without any."""
    full = full_name(session.node, name)
    found: list[str] = []

    def is_there() -> bool:
        found[:] = dict(session.node.get_topic_names_and_types()).get(full, [])
        return bool(found)

    if not session.spin_until(is_there, _APPEAR_LIMIT_S):
        raise RosCommandError(f"No topic {full}. `jfto topic list` names those that are there.")
    return full, found


def full_name(node: Any, name: str, *, is_service: bool = False) -> str:
    """Full name of a topic or service; raises RosCommandError for one that cannot be."""
    try:
        expanded = expand_topic_name(name, node.get_name(), node.get_namespace())
        validate_full_topic_name(expanded, is_service=is_service)
    except (NameValidationException, ValueError) as error:
        raise RosCommandError(str(error)) from None
    return str(expanded)


def fitting_profile(publishers: list[Any], depth: int = _DEPTH) -> QoSProfile:
    """Profile of a subscription that fits all publishers of a topic, best effort without any."""
    profiles = [each.qos_profile for each in publishers]
    reliable = {each.reliability for each in profiles} == {ReliabilityPolicy.RELIABLE}
    latched = {each.durability for each in profiles} == {DurabilityPolicy.TRANSIENT_LOCAL}
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def wished(
    profile: QoSProfile,
    *,
    qos_depth: int | None = None,
    qos_reliability: str | None = None,
    qos_durability: str | None = None,
) -> QoSProfile:
    """A profile with what the user asked for by name put in, None where nothing."""
    if qos_depth is not None:
        profile.depth = qos_depth
    if qos_reliability is not None:
        profile.reliability = ReliabilityPolicy[qos_reliability.upper()]
    if qos_durability is not None:
        profile.durability = DurabilityPolicy[qos_durability.upper()]
    return profile
