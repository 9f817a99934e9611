"""Budget of a search for a steady state: work after which it is given up.

Work is counted and not timed, so that a gear has the same answer on any machine.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import ParamSpec, TypeVar

from numpy.linalg import LinAlgError

from trawl_ros.core.errors import NoSteadyState

MAX_VALUES = 1_500_000_000
"""Values of all factors: 20 s of a core of 2024. The gears of the package take up to 0.7e9."""

MIN_FACTORISATIONS = 1000
"""Factorisations that a search may take in any case, of nets of many nodes too: a minute of the
largest ones. The package's gear with twice as many meshes around takes 135."""

Given = ParamSpec('Given')
Result = TypeVar('Result')


class _Spent(threading.local):
    """Work of the search under way in this thread."""

    searches = 0
    values = 0
    factorisations = 0


_SPENT = _Spent()


@contextmanager
def _search() -> Iterator[None]:
    if _SPENT.searches == 0:
        _SPENT.values = _SPENT.factorisations = 0
    _SPENT.searches += 1
    try:
        yield
    finally:
        _SPENT.searches -= 1


def spend(values: int) -> None:
    """Count a factorisation of so many values, if a search is under way.

    Raises
    ------
    NoSteadyState
        If the search has taken more than its budget.
    """
    if not _SPENT.searches:
        return
    _SPENT.values += values
    _SPENT.factorisations += 1
    if _SPENT.values > MAX_VALUES and _SPENT.factorisations > MIN_FACTORISATIONS:
        raise NoSteadyState(
            f'no steady state found in {_SPENT.factorisations} factorisations, after which the '
            'search is given up; expected a coarser net, or sizes and stiffnesses as gears have'
        )


def budgeted(search: Callable[Given, Result]) -> Callable[Given, Result]:
    """Give a search a budget, that of the outermost one, and refuse singular matrices.

    Raises
    ------
    NoSteadyState
        If the budget is spent, or a matrix is singular.
    """

    @wraps(search)
    def within(*args: Given.args, **options: Given.kwargs) -> Result:
        with _search():
            try:
                return search(*args, **options)
            except (RuntimeError, ArithmeticError, LinAlgError) as reason:
                raise NoSteadyState(
                    f'no steady state found: the forces or their derivatives are not finite, or '
                    f'singular ({reason}); expected sizes, weights and stiffnesses as gears have '
                    'them'
                ) from reason

    return within
