"""The shape that all source keeps to, so that a person reads a file once and a call at a glance."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src"
MOST_PARAMETERS = 7
MOST_LINES = 350

Function = ast.FunctionDef | ast.AsyncFunctionDef


def files() -> list[Path]:
    """Every source file."""
    return sorted(SOURCE.rglob("*.py"))


def functions(path: Path) -> Iterator[tuple[str, Function]]:
    """Every function of a file, methods and inner ones too, as "package/file.py:name"."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, Function):
            yield f"{path.relative_to(SOURCE)}:{node.name}", node


def parameter_count(function: Function) -> int:
    """How many parameters a caller sees: neither self nor cls."""
    named = [*function.args.posonlyargs, *function.args.args]
    own = bool(named) and named[0].arg in {"self", "cls"}
    rest = [one for one in (function.args.vararg, function.args.kwarg) if one is not None]
    return len(named) - own + len(function.args.kwonlyargs) + len(rest)


def test_no_function_has_more_than_seven_parameters() -> None:
    """More are put into a frozen record, or the function does two things; kernels too."""
    found = {
        name: count
        for path in files()
        for name, function in functions(path)
        if (count := parameter_count(function)) > MOST_PARAMETERS
    }
    assert found == {}


def test_no_file_is_longer_than_can_be_read_once() -> None:
    """A longer one holds two ideas."""
    lengths = {path: len(path.read_text("utf-8").splitlines()) for path in files()}
    assert {path: count for path, count in lengths.items() if count > MOST_LINES} == {}
