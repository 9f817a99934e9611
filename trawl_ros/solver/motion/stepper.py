# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Time stepper that linearises each step at its root."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import Tow
from trawl_ros.solver.motion.slopes import LinearisedStep, linearise_step
from trawl_ros.solver.stepper import (
    Motion,
    Scheme,
    SolvedStep,
    StepFailed,
    Stepper,
    StepperOptions,
)

DAMPED = Scheme.of(0.2)
"""Scheme with more numerical damping than a simulation's, so that slack netting does not vibrate in
steps of 3 s. Of 1040 steps on the demo's tow, 15 to 29 fail with a spectral radius of 0.4 and none
with 0.2, and the tow takes three fifths of the time."""

DEPARTURE_M, DEPARTURE_RAD = 0.1, np.radians(1.0)
"""A step is too long if a board ends farther than this from where its averaged acceleration leads
it. Where winches start, means of half a minute were off by up to 11 of their std in steps of 3 s,
and are off by one std with this. Steps of 6 s may converge to another root: one took both doors 8 m
down, with 24 MN in the warps."""


@dataclass(frozen=True)
class LinearisedStepOptions(StepperOptions):
    """Options of a time step that is linearised at its root.

    Attributes
    ----------
    root_tolerance_ratio
        Ratio of the tolerance before the linearisation to that of a plain step. A bar that goes
        slack changes its stiffness over a strain of 1e-4, so derivatives need a closer root.
    full_newton_above_s
        Longer steps make a new matrix in each iteration, because a kept one serves few of them.
        This saves a third of the time of the demo's tow in steps of 3 s.
    always_accepted_s
        Steps of at most this length are never too long: a simulation takes them too.
    """

    root_tolerance_ratio: float = 0.05
    full_newton_above_s: float = 2.0
    always_accepted_s: float = 0.5


STEP_OPTIONS = LinearisedStepOptions()


class DifferentiatedStepper(Stepper):
    """Time stepper that linearises each step at its root and reuses that matrix in the next."""

    scheme = DAMPED
    options: LinearisedStepOptions

    def __init__(self, model: GearModel, options: LinearisedStepOptions = STEP_OPTIONS) -> None:
        super().__init__(model, options)

    def linearised_step(
        self, motion: Motion, tow: Tow, h: float, guess: FloatArray | None = None
    ) -> LinearisedStep:
        """Advance by ``h`` seconds to the boundary ``tow`` at the new time.

        ``guess`` is an acceleration (dof,) at the end, from which the iterations begin.

        Raises
        ------
        StepFailed
            If the iteration does not converge, or the step is too long for a board.
        """
        solved = self._solved(motion, tow, h, guess)
        at = linearise_step(self.model, solved, tow)
        # One Newton step with the exact matrix, which is known now, takes the root to rounding.
        left = at.here.force - self.model.pattern.times(solved.inertia, solved.acceleration)
        new = solved.acceleration + at.factor.solve(left) / self.scheme.by_position(h)
        self._factor, self._factor_step = at.factor, h
        self.factorisations += 1
        return at.at(SolvedStep(solved.step, new, solved.inertia))

    def _solved(
        self, motion: Motion, tow: Tow, h: float, guess: FloatArray | None = None
    ) -> SolvedStep:
        try:
            solved = super()._solved(motion, tow, h, guess)
        except StepFailed:
            if guess is None:
                raise
            solved = super()._solved(motion, tow, h)
        if h > self.options.always_accepted_s and is_too_long(motion, solved):
            raise StepFailed(f'the time step of {h:g} s was too long for the motion of a board')
        return solved

    def _keep_rate(self, h: float) -> float:
        return 0.0 if h > self.options.full_newton_above_s else super()._keep_rate(h)

    def _is_done(self, size: float, last: float, enough: float) -> bool:
        # The matrix is made at the root, so the distance to it counts, not the last correction:
        # with corrections falling by r = size / last, the distance is size r / (1 - r).
        enough *= self.options.root_tolerance_ratio
        return size < enough or (size < last < np.inf and size * size < enough * (last - size))


def is_too_long(motion: Motion, solved: SolvedStep) -> bool:
    """Return True if a board ends too far from where its averaged acceleration leads it."""
    departure = solved.step.scheme.by_position(solved.step.h) * (
        solved.acceleration - motion.averaged
    )
    boards: FloatArray = np.abs(departure[-12:].reshape(2, 2, 3)).max(axis=(0, 2))
    return bool(boards[0] > DEPARTURE_M or boards[1] > DEPARTURE_RAD)
