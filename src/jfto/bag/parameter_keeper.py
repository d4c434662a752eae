"""Keeps the parameters of all nodes beside a bag, so that it can be replayed as it was flown."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import yaml

from jfto.bag.recorder import PARAMETERS_NAME
from jfto.ros_cli import graph_names
from jfto.ros_cli.session import Session
from jfto_msgs_py.files import write_file

_NOT_SET = 0


class ParameterKeeper:
    """Asks each node once, as soon as it answers, and writes what it said."""

    def __init__(self, session: Session, path: Path) -> None:
        self._session = session
        self._file = path / PARAMETERS_NAME
        self._waiting: dict[str, Any] = {}
        self._asked: set[str] = set()
        self._trees: dict[str, Any] = {}

    def look(self) -> None:
        """Ask nodes that have appeared; their answers come while the session spins."""
        from rclpy.parameter_client import AsyncParameterClient

        node = self._session.node
        offered = dict(graph_names.services(node, hidden=True))
        for name in graph_names.nodes(node):
            known = name in self._asked or name in self._waiting
            if not known and f"{name}/list_parameters" in offered:
                self._waiting[name] = AsyncParameterClient(node, name)
        for name, client in tuple(self._waiting.items()):
            if client.services_are_ready():
                del self._waiting[name]
                self._asked.add(name)
                client.list_parameters(callback=partial(self._listed, name, client))

    def _listed(self, name: str, client: Any, future: Any) -> None:
        names = sorted(future.result().result.names)
        client.get_parameter_types(names, callback=partial(self._typed, name, client, names))

    def _typed(self, name: str, client: Any, names: list[str], future: Any) -> None:
        # Asked for one that has no value, a node answers with no values at all.
        types = zip(names, future.result().types, strict=True)
        chosen = [each for each, kind in types if kind != _NOT_SET]
        client.get_parameters(chosen, callback=partial(self._got, name, chosen))

    def _got(self, name: str, names: list[str], future: Any) -> None:
        from rclpy.parameter import parameter_value_to_python

        values = future.result().values
        if len(values) != len(names):
            self._session.node.get_logger().warning(f"{name} does not tell its parameters.")
            return
        tree: dict[str, Any] = {}
        for each, value in zip(names, values, strict=True):
            plain = parameter_value_to_python(value)
            # A parameter file cannot say of what type an empty list is.
            if plain is not None and plain != []:
                tree[each] = plain
        self._trees[name] = {"ros__parameters": tree}
        write_file(self._file, yaml.safe_dump(self._trees))
