# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Budget of a search for a steady state: the work after which it is given up.

Work is counted and not timed, so that a gear has the same answer on any machine.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from typing import ParamSpec, TypeVar

from numpy.linalg import LinAlgError

from trawl_ros.core.errors import NoSteadyState

Given = ParamSpec('Given')
Result = TypeVar('Result')


@dataclass(frozen=True)
class SearchBudget:
    """Budget of a search; it is spent when both limits are passed.

    Attributes
    ----------
    max_values
        Values of all factors: 20 s of a core of 2024. The gears of the package take up to 0.7e9.
    min_factorisations
        Factorisations that every search may take, also with many nodes: a minute of the largest
        nets. The package's gear with twice as many meshes around takes 135.
    """

    max_values: int = 1_500_000_000
    min_factorisations: int = 1000


DEFAULT_BUDGET = SearchBudget()


class _Spent(threading.local):
    """Work of the current search of this thread."""

    budget = DEFAULT_BUDGET
    searches = 0
    values = 0
    factorisations = 0


_SPENT = _Spent()


@contextmanager
def search_within(budget: SearchBudget = DEFAULT_BUDGET) -> Iterator[None]:
    """Count the work of a search; a search inside another one counts for the outer one."""
    if _SPENT.searches == 0:
        _SPENT.budget = budget
        _SPENT.values = _SPENT.factorisations = 0
    _SPENT.searches += 1
    try:
        yield
    finally:
        _SPENT.searches -= 1


def spend(values: int) -> None:
    """Count a factorisation of so many values, if a search is running.

    Raises
    ------
    NoSteadyState
        If the search has spent its budget.
    """
    if not _SPENT.searches:
        return
    _SPENT.values += values
    _SPENT.factorisations += 1
    budget = _SPENT.budget
    spent = _SPENT.values > budget.max_values
    if spent and _SPENT.factorisations > budget.min_factorisations:
        raise NoSteadyState(
            f'no steady state found in {_SPENT.factorisations} factorisations, so the search is '
            'given up; expected a coarser net, or sizes and stiffnesses of a real gear'
        )


def budgeted(search: Callable[Given, Result]) -> Callable[Given, Result]:
    """Give a search the default budget, and refuse singular matrices.

    Raises
    ------
    NoSteadyState
        If the budget is spent, or a matrix is singular.
    """

    @wraps(search)
    def within(*args: Given.args, **options: Given.kwargs) -> Result:
        with search_within():
            try:
                return search(*args, **options)
            except (RuntimeError, ArithmeticError, LinAlgError) as reason:
                raise NoSteadyState(
                    'no steady state found: the forces or their derivatives are not finite, or '
                    f'their matrix is singular ({reason}); expected sizes, weights and '
                    'stiffnesses of a real gear'
                ) from reason

    return within
