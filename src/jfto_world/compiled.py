"""Compile numeric kernels, and keep them compiled between runs until what they are made of changes.

A kernel is what Python calls; an inner function is what kernels call. Only kernels get the wrapper
that takes arguments from Python and a place on disk: for inner functions both cost more than the
function itself. Neither allocates: results and room to work in are arrays that the caller hands in.
So they do without numba's counting of references, which the search would spend half of its time
on. A division by zero gives inf or nan, as in numpy.

numba renews a function of its cache when the function's own file changes, not when one that it
calls does. Here all that goes into a kernel counts: the files of the functions it reaches and the
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
# The files that say how functions are compiled.
_HOW = (__file__, str(Path(__file__).with_name("kernel_struct.py")))
_OPTIONS = {"nopython": True, "nogil": True, "error_model": "numpy", "_nrt": False}
_WITHOUT_WRAPPERS = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

# Every kernel of the modules that are imported, in the order in which they were defined.
kernels: list[Any] = []


class _Kernel(CPUDispatcher):
    """Compiled once for all numbers of a type, where numba would once more for each literal one."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        plain = {name: numba.types.unliteral(kind) for name, kind in dict(kws).items()}
        return super().get_call_template(tuple(map(numba.types.unliteral, args)), plain)


class _Inner(_Kernel):
    def __call__(self, *_args: Any, **_keywords: Any) -> Any:
        raise TypeError(
            f"{self.py_func.__name__} is compiled for kernels only; call its py_func, or make it "
            "a kernel."
        )


def kernel(function: Function) -> Any:
    """Compile a function that runs without the interpreter lock, and cache it on disk."""
    dispatcher = _Kernel(function, targetoptions={**_OPTIONS, "no_cfunc_wrapper": True})
    keep_compiled(dispatcher)
    kernels.append(dispatcher)
    return dispatcher


def inner(function: Function) -> Any:
    """Compile a function that only kernels and other inner functions can call."""
    return _Inner(function, targetoptions={**_OPTIONS, **_WITHOUT_WRAPPERS})


def inlined(function: Function) -> Any:
    """An inner function that becomes part of the one function that calls it.

    What calls many others is compiled sooner so: what a function calls is optimised once more with
    every function above it.
    """
    options = {**_OPTIONS, **_WITHOUT_WRAPPERS, "inline": "always"}
    return _Inner(function, targetoptions=options)


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
    parts = {*_parts(function, set()), *map(_file_digest, _HOW)}
    for part in sorted(parts):
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
