"""Compiling before anything waits for it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "test/data/scenario/tiny.yaml"

USED = """\
import importlib
import sys
from pathlib import Path

from jfto.cli import main
from jfto.compile_kernels import compile_kernels
from jfto_world.compiled import kernels

source, scene, out = map(Path, sys.argv[1:])
for path in source.rglob("*.py"):
    if "\\n@kernel\\n" in path.read_text():
        importlib.import_module(".".join(path.relative_to(source).with_suffix("").parts))
compile_kernels(print)


def show(when):
    kinds = {f"{k.__module__}.{k.__name__}": len(k.signatures) for k in kernels}
    print(when, len(kinds), {name: count for name, count in kinds.items() if count != 1})


show("compiled")
for number, words in enumerate((
    ["--set", "trajectory.mode=guided"],
    ["--set", "trajectory.mode=straight", "--method", "rl+search"],
    [],
)):
    assert main(["plan", str(scene), *words, "-o", str(out / f"{number}.json")]) == 0
assert main(["evaluate", str(out / "2.json")]) == 0
show("used")
"""


def kernels_of(source: Path) -> list[str]:
    """Where kernels are defined in the source."""
    found = []
    for path in source.rglob("*.py"):
        found += [
            f"{path}:{name}" for name in re.findall(r"^@kernel\ndef (\w+)", path.read_text(), re.M)
        ]
    return found


@pytest.mark.slow
def test_every_kernel_is_compiled_once_and_for_the_arrays_that_it_is_used_with(tmp_path):
    """After `compile_kernels` each kernel of the source is compiled for one kind of arguments, and
    plans of every kind with their evaluation need no other.
    """
    command = [sys.executable, "-c", USED, str(ROOT / "src"), str(SCENE), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith(("compiled ", "used "))]
    assert done.returncode == 0, done.stderr[-2000:]
    count = len(kernels_of(ROOT / "src"))
    assert lines == [f"compiled {count} {{}}", f"used {count} {{}}"]
