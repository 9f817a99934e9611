# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Descent to the least cost: the only iteration of the package's fits (Levenberg-Marquardt).

A model of what is fitted linearises itself where it is. The core solves the linear problem,
shortens steps that the model refuses, and decides when the fit has converged.
"""

from dataclasses import dataclass
from typing import Protocol

from trawl_ros.estimation.least_squares.linear_problem import LinearProblem, Place

NEGLIGIBLE_GAIN = 0.005
"""Decrease of the cost (half a χ²) for which nothing is predicted again: a step of 0.1 std."""

LEAST_SHARE = 0.01
"""Length of a damped step, as a part of the undamped one, below which none is tried."""

NO_STEP = 'no step lowers the cost'


@dataclass
class Damping:
    """Damping of a step: weight of staying, as a part of the prior precision.

    Attributes
    ----------
    value
        Present damping; 0 is a Gauss-Newton step.
    first, stiffer
        Damping after a step that was refused; factor after each further one.
    looser, least
        Factor after a step that was taken; damping below which it is 0.
    """

    value: float = 0.0
    first: float = 1.0
    stiffer: float = 30.0
    looser: float = 0.2
    least: float = 0.1

    def refuse(self) -> None:
        """Shorten the next step."""
        self.value = max(self.first, self.stiffer * self.value)

    def accept(self) -> None:
        """Lengthen the next step."""
        self.value *= self.looser
        if self.value < self.least:
            self.value = 0.0


@dataclass(frozen=True)
class DescentOptions:
    """Options of a descent.

    Attributes
    ----------
    iterations, attempts
        Largest number of steps; of attempts at a step that lowers the cost, each damped more.
    tolerance
        A step that leaves less than this part of every posterior std to the next ends the descent.
    near
        Part of every posterior std within which a step that lowers no cost is not tried again, and
        the fit counts as converged.
    """

    iterations: int
    attempts: int
    tolerance: float
    near: float = 0.0


@dataclass(frozen=True)
class Rest:
    """End of a descent.

    Attributes
    ----------
    converged, reason
        True if nothing is left to gain; the criterion, in a sentence.
    iterations
        Number of linear problems that were solved.
    size
        Size of the last step in posterior std.
    place
        Place of least cost to first order where converged, else None.
    """

    converged: bool
    reason: str
    iterations: int
    size: float
    place: Place | None = None


class Descending(Protocol):
    """What is fitted: it linearises itself, and moves where its cost becomes lower."""

    @property
    def is_final(self) -> bool:
        """True if the errors of the data have the sizes with which the fit is to end."""
        ...

    @property
    def is_spent(self) -> bool:
        """True if no further prediction may be made."""
        ...

    def linearised(self) -> LinearProblem:
        """Return the linear problem here, with weights and sizes of the errors as found."""
        ...

    def is_predicted(self, place: Place) -> bool:
        """Return True if the linear problem predicts the data well enough at a place."""
        ...

    def move(self, place: Place, share: float) -> str:
        """Move to a place if the cost is lower there.

        Parameters
        ----------
        place
            Where a damped step leads.
        share
            Length of this step as a part of the undamped one.

        Returns
        -------
        str
            Reason for which it is refused; '' where it is taken.
        """
        ...


def descend(model: Descending, options: DescentOptions, damping: Damping | None = None) -> Rest:
    """Bring a model to the place of least cost.

    Parameters
    ----------
    model
        What is fitted.
    options
        Of the descent.
    damping
        To begin with; none where None.
    """
    damping, size, last, iteration = damping or Damping(), float('inf'), 0.0, 0
    for iteration in range(1, options.iterations + 1):
        problem = model.linearised()
        target = problem.target()
        size, final = problem.distance(target), model.is_final
        # Steps that fall by r = size / last leave size r to the next, where this one is taken.
        beyond = size * min(1.0, size / last) if last else size
        last = size if final else 0.0
        if final and beyond < options.tolerance and model.is_predicted(target):
            limit = f'the next step is below {options.tolerance:g} of every std'
            return Rest(True, f'after {iteration} iterations {limit}', iteration, size, target)
        if final and problem.cost(problem.here) - problem.cost(target) < NEGLIGIBLE_GAIN:
            gain = 'no step can lower the cost noticeably'
            return Rest(True, f'after {iteration} iterations {gain}', iteration, size, target)
        if model.is_spent:
            reason = f'still moving by {size:.2g} std after all predictions that may be made'
            return Rest(False, reason, iteration, size)
        near = final and size < options.near
        obstacle = _step(model, problem, target, damping, 1 if near else options.attempts)
        if obstacle and final:
            reason = f'{obstacle}, {size:.2g} std from rest'
            return Rest(near, reason, iteration, size, target if near else None)
    reason = f'still moving by {size:.2g} std after {iteration} iterations'
    return Rest(False, reason, iteration, size)


def _step(
    model: Descending, problem: LinearProblem, target: Place, damping: Damping, attempts: int
) -> str:
    """Take a step, ever shorter; return the reason if none is taken."""
    obstacle, whole = NO_STEP, problem.distance(target)
    for _ in range(attempts):
        place = problem.target(damping.value) if damping.value else target
        share = min(problem.distance(place) / whole, 1.0) if whole > 0.0 else 1.0
        if share < LEAST_SHARE:
            break
        obstacle = model.move(place, share)
        if not obstacle:
            damping.accept()
            break
        damping.refuse()
        if model.is_spent:
            break
    return obstacle
