# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""CPU time of the benchmark: clock, shares of functions, and bytecode of child processes."""

import cProfile
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from statistics import median
from types import CodeType
from typing import TypeVar

from trawl_ros.model.assembly import linearised
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import factorised

Part = object
"""A function, in Python or compiled."""


def shares(work: Callable[[], object], parts: Mapping[str, Part]) -> str:
    """Run once under Python's profiler, and return the share of each function.

    Parameters
    ----------
    work
        Work to look at.
    parts
        Functions by what they are called in a report, none of which calls another; what they
        call is counted with them. The rest is reported too.

    Returns
    -------
    str
        Such as ``factorisations 31 %, forces 12 %, the rest 57 %``. The profiler lengthens work
        in Python more than compiled loops: these shares are of the time with it.
    """
    profile = cProfile.Profile(time.process_time)
    began = time.process_time()
    profile.runcall(work)
    whole = time.process_time() - began
    taken = _cumulative(profile)
    told = {name: taken.get(_code(part), 0.0) / whole for name, part in parts.items()}
    told['the rest'] = 1.0 - sum(told.values())
    return ', '.join(f'{name} {100.0 * share:.0f} %' for name, share in told.items())


def _cumulative(profile: cProfile.Profile) -> dict[CodeType, float]:
    """Time (s) in each function with all that it called."""
    return {
        entry.code: entry.totaltime
        for entry in profile.getstats()
        if isinstance(entry.code, CodeType)
    }


def _code(part: Part) -> CodeType:
    """Return the code of a function, or of its Python source if it is compiled."""
    code = getattr(getattr(part, 'py_func', part), '__code__', None)
    assert isinstance(code, CodeType)
    return code


NO_BYTECODE = 'PYTHONDONTWRITEBYTECODE'
"""Variable that makes each process compile all its imports again; users do not set it."""


@contextmanager
def bytecode_kept(*modules: str) -> Iterator[None]:
    """Let child processes write and use bytecode; compile that of some modules beforehand."""
    before = os.environ.pop(NO_BYTECODE, None)
    try:
        if modules:
            code = f'import {", ".join(modules)}'
            subprocess.run([sys.executable, '-c', code], check=True, capture_output=True)
        yield
    finally:
        if before is not None:
            os.environ[NO_BYTECODE] = before


Result = TypeVar('Result')


def timed(work: Callable[[], Result]) -> tuple[Result, float]:
    """Time a function once.

    Returns
    -------
    result, seconds
        CPU time of this process, all its threads together: other programs on the machine do
        not lengthen it, and a second core does not shorten it.
    """
    began = time.process_time()
    result = work()
    return result, time.process_time() - began


def median_s(work: Callable[[], object], repeats: int) -> float:
    """Median CPU time (s) of repeated calls."""
    return median(timed(work)[1] for _ in range(repeats))


NUMBER_BYTES = 8
"""Bytes of one number in the factors; their sparsity pattern is stored once per gear."""


def factor_cost(model: GearModel, state: State, tow: Tow, repeats: int) -> tuple[float, float]:
    """CPU time (s) of one factorisation with its solution, and memory (MB) of the factors."""
    here = linearised(model, state, tow)
    factor = factorised(model.pattern, here.stiffness)
    seconds = median_s(lambda: factorised(model.pattern, here.stiffness).solve(here.force), repeats)
    return seconds, factor.fill * NUMBER_BYTES / 1e6
