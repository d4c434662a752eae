"""Scenario files: ROS 2 parameter YAML read into checked scenarios."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from jfto_msgs_py.errors import ScenarioError
from jfto_msgs_py.files import read_text
from jfto_msgs_py.scenario import KEYS, Given, Key, Scenario, make_scenario
from jfto_msgs_py.scenario.value import check_value, nearest

SHARED = "/**"
NODES = (
    "planner_node",
    "topology_node",
    "power_node",
    "radio_node",
    "pose_player",
    "mavlink_bridge",
    "simulated_fleet",
)
# Parameters of ROS itself, which a file may set beside ours.
ROS_KEYS = ("use_sim_time",)
# The elevation model that comes with the package, as terrain.source names it.
BUILT_IN_DEM = "jacksboro"
# What terrain.source says where nobody knows the ground: such a scenario is flown, never planned.
UNKNOWN_TERRAIN = "unknown"
# The scenario's name in the directory of a run, beside its plan.
SCENARIO_NAME = "scenario.yaml"
_SIZE_LIMIT = 1_000_000
_DEPTH_LIMIT = 8


class _Loader(yaml.SafeLoader):
    """Reads numbers as ROS does: 83.5e6 is a number although YAML 1.1 wants 83.5e+6."""


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$"),
    list("-+.0123456789"),
)


def names_a_file(source: str) -> bool:
    """Whether terrain.source is the name of a file."""
    return source not in {BUILT_IN_DEM, UNKNOWN_TERRAIN}


@dataclass(frozen=True)
class LoadedScenario:
    """A scenario and the file that it came from, against which its paths are resolved.

    `node_options` holds what the file's sections for nodes say about those nodes alone.
    """

    scenario: Scenario
    path: Path
    node_options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def resolve(self, name: str) -> Path:
        """Path of a file that the scenario names: beside the scenario, else as it stands."""
        beside = self.path.parent / name
        return beside if beside.exists() or Path(name).is_absolute() else Path(name)


def load_scenario(
    path: str | Path, overrides: Sequence[str] = (), said_in: str = "--set"
) -> LoadedScenario:
    """Scenario from a file, with `key=value` overrides on top.

    Raises ScenarioError that lists every problem in the file and the overrides, which `said_in`
    names.
    """
    path = Path(path)
    problems: list[str] = []
    node_options: dict[str, dict[str, Any]] = {}
    layers = _read_layers(path, problems, node_options)
    layers.append(read_overrides(overrides, node_options, problems, said_in))
    try:
        scenario = make_scenario(layers)
    except ScenarioError as error:
        raise ScenarioError([*problems, *error.problems]) from None
    if problems:
        raise ScenarioError(problems)
    return LoadedScenario(scenario, path, node_options)


def _read_layers(
    path: Path, problems: list[str], node_options: dict[str, dict[str, Any]]
) -> list[dict[str, Given]]:
    """Shared values, then each node's, as layers of dotted keys; nodes' own go to the side."""
    shared: dict[str, Given] = {}
    per_node: dict[str, Given] = {}
    for name, section, where in _sections(path):
        problem = _unknown_section(name)
        if problem:
            problems.append(f"{where}: {problem}")
            continue
        parameters = _parameters(name, section, where, problems)
        if parameters is None:
            continue
        if name == SHARED:
            _flatten(path, parameters, "", shared, problems, 0)
            continue
        mine: dict[str, Given] = {}
        _flatten(path, parameters, "", mine, problems, 0)
        own = _take_options(name.lstrip("/"), mine, problems)
        node_options.setdefault(name.lstrip("/"), {}).update(own)
        _merge_node(per_node, mine, name, problems)
    return [shared, per_node]


def load_node_parameters(path: Path, node: str) -> dict[str, Given]:
    """What a parameter file has for one node: values that all share, below them the node's own.

    Sections of other nodes are passed over, whosever they are. Raises ScenarioError that lists
    every problem.
    """
    problems: list[str] = []
    shared: dict[str, Given] = {}
    own: dict[str, Given] = {}
    for name, section, where in _sections(path):
        if name == SHARED or name.lstrip("/") == node:
            parameters = _parameters(name, section, where, problems)
            if parameters is not None:
                _flatten(path, parameters, "", shared if name == SHARED else own, problems, 0)
    if problems:
        raise ScenarioError(problems)
    return shared | own


def _sections(path: Path) -> list[tuple[str, yaml.Node, str]]:
    """Name, content and place of each section of a parameter file."""
    root = _compose(path, read_text(path, ScenarioError, "scenario", _SIZE_LIMIT))
    if not isinstance(root, yaml.MappingNode):
        raise ScenarioError(
            f"{path}: holds no parameters. Start it with '/**:', 'ros__parameters:' below it, and "
            "the keys below that."
        )
    return [
        (str(name.value), section, f"{path}:{name.start_mark.line + 1}")
        for name, section in root.value
    ]


def _compose(path: Path, text: str) -> yaml.Node | None:
    try:
        for event in yaml.parse(text, Loader=_Loader):
            if isinstance(event, yaml.AliasEvent):
                raise ScenarioError(
                    f"{path}: refers to *{event.anchor}, but ROS parameter files allow no aliases. "
                    "Write the value out."
                )
        return yaml.compose(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f"{path}:{mark.line + 1}" if mark is not None else str(path)
        raise ScenarioError(
            f"{where}: is not valid YAML: {error.problem}. Check the indentation, colons and "
            "brackets of this line and the one above."
        ) from None
    except yaml.YAMLError as error:
        raise ScenarioError(
            f"{path}: is not valid YAML: {error}. Save it as plain UTF-8 text."
        ) from None


def _unknown_section(name: str) -> str:
    """What is wrong with a section's name, "" if nothing is."""
    if name == SHARED or name.lstrip("/") in NODES:
        return ""
    guess = nearest(name.lstrip("/"), NODES)
    cure = f"Did you mean {guess}?" if guess else f"Use '{SHARED}' for values that all share."
    if nearest(name, {key.split(".")[0] for key in KEYS}):
        cure = f"Put it below '{SHARED}:' and 'ros__parameters:'."
    return f"unknown section {name}. {cure}"


def _parameters(
    name: str, section: yaml.Node, where: str, problems: list[str]
) -> yaml.MappingNode | None:
    """The mapping below `ros__parameters` of one section; None, with a problem, if amiss."""
    if isinstance(section, yaml.MappingNode):
        for key_node, value_node in section.value:
            if key_node.value == "ros__parameters" and isinstance(value_node, yaml.MappingNode):
                return value_node
    problems.append(
        f"{where}: section {name} has no 'ros__parameters:' with keys below it. Add that line and "
        "indent the keys."
    )
    return None


def _flatten(
    path: Path,
    node: yaml.MappingNode,
    prefix: str,
    into: dict[str, Given],
    problems: list[str],
    depth: int,
) -> None:
    """Add the values below a mapping to `into` by their dotted names."""
    for key_node, value_node in node.value:
        where = f"{path}:{key_node.start_mark.line + 1}"
        if not isinstance(key_node, yaml.ScalarNode):
            problems.append(f"{where}: a key is a list or a map. Write its name.")
            continue
        name = f"{prefix}{key_node.value}"
        if name in ROS_KEYS:
            continue
        if isinstance(value_node, yaml.MappingNode):
            if depth >= _DEPTH_LIMIT:
                problems.append(f"{where}: {name} is nested too deep. Keys are part.name.")
            else:
                _flatten(path, value_node, f"{name}.", into, problems, depth + 1)
            continue
        if name in into:
            first = into[name].origin.rsplit(":", 1)[-1]
            problems.append(f"{where}: {name} was already given on line {first}. Remove one.")
            continue
        into[name] = Given(_construct(value_node), where)


def _construct(node: yaml.Node) -> Any:
    """Plain value of a scalar or list node."""
    loader = _Loader("")
    try:
        return loader.construct_object(node, deep=True)
    except (yaml.YAMLError, ValueError):
        # A tag or date that YAML cannot make sense of is text to us, and judged as such.
        return str(node.value)
    finally:
        loader.dispose()


def _take_options(node: str, mine: dict[str, Given], problems: list[str]) -> dict[str, Any]:
    """Take a node's own parameters out of its section, checked."""
    # Loaded here, since few files have such sections.
    from jfto.node_options import NODE_OPTIONS

    keys, taken = NODE_OPTIONS[node], {}
    for name in [name for name in mine if name in keys]:
        taken[name], found = check_value(keys[name], mine.pop(name))
        problems += found
    return taken


def _merge_node(
    per_node: dict[str, Given], mine: dict[str, Given], name: str, problems: list[str]
) -> None:
    """Join a node's values to those of other nodes, which must agree."""
    for key, item in mine.items():
        other = per_node.setdefault(key, item)
        if other.value != item.value:
            problems.append(
                f"{item.origin}: {key} is {item.value!r} for {name}, but {other.value!r} at "
                f"{other.origin}. Nodes must agree: put it below '{SHARED}'."
            )


def read_overrides(
    overrides: Sequence[str],
    node_options: dict[str, dict[str, Any]],
    problems: list[str],
    said_in: str = "--set",
) -> dict[str, Given]:
    """Values of `key=value` texts by dotted key; what is wrong with them is added to `problems`.

    A node's own parameter is `node.key`; those go to `node_options`.
    """
    layer: dict[str, Given] = {}
    for text in overrides:
        name, equals, raw = text.partition("=")
        name = name.strip()
        if not equals or not name:
            problems.append(
                f"{said_in} {text}: is not key=value. Write --set radio.noise_dbm=-105."
            )
            continue
        key = _key_named(name)
        if key is not None and key.array and not raw.strip().startswith("["):
            raw = f"[{raw}]"
        if key is not None and not key.array and key.kind == "text":
            layer[name] = Given(raw, said_in)
            continue
        try:
            node = yaml.compose(raw, Loader=_Loader)
        except yaml.YAMLError:
            problems.append(
                f"{said_in} {text}: cannot read the value. Quote it or mend the brackets."
            )
            continue
        layer[name] = Given("" if node is None else _construct(node), said_in)
    for name in {name.partition(".")[0] for name in layer} & set(NODES):
        mine = {
            key[len(name) + 1 :]: layer.pop(key) for key in [*layer] if key.startswith(f"{name}.")
        }
        node_options.setdefault(name, {}).update(_take_options(name, mine, problems))
        problems += [f"{said_in} {name}.{key}: {name} has no such parameter." for key in mine]
    return layer


def _key_named(name: str) -> Key | None:
    """Key of a scenario, or of a node as `node.key`; None where there is none."""
    node, _, own = name.partition(".")
    if node not in NODES:
        return KEYS.get(name)
    from jfto.node_options import NODE_OPTIONS

    return NODE_OPTIONS[node].get(own)
