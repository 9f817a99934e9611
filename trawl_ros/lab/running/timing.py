"""CPU clock of the benchmark."""

import time
from collections.abc import Callable
from statistics import median
from typing import TypeVar

from trawl_ros.model.assembly import linearised
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import factorised

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
"""Of one number in the factors, whose places the gear has once."""


def factor_cost(model: GearModel, state: State, tow: Tow, repeats: int) -> tuple[float, float]:
    """CPU time (s) of one factorisation with its solution, and memory (MB) of the factors."""
    here = linearised(model, state, tow)
    factor = factorised(model.pattern, here.stiffness)
    seconds = median_s(lambda: factorised(model.pattern, here.stiffness).solve(here.force), repeats)
    return seconds, factor.fill * NUMBER_BYTES / 1e6
