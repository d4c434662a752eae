"""Compile the search's kernels, and keep them compiled between runs where the disk allows."""

from __future__ import annotations

from typing import Any

import numba

from jfto_world.compiled import Function, keep_compiled


def inner(function: Function) -> Any:
    """Compile a function that only other kernels call.

    Kernels allocate nothing; without numba's run-time they neither count references, which halves
    both compilation and run.
    """
    return numba.njit(nogil=True, error_model="numpy", _nrt=False)(function)  # type: ignore[call-overload]


def entry(function: Function) -> Any:
    """Compile a function that Python calls, without the interpreter lock, and cache it on disk."""
    dispatcher = inner(function)
    keep_compiled(dispatcher)
    return dispatcher
