"""What names are legal, with the words and positions that rcl and rmw report."""

from __future__ import annotations

import re
from typing import NamedTuple

MAX_NODE_NAME = 255
MAX_TOPIC_NAME = 255 - 8
_WORD = re.compile(r"\w", re.ASCII)
_SUBSTITUTIONS = ("node", "ns", "namespace")


class Problem(NamedTuple):
    """What is wrong with a name, and where."""

    text: str
    position: int


def node_name_problem(name: str) -> Problem | None:
    """Check a node name."""
    if not name:
        return Problem("node name must not be empty", 0)
    for index, character in enumerate(name):
        if not _WORD.match(character):
            text = "node name must not contain characters other than alphanumerics or '_'"
            return Problem(text, index)
    if name[0].isdigit():
        return Problem("node name must not start with a number", 0)
    if len(name) > MAX_NODE_NAME:
        text = f"node name length should not exceed '{MAX_NODE_NAME}'"
        return Problem(text, MAX_NODE_NAME - 1)
    return None


def _absolute_problem(name: str) -> tuple[str, int] | None:  # noqa: PLR0911 - one per rule
    if not name:
        return "empty", 0
    if name[0] != "/":
        return "relative", 0
    if name[-1] == "/" and len(name) > 1:
        return "trailing", len(name) - 1
    for index, character in enumerate(name):
        if character != "/" and not _WORD.match(character):
            return "character", index
    for index in range(1, len(name)):
        if name[index - 1] == "/" and name[index] == "/":
            return "repeated", index
        if name[index - 1] == "/" and name[index].isdigit():
            return "number", index
    if len(name) > MAX_TOPIC_NAME:
        return "length", MAX_TOPIC_NAME - 1
    return None


_FULL_TOPIC = {
    "empty": "topic name must not be empty",
    "relative": "topic name must be absolute, it must lead with a '/'",
    "trailing": "topic name must not end with a '/'",
    "character": "topic name must not contain characters other than alphanumerics, '_', or '/'",
    "repeated": "topic name must not contain repeated '/'",
    "number": "topic name must not have a token that starts with a number",
    "length": "topic length should not exceed '255U - 8U'",
}
_NAMESPACE = {
    "empty": "namespace must not be empty",
    "relative": "namespace must be absolute, it must lead with a '/'",
    "trailing": "namespace must not end with a '/', unless only a '/'",
    "character": "namespace must not contain characters other than alphanumerics, '_', or '/'",
    "repeated": "namespace must not contain repeated '/'",
    "number": "namespace must not have a token that starts with a number",
    "length": "namespace should not exceed '245'",
}


def full_topic_problem(name: str) -> Problem | None:
    """Check a fully qualified topic or service name."""
    found = _absolute_problem(name)
    return None if found is None else Problem(_FULL_TOPIC[found[0]], found[1])


def namespace_problem(name: str) -> Problem | None:
    """Check an absolute namespace."""
    if name == "/":
        return None
    found = _absolute_problem(name)
    return None if found is None else Problem(_NAMESPACE[found[0]], found[1])


def topic_problem(name: str) -> Problem | None:  # noqa: PLR0911, PLR0912 - one per rule
    """Check a topic or service name as programs write it, with ``~`` and ``{node}``."""
    if not name:
        return Problem("topic name must not be empty string", 0)
    if name[-1] == "/":
        return Problem("topic name must not end with a forward slash", len(name) - 1)
    opened = -1
    for index, character in enumerate(name):
        if character == "~":
            if index:
                text = "topic name must not have tilde '~' unless it is the first character"
                return Problem(text, index)
        elif character == "{":
            if opened >= 0:
                return Problem("substitution name must not contain '{'", index)
            opened = index
        elif character == "}":
            if opened < 0:
                return Problem("topic name must not have unbalanced curly braces '{}'", index)
            opened = -1
        elif character != "/" and not _WORD.match(character):
            text = (
                "topic name must not contain characters other than alphanumerics, '_', '~', "
                "'{', or '}'"
            )
            return Problem(text, index)
    if opened >= 0:
        return Problem("topic name must not have unbalanced curly braces '{}'", opened)
    if len(name) > 1 and name[0] == "~" and name[1] != "/":
        text = "topic name must not have tilde '~' followed by anything but a forward slash"
        return Problem(text, 1)
    for index, character in enumerate(name):
        if character.isdigit() and (index == 0 or name[index - 1] == "/"):
            return Problem("topic name token must not start with a number", index)
    return None


def unknown_substitution(name: str) -> str | None:
    """Find a ``{...}`` that nobody can fill in."""
    for inner in re.findall(r"\{(\w*)\}", name):
        if inner not in _SUBSTITUTIONS:
            return f"{{{inner}}}"
    return None
