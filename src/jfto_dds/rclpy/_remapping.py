"""Remap rules: ``[node:]match:=replacement``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

_NAME = r"[A-Za-z_]\w*"
_TOPIC = re.compile(rf"(?:~/|/)?{_NAME}(?:/{_NAME})*")
_NODE_PREFIX = re.compile(rf"(?P<node>{_NAME}):(?!=)(?P<rest>.*)", re.DOTALL)


class RemapRuleError(ValueError):
    """A remap rule does not parse; ``warning`` is what rcl logs on top, or empty."""

    def __init__(self, reason: str, warning: str = "") -> None:
        super().__init__(reason)
        self.warning = warning


@dataclass(frozen=True)
class Rule:
    """One rule; ``kind`` is ``node``, ``namespace``, ``topic``, ``service`` or ``any``."""

    kind: str
    match: str
    replacement: str
    node: str = ""


def _name_rule(kind: str, match: str, replacement: str, node: str, text: str) -> Rule:
    if not _TOPIC.fullmatch(match):
        reason = f"Expected lexeme type (19) not found, search ended at index {len(match)}"
        raise RemapRuleError(reason)
    legal = _TOPIC.match(replacement)
    if legal is None or legal.end() != len(replacement):
        # rcl's lexer stops at the first character that belongs to no name.
        index = len(text) - len(replacement) + (legal.end() if legal else 0)
        reason = f"Expected lexeme type (19) not found, search ended at index {index}"
        raise RemapRuleError(reason)
    return Rule(kind, match, replacement, node)


def parse_rule(text: str) -> Rule:
    """Parse one rule; raises RemapRuleError."""
    node = ""
    rest = text
    prefix = _NODE_PREFIX.fullmatch(text)
    if prefix is not None and not prefix["rest"].startswith("//"):
        node, rest = prefix["node"], prefix["rest"]
    match, separator, replacement = rest.partition(":=")
    if not separator:
        reason = f"Expected lexeme type (19) not found, search ended at index {len(text)}"
        raise RemapRuleError(reason)
    if match in ("__node", "__name"):
        if not re.fullmatch(_NAME, replacement):
            reason = f"Node name not remapped to a valid name: '{replacement}'"
            raise RemapRuleError(reason)
        return Rule("node", match, replacement, node)
    if match == "__ns":
        if not re.fullmatch(rf"/|(?:/{_NAME})+", replacement):
            raise RemapRuleError(
                f"Expected lexeme type 19, got 18 at index {len(text) - len(replacement)}",
                f"Namespace not remapped to a fully qualified name (found: {replacement})",
            )
        return Rule("namespace", match, replacement, node)
    for scheme, kind in (("rostopic://", "topic"), ("rosservice://", "service")):
        if match.startswith(scheme):
            return _name_rule(kind, match.removeprefix(scheme), replacement, node, text)
    return _name_rule("any", match, replacement, node, text)


def remap_identity(rules: Sequence[Rule], kind: str, current: str, node_name: str) -> str:
    """Apply the first ``node`` or ``namespace`` rule that concerns a node."""
    for rule in rules:
        if rule.kind == kind and rule.node in ("", node_name):
            return rule.replacement
    return current


def expand(name: str, node_name: str, namespace: str) -> str:
    """Make a legal name absolute."""
    root = "" if namespace == "/" else namespace
    for token, meaning in (("{node}", node_name), ("{ns}", root), ("{namespace}", root)):
        name = name.replace(token, meaning)
    if name.startswith("~"):
        return f"{root}/{node_name}{name[1:]}"
    if name.startswith("/"):
        return name
    return f"{root}/{name}"


def remap_name(
    rules: Sequence[Rule], kind: str, expanded: str, node_name: str, namespace: str
) -> str:
    """Apply the first rule that matches an expanded topic or service name."""
    for rule in rules:
        if rule.kind not in (kind, "any") or rule.node not in ("", node_name):
            continue
        if expand(rule.match, node_name, namespace) == expanded:
            return expand(rule.replacement, node_name, namespace)
    return expanded
