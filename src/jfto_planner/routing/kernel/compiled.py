"""Compile the search's kernels, and keep them compiled between runs where the disk allows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

Function = Callable[..., Any]


def inner(function: Function) -> Any:
    """Compile a function that only other kernels call.

    Kernels allocate nothing; without numba's run-time they neither count references, which halves
    both compilation and run.
    """
    return numba.njit(nogil=True, error_model="numpy", _nrt=False)(function)  # type: ignore[call-overload]


def entry(function: Function) -> Any:
    """Compile a function that Python calls, without the interpreter lock, and cache it on disk.

    numba renews a cached function only when its own file changes, not when a kernel that it calls
    does; the stamp of all files in the entry's folder takes that place. Where nothing can be
    written, every process compiles for itself.
    """
    dispatcher = inner(function)
    try:
        dispatcher.enable_caching()
    except RuntimeError:  # numba's way to say that it found no writable folder
        return dispatcher
    dispatcher._cache._cache_file._source_stamp = _kernel_stamp(function)
    return dispatcher


def _kernel_stamp(function: Function) -> tuple[tuple[str, int, int], ...]:
    files = [Path(__file__), *sorted(Path(function.__code__.co_filename).parent.glob("*.py"))]
    return tuple((file.name, file.stat().st_mtime_ns, file.stat().st_size) for file in files)
