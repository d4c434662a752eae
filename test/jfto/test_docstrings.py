"""What public names say of themselves: every argument, what comes back and what is raised."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import inspect
import re
import textwrap
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src"
# What is documented for people who bring arrays; records of all other packages say it in prose.
FACE = ("jfto", "jfto_planner", "jfto_topology", "jfto_power")
PACKAGES = sorted(
    ".".join(file.parent.relative_to(SOURCE).parts)
    for file in SOURCE.rglob("__init__.py")
    if "\n__all__ = " in file.read_text(encoding="utf-8")
)
# A heading, the rule below it, and what stands there until the next heading.
_SECTION = re.compile(
    r"^(\w[\w ]*)\n-{3,}\n(.*?)(?=^\w[\w ]*\n-{3,}\n|\Z)", re.MULTILINE | re.DOTALL
)


def _public(kind, packages):
    found = {}
    for package in map(importlib.import_module, packages):
        for name in package.__all__:
            value = getattr(package, name)
            if kind(value):
                found[f"{value.__module__}.{name}"] = value
    return [pytest.param(value, id=name) for name, value in found.items()]


def _sections(function) -> dict[str, dict[str, str]]:
    """Entries of each section by their first line, with what is said of them."""
    found = {}
    for heading, text in _SECTION.findall(inspect.getdoc(function) + "\n"):
        entries = re.split(r"^(?=\S)", text, flags=re.MULTILINE)
        parts = (entry.partition("\n") for entry in entries if entry.strip())
        found[heading] = {first: rest.strip() for first, _, rest in parts}
    return found


def _raised(function) -> set[str]:
    """Names of the errors that stand in raise statements of the function itself."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    calls = (node.exc for node in ast.walk(tree) if isinstance(node, ast.Raise))
    names = (call.func for call in calls if isinstance(call, ast.Call))
    return {name.id for name in names if isinstance(name, ast.Name)}


@pytest.mark.parametrize("function", _public(inspect.isfunction, PACKAGES))
def test_functions_have_numpydoc_sections(function):
    """All arguments in their order, what comes back, errors: each with a word on it, no prose."""
    sections = _sections(function)
    arguments = [
        name.strip() for line in sections.get("Parameters", {}) for name in line.split(",")
    ]
    assert arguments == list(inspect.signature(function).parameters)
    assert all(sections.get("Parameters", {}).values()), "an argument of which nothing is said"
    assert inspect.signature(function).return_annotation in {"None", "NoReturn"} or all(
        sections["Returns"].values()
    )
    assert _raised(function) <= set(sections.get("Raises", {}))
    assert all(sections.get("Raises", {}).values()), "an error of which nothing is said"
    assert not re.search(r"\bRaises \w*Error\b", inspect.getdoc(function))


@pytest.mark.parametrize("record", _public(dataclasses.is_dataclass, FACE))
def test_records_describe_their_fields(record):
    """Each field is named in the docstring."""
    text = inspect.getdoc(record)
    missing = [each.name for each in dataclasses.fields(record) if each.name not in text]
    assert missing == []


@pytest.mark.parametrize("value", _public(inspect.isclass, PACKAGES))
def test_classes_say_what_they_are(value):
    """A class of its own, not what it inherits, has the docstring."""
    assert value.__doc__
    assert not value.__doc__.startswith(f"{value.__name__}(")
