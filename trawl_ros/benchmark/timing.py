"""CPU clock of the benchmark."""

import time
from collections.abc import Callable
from statistics import median
from typing import TypeVar

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
