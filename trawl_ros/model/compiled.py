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

# Calls from C, which nobody makes, would take a wrapper more.
OPTIONS = {'error_model': 'numpy', 'no_cfunc_wrapper': True}

COMPILATION.folder = FOLDER = loop_folder()


class Compiled(Protocol[Returned]):
    """Compiled function: it takes arrays by their place, real or complex, of which its
    annotations name the real ones.
    """

    __name__: str

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
    loop: Any = njit(**OPTIONS, **options)(function)  # type: ignore[call-overload]
    if FOLDER.path is not None:
        settings: Any = config
        before, settings.CACHE_DIR = settings.CACHE_DIR, str(FOLDER.path)
        # Where the folder was lost since it was chosen, the loop is compiled at each start.
        with suppress(RuntimeError):
            loop._cache = _LoopCache(function)
        # Other packages keep theirs where they did.
        settings.CACHE_DIR = before
    return cast(Compiled[Result], loop)


class _LoopCache(FunctionCache):
    """Cache that fails nobody: what is damaged is compiled again, and a full disk keeps nothing."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        # Whatever a file that was cut short makes of its reading.
        except Exception:
            with suppress(OSError):
                self.flush()
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(OSError):
            super().save_overload(sig, data)


class _Steps(event.Listener):
    """Listener to passes of the compiler, and to loops that are done."""

    def on_start(self, step: Any) -> None:
        if step.kind == 'numba:compile':
            COMPILATION.begin()
        COMPILATION.step()

    def on_end(self, step: Any) -> None:
        if step.kind == 'numba:compile':
            COMPILATION.end()


for _kind in ('numba:compile', 'numba:run_pass'):
    event.register(_kind, _Steps())


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
