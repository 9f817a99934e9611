"""Compilation of loops, cached beside the module so that only the first start pays for it."""

from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec, Protocol, TypeVar, cast

import numpy as np
from numba import njit

from trawl_ros.core.arrays import FloatArray

Given = ParamSpec('Given')
Result = TypeVar('Result')
Returned = TypeVar('Returned', covariant=True)

# Calls from C, which nobody makes, would take a wrapper more.
OPTIONS = {'cache': True, 'error_model': 'numpy', 'no_cfunc_wrapper': True}


class CompileStats(Protocol):
    """Statistics of numba: the folder of a function's cache."""

    cache_path: str


class Compiled(Protocol[Returned]):
    """Compiled function: it takes arrays by their place, real or complex, of which its
    annotations name the real ones.
    """

    __name__: str
    stats: CompileStats

    def __call__(self, *given: object) -> Returned:
        """Call it."""
        ...


def compiled(function: Callable[Given, Result]) -> Compiled[Result]:
    """Compile a function."""
    return _compiled(function)


def inner(function: Callable[Given, Result]) -> Compiled[Result]:
    """Compile a function that only compiled ones call: a wrapper for Python would take a fifth of
    its compilation.
    """
    return _compiled(function, no_cpython_wrapper=True)


def inlined(function: Callable[Given, Result]) -> Compiled[Result]:
    """Write a function into the compiled one that calls it, before that is compiled: done apart,
    its machine code would be optimised once by itself and again in each that calls it.
    """
    return _compiled(function, inline='always')


def fused(function: Callable[Given, Result]) -> Compiled[Result]:
    """Compile sums of products, which may be fused and taken in any order."""
    return _compiled(function, fastmath={'contract', 'reassoc', 'nsz'})


def _compiled(function: Callable[Given, Result], **options: object) -> Compiled[Result]:
    # numba's types lack some of the options.
    return cast(Compiled[Result], njit(**OPTIONS, **options)(function))  # type: ignore[call-overload]


def is_cached(function: Compiled[object]) -> bool:
    """True if a function was compiled on this machine before, as a rule by the first start."""
    folder = Path(function.stats.cache_path)
    return any(folder.glob(f'*.{function.__name__}-*.nbi'))


def alike(*arrays: FloatArray) -> list[FloatArray]:
    """Arrays of one kind, all real or all complex, as compiled loops take them."""
    return as_kind(complex if stepped_among(*arrays) else float, *arrays)


def stepped_among(*arrays: FloatArray) -> bool:
    """True if one of the arrays is complex."""
    return 'c' in [array.dtype.kind for array in arrays]


def as_kind(kind: type[float] | type[complex], *arrays: FloatArray) -> list[FloatArray]:
    """Arrays of the given kind, as compiled loops take them."""
    rows = []
    for array in arrays:
        row = np.ascontiguousarray(array, kind)
        # A loop would be compiled once more for an array that cannot be written to.
        rows.append(row if row.flags.writeable else row.copy())
    return rows
