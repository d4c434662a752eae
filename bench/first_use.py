"""What a computer that has never compiled pays for its first use, in CPU seconds.

    python bench/first_use.py [--most 25]

Runs `jfto doctor --compile` and `jfto plan config/small.yaml`, each with an empty cache of compiled
code and once more with a full one, and lists which functions take longest to compile, without what
they call.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter
from typing import Any

from numba.core import event

from jfto.compile_kernels import compile_kernels

COMMANDS = {
    "doctor": ["doctor"],
    "doctor --compile": ["doctor", "--compile"],
    "plan config/small.yaml": ["plan", "config/small.yaml", "-o", os.devnull],
}


class CompileTimes(event.Listener):
    """CPU seconds per function, its callees' left out, and how often each was compiled."""

    def __init__(self) -> None:
        self.spent_s: Counter[str] = Counter()
        self.times: Counter[str] = Counter()
        self._open: list[list[float]] = []

    def on_start(self, event: Any) -> None:  # noqa: ARG002  the listener is called so
        """A function's compilation begins, perhaps within another's."""
        self._open.append([time.process_time(), 0.0])

    def on_end(self, event: Any) -> None:
        """It has ended."""
        begin, inner = self._open.pop()
        spent = time.process_time() - begin
        if self._open:
            self._open[-1][1] += spent
        function = event.data["dispatcher"].py_func
        name = f"{function.__module__}.{function.__qualname__}"
        name = name if name.startswith("jfto") else "numba's own"
        self.spent_s[name] += spent - inner
        self.times[name] += 1


def cpu_and_wall_s(words: list[str], cache: str) -> tuple[float, float]:
    """CPU and wall seconds of a command with a cache of compiled code."""
    begin, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-m", "jfto", *words],
        env=os.environ | {"NUMBA_CACHE_DIR": cache},
        check=True,
        capture_output=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu, time.perf_counter() - begin


def list_functions(most: int) -> None:
    """Compile everything here and print what took longest."""
    times = CompileTimes()
    event.register("numba:compile", times)
    count = compile_kernels(lambda _part: None)
    total = sum(times.spent_s.values())
    print(f"\n{count} kernels, {sum(times.times.values())} functions, {total:.1f} s")
    for name, spent in times.spent_s.most_common(most):
        print(f"{spent:6.2f} s  {times.times[name]:3d} ×  {name}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--most", type=int, default=25, help="functions to list")
    parser.add_argument("--list", action="store_true", help="only list, with this cache")
    chosen = parser.parse_args()
    if chosen.list:
        list_functions(chosen.most)
        return
    for name, words in COMMANDS.items():
        with tempfile.TemporaryDirectory() as cache:
            first, again = cpu_and_wall_s(words, cache), cpu_and_wall_s(words, cache)
        print(
            f"{name:<24} first {first[0]:5.1f} s of CPU, {first[1]:5.1f} s; "
            f"again {again[0]:4.1f} s of CPU, {again[1]:4.1f} s"
        )
    with tempfile.TemporaryDirectory() as cache:
        command = [sys.executable, __file__, "--list", "--most", str(chosen.most)]
        subprocess.run(command, env=os.environ | {"NUMBA_CACHE_DIR": cache}, check=True)


if __name__ == "__main__":
    main()
