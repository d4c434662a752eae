"""Compile numeric kernels, and keep them compiled between runs until what they are made of changes.

numba renews a function of its cache when the function's own file changes, not when a kernel that it
calls does. Here all that goes into a kernel counts: the files of the kernels it reaches and the
constants that it takes from other files.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType
from typing import Any

import numba
import numpy as np
from numba.core.registry import CPUDispatcher

Function = Callable[..., Any]
_CONSTANTS = (bool, int, float, complex, str, bytes, tuple, type(None), np.generic)


def kernel(function: Function) -> Any:
    """Compile a function, which then runs without the interpreter lock, and cache it on disk."""
    dispatcher = numba.njit(nogil=True)(function)
    keep_compiled(dispatcher)
    return dispatcher


def keep_compiled(dispatcher: Any) -> None:
    """Cache a compiled function on disk; where nothing can be written every process compiles."""
    try:
        dispatcher.enable_caching()
    except RuntimeError:  # numba's way to say that it found no writable folder
        return
    dispatcher._cache._cache_file._source_stamp = stamp_of(dispatcher.py_func)


def stamp_of(function: Function) -> str:
    """Digest of all that a kernel is made of: files of the kernels it reaches, their constants."""
    digest = hashlib.sha256()
    for part in sorted(set(_parts(function, set()))):
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()


def _parts(function: Function, seen: set[Function]) -> Iterator[str]:
    """What `function` and all kernels that it reaches are made of, as text."""
    if function in seen:
        return
    seen.add(function)
    yield _file_digest(function.__code__.co_filename)
    for name in sorted(_names(function.__code__)):
        value = function.__globals__.get(name)
        if isinstance(value, CPUDispatcher):
            yield from _parts(value.py_func, seen)
        elif isinstance(value, np.ndarray):
            yield f"{name} {value.dtype} {value.shape} {value.tobytes().hex()}"
        elif isinstance(value, _CONSTANTS):
            yield f"{name} {value!r}"


def _names(code: CodeType) -> set[str]:
    """Global names of a function and of the functions within it."""
    names = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            names |= _names(constant)
    return names


@cache
def _file_digest(path: str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()
