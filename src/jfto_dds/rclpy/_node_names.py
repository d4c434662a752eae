"""From the names that a program writes to topics and services."""

from __future__ import annotations

from typing import Any

from . import _remapping
from ._names import full_topic_problem, topic_problem, unknown_substitution
from ._rclpy_pybind11 import DESTROYED_TEXT, RCLError
from .exceptions import InvalidHandle
from .validate_full_topic_name import validate_full_topic_name
from .validate_topic_name import validate_topic_name


class NodeNames:
    """Name part of :class:`rclpy.node.Node`."""

    _context: Any
    _destroyed: bool
    _name: str
    _namespace: str
    _remap_rules: list[_remapping.Rule]

    def _check_alive(self, what: str) -> None:
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)
        if not self._context.ok():
            msg = f"Failed to create {what}: rcl node's context is invalid"
            raise RCLError(msg)

    def _resolve(self, name: str, *, is_service: bool = False, only_expand: bool = False) -> str:
        """Validate a name, expand it and apply the remap rules."""
        if name is None:
            msg = "failed to validate name: topic_name argument is null"
            raise RCLError(msg)
        validate_topic_name(name, is_service=is_service)
        unknown = unknown_substitution(name)
        if unknown is not None:
            msg = f"topic name '{name}' is invalid: unknown substitution: {unknown}"
            raise ValueError(msg)
        expanded = _remapping.expand(name, self._name, self._namespace)
        validate_full_topic_name(expanded, is_service=is_service)
        if only_expand:
            return expanded
        kind = "service" if is_service else "topic"
        return _remapping.remap_name(self._remap_rules, kind, expanded, self._name, self._namespace)

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Say which topic a name stands for."""
        return self._resolve_quietly(topic, is_service=False, only_expand=only_expand)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Say which service a name stands for."""
        return self._resolve_quietly(service, is_service=True, only_expand=only_expand)

    def _resolve_quietly(self, name: str, *, is_service: bool, only_expand: bool) -> str:
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)
        problem = topic_problem(name) or full_topic_problem(
            _remapping.expand(name, self._name, self._namespace)
        )
        if problem is not None:
            msg = f"failed to resolve name: {problem.text}"
            raise RCLError(msg)
        return self._resolve(name, is_service=is_service, only_expand=only_expand)
