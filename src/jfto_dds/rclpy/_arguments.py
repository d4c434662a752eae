"""Command lines: ``--ros-args`` with remappings, parameters and log levels."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import _remapping
from ._logging_backend import SEVERITY_BY_NAME
from ._parameter_yaml import ParameterYamlError, parse_parameter_file, parse_parameter_value
from ._rclpy_pybind11 import RCLError, UnknownROSArgsError

_PARAMETER_RULE = re.compile(
    r"(?:(?P<node>[A-Za-z_]\w*):)?(?P<name>[A-Za-z_][\w./]*):=(?P<value>.*)", re.DOTALL
)
_FLAGS = {
    "--enable-rosout-logs": ("rosout", True),
    "--disable-rosout-logs": ("rosout", False),
    "--enable-stdout-logs": ("console", True),
    "--disable-stdout-logs": ("console", False),
    "--enable-external-lib-logs": ("external", True),
    "--disable-external-lib-logs": ("external", False),
}
_ALIASES = {"-r": "--remap", "-p": "--param", "-e": "--enclave"}
_WITH_VALUE = (
    "--remap",
    "--param",
    "--params-file",
    "--log-level",
    "--log-config-file",
    "--log-file-name",
    "--enclave",
)


@dataclass
class RosArguments:
    """What a command line asks of ROS.

    ``parameters`` maps node keys (``/**``, ``/uav1/n``) to values, both in order of first
    appearance, which is what decides precedence.
    """

    remappings: list[_remapping.Rule] = field(default_factory=list)
    parameters: dict[str, dict[str, Any]] = field(default_factory=dict)
    log_levels: dict[str, int] = field(default_factory=dict)
    enclave: str = "/"
    rosout: bool = True
    console: bool = True
    external: bool = True
    warnings: list[str] = field(default_factory=list)


def split_arguments(args: list[str]) -> tuple[list[str], list[str]]:
    """Split a command line into ROS arguments (without ``--ros-args``) and the rest."""
    ros: list[str] = []
    rest: list[str] = []
    inside = False
    for argument in args:
        if argument == "--ros-args":
            inside = True
        elif inside and argument == "--":
            inside = False
        else:
            (ros if inside else rest).append(argument)
    return ros, rest


def _fail(what: str, flag: str, value: str, reason: str) -> RCLError:
    return RCLError(
        f"failed to initialize rcl: Couldn't parse {what}: '{flag} {value}'. Error: {reason}"
    )


def _add_parameter(found: RosArguments, flag: str, text: str) -> None:
    what = "parameter override rule"
    rule = _PARAMETER_RULE.fullmatch(text)
    if rule is None:
        index = re.match(r"[\w./]*", text)
        at = index.end() if index else 0
        reason = f"Expected lexeme type (22) not found, search ended at index {at}"
        raise _fail(what, flag, text, reason)
    if rule["value"] == "":
        raise _fail(what, flag, text, "error not set")
    try:
        value = parse_parameter_value(rule["value"])
    except ParameterYamlError as error:
        raise _fail(what, flag, text, str(error)) from None
    key = f"/{rule['node']}" if rule["node"] else "/**"
    # An older value of the same name keeps its place, which nobody can see.
    found.parameters.setdefault(key, {})[rule["name"]] = value


def _add_file(found: RosArguments, flag: str, text: str) -> None:
    try:
        content = Path(text).read_text(encoding="utf-8")
    except OSError:
        raise _fail("params file", flag, text, "Error opening YAML file") from None
    try:
        parsed = parse_parameter_file(content)
    except ParameterYamlError as error:
        raise _fail("params file", flag, text, str(error)) from None
    for key, values in parsed.items():
        found.parameters.setdefault(key, {}).update(values)


def _add_remapping(found: RosArguments, flag: str, text: str) -> None:
    try:
        found.remappings.append(_remapping.parse_rule(text))
    except _remapping.RemapRuleError as error:
        if error.warning:
            found.warnings.append(error.warning)
        raise _fail("remap rule", flag, text, str(error)) from None


def _add_log_level(found: RosArguments, flag: str, text: str) -> None:
    name, separator, level = text.rpartition(":=")
    severity = SEVERITY_BY_NAME.get(level.lower())
    if severity is None or (separator and not name):
        reason = "Argument does not use a valid severity level"
        raise _fail("log level", flag, text, reason)
    found.log_levels[name] = severity


def _refuse(_found: RosArguments, flag: str, _text: str) -> None:
    msg = f"jfto_dds does not support {flag}: logging goes to the console and to /rosout only"
    raise NotImplementedError(msg)


def _set_enclave(found: RosArguments, _flag: str, text: str) -> None:
    found.enclave = text


_HANDLERS: dict[str, Callable[[RosArguments, str, str], None]] = {
    "--remap": _add_remapping,
    "--param": _add_parameter,
    "--params-file": _add_file,
    "--log-level": _add_log_level,
    "--log-config-file": _refuse,
    "--log-file-name": _refuse,
    "--enclave": _set_enclave,
}


def _legacy_rules(found: RosArguments, rest: list[str]) -> None:
    for argument in rest:
        if ":=" not in argument:
            continue
        try:
            rule = _remapping.parse_rule(argument)
        except _remapping.RemapRuleError:
            # Not a rule, so an argument of the program's own.
            continue
        found.remappings.append(rule)
        found.warnings.append(
            f"Found remap rule '{argument}'. This syntax is deprecated. "
            f"Use '--ros-args --remap {argument}' instead."
        )


def parse_arguments(args: list[str]) -> RosArguments:
    """Parse a command line.

    Raises
    ------
    UnknownROSArgsError
        Something behind ``--ros-args`` is not known.
    RCLError
        A rule, file or level does not parse; the text is rcl's.
    """
    ros, rest = split_arguments(args)
    found = RosArguments()
    unknown: list[str] = []
    position = 0
    while position < len(ros):
        flag = ros[position]
        position += 1
        long_flag = _ALIASES.get(flag, flag)
        if long_flag in _FLAGS:
            name, value = _FLAGS[long_flag]
            setattr(found, name, value)
        elif long_flag in _WITH_VALUE:
            if position == len(ros):
                msg = f"failed to initialize rcl: Couldn't parse trailing {flag} flag."
                raise RCLError(msg)
            _HANDLERS[long_flag](found, flag, ros[position])
            position += 1
        else:
            unknown.append(flag)
    if unknown:
        raise UnknownROSArgsError(str(unknown))
    _legacy_rules(found, rest)
    return found
