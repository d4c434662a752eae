"""Names on the graph: topics, services and nodes, hidden ones apart."""

from __future__ import annotations

from collections import Counter
from typing import Any

import click

from jfto.ros_cli.errors import RosCommandError
from jfto.ros_cli.interfaces import message_class

NamesAndTypes = list[tuple[str, list[str]]]


def topics(node: Any, *, hidden: bool = False) -> NamesAndTypes:
    """Topics and their types, sorted by name."""
    return _shown(node.get_topic_names_and_types(), hidden=hidden)


def services(node: Any, *, hidden: bool = False) -> NamesAndTypes:
    """Services and their types, sorted by name."""
    return _shown(node.get_service_names_and_types(), hidden=hidden)


def _shown(found: NamesAndTypes, *, hidden: bool) -> NamesAndTypes:
    from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

    return sorted(entry for entry in found if hidden or not topic_or_service_is_hidden(entry[0]))


def nodes(node: Any, *, hidden: bool = False) -> list[str]:
    """Full names of all nodes, sorted; one that is there twice is named twice."""
    return sorted(
        f"{namespace.rstrip('/')}/{name}"
        for name, namespace in node.get_node_names_and_namespaces()
        if hidden or not name.startswith("_")
    )


def split_node_name(full_name: str) -> tuple[str, str]:
    """Name and namespace of a full name."""
    namespace, _, name = full_name.rpartition("/")
    return name, namespace or "/"


def absolute(name: str) -> str:
    """A name with its leading slash."""
    return name if name.startswith("/") else f"/{name}"


def warn_of_twins(names: list[str]) -> None:
    """Say on stderr that nodes share a name, where they do."""
    if any(count > 1 for count in Counter(names).values()):
        click.echo(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, which "
            "can have unintended side effects.",
            err=True,
        )


def type_of_topic(node: Any, topic: str) -> Any | None:
    """Class of the messages of a topic; None, said on stdout, where nothing is known of it."""
    types = dict(node.get_topic_names_and_types()).get(resolved(node, topic))
    if types is None:
        click.echo(f"WARNING: topic [{topic}] does not appear to be published yet")
        return None
    if len(types) > 1:
        raise RosCommandError(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]"
        )
    return message_class(types[0])


def resolved(node: Any, name: str, *, is_service: bool = False) -> str:
    """Full name of a topic or service; raises RosCommandError for one that cannot be."""
    from rclpy.exceptions import NameValidationException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        expanded = expand_topic_name(name, node.get_name(), node.get_namespace())
        validate_full_topic_name(expanded, is_service=is_service)
    except (NameValidationException, ValueError) as error:
        raise RosCommandError(str(error)) from None
    return str(expanded)
