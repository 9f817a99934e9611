"""Shares of named functions in the processor time of a piece of work."""

import cProfile
import time
from collections.abc import Callable, Mapping
from types import CodeType

Part = object
"""A function, in Python or compiled."""


def shares(work: Callable[[], object], parts: Mapping[str, Part]) -> str:
    """Run once under the profiler of Python, and tell what part of it each function took.

    Parameters
    ----------
    work
        Work to look at.
    parts
        Functions by what they are called in a report, none of which calls another; what they
        call is counted with them. The rest is told too.

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
    """Code of a function, of its Python source where it is compiled."""
    code = getattr(getattr(part, 'py_func', part), '__code__', None)
    assert isinstance(code, CodeType)
    return code
