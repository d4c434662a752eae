"""A node's own parameters, described like scenario keys, and read together with those."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, TypeVar

from jfto_msgs_py.errors import ScenarioError
from jfto_msgs_py.records.fields import Key, keys_of
from jfto_msgs_py.scenario.scenario import KEYS, Scenario
from jfto_msgs_py.scenario.validate import make_scenario
from jfto_msgs_py.scenario.value import Given, check_value

Options = TypeVar("Options")

# Parameters that rclpy itself declares, or that steer it.
_ROS_NAMES = ("use_sim_time", "start_type_description_service")
_ROS_PREFIXES = ("qos_overrides.",)


def option_keys(options_type: type) -> dict[str, Key]:
    """Keys of a node's own options, by name; `options_type` is a dataclass of `param` fields."""
    named = ((key.name.partition(".")[2], key) for key in keys_of(options_type, "own"))
    return {name: dataclasses.replace(key, name=name) for name, key in named}


def is_of_ros(name: str) -> bool:
    """Whether a parameter is none of ours: every node of ROS has such."""
    return name in _ROS_NAMES or name.startswith(_ROS_PREFIXES)


def resolve(values: Mapping[str, Given], options_type: type[Options]) -> tuple[Scenario, Options]:
    """Scenario and own options of a node from its parameters.

    A scenario key at its default counts as not given, as in a file: a node has them all. Raises
    ScenarioError that lists every problem.
    """
    keys = option_keys(options_type)
    layer: dict[str, Given] = {}
    own: dict[str, Any] = {}
    problems: list[str] = []
    for name, given in values.items():
        if name in keys:
            own[name], found = check_value(keys[name], given)
            problems += found
        elif not is_of_ros(name) and (name not in KEYS or not _is_default(KEYS[name], given.value)):
            layer[name] = given
    try:
        scenario = make_scenario([layer])
    except ScenarioError as error:
        raise ScenarioError([*problems, *error.problems]) from None
    if problems:
        raise ScenarioError(problems)
    return scenario, options_type(**own)


def _is_default(key: Key, value: Any) -> bool:
    return bool((tuple(value) if isinstance(value, list) else value) == key.default)
