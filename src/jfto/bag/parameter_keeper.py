"""Keeps the parameters of all nodes beside a bag, so that it can be replayed as it was flown."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from jfto.bag.recorder import PARAMETERS_NAME
from jfto.ros_cli import graph
from jfto.ros_cli.parameters import Steps, read_all
from jfto_msgs_py.files import write_file


class ParameterKeeper:
    """Asks each node once, as soon as it answers, and writes what it said."""

    def __init__(self, node: Any, path: Path) -> None:
        self._node = node
        self._file = path / PARAMETERS_NAME
        # What each node is being asked, and what is waited for before the next question.
        self._asking: dict[str, tuple[Steps[dict[str, Any]], Callable[[], bool]]] = {}
        self._trees: dict[str, Any] = {}

    def look(self) -> None:
        """Begin to ask nodes that have appeared."""
        offered = dict(graph.services(self._node, hidden=True))
        for name in graph.nodes(self._node):
            known = name in self._asking or name in self._trees
            if not known and f"{name}/list_parameters" in offered:
                steps = read_all(self._node, name)
                self._asking[name] = (steps, next(steps))

    def go_on(self) -> int:
        """Take answers in that have come, and ask on; how many are being waited for."""
        for name, (steps, came) in tuple(self._asking.items()):
            try:
                if came():
                    self._asking[name] = (steps, next(steps))
            except StopIteration as end:
                del self._asking[name]
                self._keep(name, end.value)
        return len(self._asking)

    def _keep(self, name: str, values: dict[str, Any]) -> None:
        # A parameter file cannot say of what type an empty list is.
        kept = {each: value for each, value in values.items() if value != []}
        self._trees[name] = {"ros__parameters": kept}
        write_file(self._file, yaml.safe_dump(self._trees))
