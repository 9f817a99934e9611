# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The descent finds the least cost of a curved problem, and says truly why it ends."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from trawl_ros.estimation.least_squares.descent import NO_STEP, DescentOptions, descend
from trawl_ros.estimation.least_squares.information import Information
from trawl_ros.estimation.least_squares.linear_problem import LinearProblem

OPTIONS = DescentOptions(iterations=30, attempts=7, tolerance=0.01)


@dataclass
class Valley:
    """Readings of x and of a bent y, as Rosenbrock's valley has them; a wall stands at ``wall``."""

    x: np.ndarray
    wall: float = np.inf
    is_final: bool = True
    is_spent: bool = False
    refused: list[float] = field(default_factory=list)

    def residual(self, x):
        return np.array([1.0 - x[0], 10.0 * (x[1] - x[0] ** 2)])

    def linearised(self):
        columns = np.array([[1.0, 0.0], [20.0 * self.x[0], -10.0]])
        at_zero = self.residual(self.x) + columns @ self.x
        free = np.full(2, np.inf)
        block = Information.whitened(np.eye(2), columns, at_zero)
        return LinearProblem([block], [np.full(2, 1e-6)], [self.x], -free, free, 2)

    def is_predicted(self, place):
        return True

    def move(self, place, share):
        there = place[0]
        if there[0] > self.wall:
            self.refused.append(share)
            return 'a wall'
        lower = np.sum(self.residual(there) ** 2) <= np.sum(self.residual(self.x) ** 2)
        if lower:
            self.x = there
        else:
            self.refused.append(share)
        return '' if lower else NO_STEP


def test_the_end_of_a_bent_valley_is_found_by_damped_steps():
    valley = Valley(np.array([-1.2, 1.0]))
    rest = descend(valley, OPTIONS)
    assert rest.converged, rest.reason
    np.testing.assert_allclose(valley.x, 1.0, atol=0.05)
    assert valley.refused


def test_a_wall_in_the_way_is_named():
    valley = Valley(np.array([0.0, 0.0]), wall=0.5)
    rest = descend(valley, OPTIONS)
    assert not rest.converged
    assert 'a wall' in rest.reason
    assert valley.x[0] <= 0.5


def test_nothing_is_tried_for_a_step_that_gains_nothing():
    valley = Valley(np.array([1.0 - 1e-3, 1.0 - 2e-3]))
    valley.move = None
    rest = descend(valley, DescentOptions(iterations=3, attempts=3, tolerance=0.0))
    assert rest.converged
    assert rest.iterations == 1


@pytest.mark.parametrize('final', [True, False])
def test_a_model_that_is_spent_is_not_moved(final):
    valley = Valley(np.array([0.0, 0.0]), is_final=final, is_spent=True)
    valley.move = None
    assert not descend(valley, OPTIONS).converged
