# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Compilation of loops, kept in a folder so that only the first start pays for it."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, ParamSpec, Protocol, TypeVar, cast

import numpy as np
from numba import config, njit
from numba.core import event
from numba.core.caching import FunctionCache

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.first_start import COMPILATION, loop_folder

Given = ParamSpec('Given')
Result = TypeVar('Result')
Returned = TypeVar('Returned', covariant=True)

# Nothing calls these functions from C, so that wrapper is not compiled.
NUMBA_OPTIONS = {'error_model': 'numpy', 'no_cfunc_wrapper': True}

COMPILATION.folder = FOLDER = loop_folder()


class Compiled(Protocol[Returned]):
    """Compiled function with positional arguments, real or complex arrays.

    Annotations of the function name the real types only.
    """

    __name__: str

    def __call__(self, *given: object) -> Returned:
        """Call the function."""
        ...


def compiled(function: Callable[Given, Result]) -> Compiled[Result]:
    """Compile a function."""
    return _compiled(function)


def njit_device(function: Callable[Given, Result]) -> Compiled[Result]:
    """Compile a function that is called by compiled ones only.

    It gets no wrapper for Python, which would take a fifth of its compilation.
    """
    return _compiled(function, no_cpython_wrapper=True)


def inlined(function: Callable[Given, Result]) -> Compiled[Result]:
    """Inline a function into its compiled callers, before those are compiled.

    Compiled alone, its machine code would be optimised once by itself and again in each caller.
    """
    return _compiled(function, inline='always')


def njit_fastmath(function: Callable[Given, Result]) -> Compiled[Result]:
    """Compile sums of products, whose operations may be fused and reordered."""
    return _compiled(function, fastmath={'contract', 'reassoc', 'nsz'})


def _compiled(function: Callable[Given, Result], **options: object) -> Compiled[Result]:
    # numba's types lack some of the options.
    loop: Any = njit(**NUMBA_OPTIONS, **options)(function)  # type: ignore[call-overload]
    if FOLDER.path is not None:
        settings: Any = config
        before, settings.CACHE_DIR = settings.CACHE_DIR, str(FOLDER.path)
        # If the folder has vanished since it was chosen, the loop is compiled at each start.
        with suppress(RuntimeError):
            loop._cache = _LoopCache(function)
        # Other packages keep their own cache folder.
        settings.CACHE_DIR = before
    return cast(Compiled[Result], loop)


class _LoopCache(FunctionCache):
    """Cache that raises no errors: damaged files are compiled again, a full disk is ignored."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        # A truncated file may raise anything.
        except Exception:
            with suppress(OSError):
                self.flush()
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(OSError):
            super().save_overload(sig, data)


class _Steps(event.Listener):
    """Listener to passes of the compiler and to finished loops."""

    def on_start(self, step: Any) -> None:
        if step.kind == 'numba:compile':
            COMPILATION.begin()
        COMPILATION.step()

    def on_end(self, step: Any) -> None:
        if step.kind == 'numba:compile':
            COMPILATION.end()


for _kind in ('numba:compile', 'numba:run_pass'):
    event.register(_kind, _Steps())


def promote_dtypes(*arrays: FloatArray) -> list[FloatArray]:
    """Return arrays of one kind, all real or all complex, for compiled loops."""
    return as_kind(complex if stepped_among(*arrays) else float, *arrays)


def stepped_among(*arrays: FloatArray) -> bool:
    """Return True if one of the arrays is complex."""
    return 'c' in [array.dtype.kind for array in arrays]


def as_kind(kind: type[float] | type[complex], *arrays: FloatArray) -> list[FloatArray]:
    """Return arrays of the given kind for compiled loops."""
    rows = []
    for array in arrays:
        row = np.ascontiguousarray(array, kind)
        # A read-only array has another type, for which numba would compile the loop again.
        rows.append(row if row.flags.writeable else row.copy())
    return rows
