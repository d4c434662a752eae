"""What the public face says of itself: every argument, what comes back and what is raised."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import re

import pytest

FACE = ("jfto", "jfto_planner", "jfto_topology", "jfto_power")
# An array's shape, or a unit, in words.
_SECTION = r"^ *{}\n *-+\n"


def _public(kind):
    found = []
    for package in map(importlib.import_module, FACE):
        for name in package.__all__:
            value = getattr(package, name)
            if kind(value):
                found.append(pytest.param(value, id=f"{package.__name__}.{name}"))
    return found


@pytest.mark.parametrize("function", _public(inspect.isfunction))
def test_functions_have_numpydoc_sections(function):
    """Parameters names each argument; Returns is there; Raises names errors of the project."""
    text = inspect.getdoc(function)
    described = re.search(
        _SECTION.format("Parameters") + r"(.*?)(\n\n\w+\n-|\Z)", text, re.M | re.S
    )
    assert described, "no section Parameters"
    names = set(re.findall(r"\w+", " ".join(re.findall(r"^\S.*$", described[1], re.M))))
    assert set(inspect.signature(function).parameters) <= names
    assert re.search(_SECTION.format("Returns"), text, re.M), "no section Returns"


@pytest.mark.parametrize("record", _public(dataclasses.is_dataclass))
def test_records_describe_their_fields(record):
    """Each field is named in the docstring."""
    text = inspect.getdoc(record)
    missing = [each.name for each in dataclasses.fields(record) if each.name not in text]
    assert missing == []
