"""Rules of the compiler's cache."""

import subprocess
import sys
from pathlib import Path

import pytest

from jfto_world.compiled import inner, kernel, stamp_of

INNER = """\
from jfto_world.compiled import kernel

STEP = {step}


@kernel
def shift(x):
    return x + STEP {change}
"""
OUTER = """\
from inner import STEP, shift
from jfto_world.compiled import kernel


@kernel
def twice(x):
    return shift(shift(x))


@kernel
def step():
    return STEP


if __name__ == "__main__":
    found = twice(1), step()
    stats = twice.stats.cache_hits, step.stats.cache_hits
    print(found, [sum(hits.values()) for hits in stats])
"""


def _run(folder: Path, step: int = 1, change: str = "") -> str:
    (folder / "inner.py").write_text(INNER.format(step=step, change=change))
    (folder / "outer.py").write_text(OUTER)
    command = [sys.executable, "outer.py"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


@pytest.mark.slow
def test_a_kernel_that_calls_another_file_is_compiled_once(tmp_path):
    """A second process takes a kernel from the cache, also where it calls kernels elsewhere."""
    assert _run(tmp_path) == "(3, 1) [0, 0]\n"
    assert _run(tmp_path) == "(3, 1) [1, 1]\n"


@pytest.mark.slow
def test_a_change_in_a_called_file_compiles_anew(tmp_path):
    """Code and constants of another file are part of a kernel: it never runs with what was."""
    assert _run(tmp_path) == "(3, 1) [0, 0]\n"
    assert _run(tmp_path, change="* 2") == "(5, 1) [0, 1]\n"
    assert _run(tmp_path, step=2, change="* 2") == "(9, 2) [0, 0]\n"


def test_the_stamp_ignores_what_a_function_does_not_use():
    """The stamp counts the globals that are used, no others."""

    def uses() -> int:
        return len(OUTER)

    def does_not_use() -> int:
        return 1

    before = stamp_of(uses), stamp_of(does_not_use)
    saved = globals()["OUTER"]
    globals()["OUTER"] = "changed"
    try:
        after = stamp_of(uses), stamp_of(does_not_use)
    finally:
        globals()["OUTER"] = saved
    assert before[0] != after[0]
    assert before[1] == after[1]


def test_an_inner_function_says_that_python_cannot_call_it():
    """Without its wrapper a call from Python would end the process; it raises TypeError."""

    @inner
    def half(x):
        return x / 2

    @kernel
    def quarter(x):
        return half(half(x))

    assert quarter(2.0) == 0.5
    with pytest.raises(TypeError, match="half is compiled for kernels only"):
        half(2.0)
