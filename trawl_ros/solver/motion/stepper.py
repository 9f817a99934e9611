"""Time stepper that linearises each step at its root."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.state import Tow
from trawl_ros.solver.motion.slopes import LinearisedStep, linearise_step
from trawl_ros.solver.stepper import Motion, Scheme, SolvedStep, StepFailed, Stepper

DAMPED = Scheme.of(0.2)
"""Method of its steps, which keeps less of what vibrates faster than they are than a simulation's
does: in steps of 3 s slack netting would fly about. Of 1040 of them on the demo's tow 15 to 29 fail
with a spectral radius of 0.4, none with this, and the tow takes three fifths of the time."""

NEARER = 0.05
"""The root is found to this part of the tolerance before it is linearised. Bars that go slack
change their stiffness over a ten-thousandth of strain, so derivatives need a closer root."""

LONG_S = 2.0
"""Steps (s) longer than this take a matrix for each iteration, for a kept one serves few of them.
That saves a third of the time of the demo's tow in steps of 3 s."""

DEPARTURE_M, DEPARTURE_RAD = 0.1, np.radians(1.0)
"""Departure of a board from where its averaged acceleration leads it, and of its turn, from which a
step is too long. Where winches start, means of half a minute were up to 11 of their std off in
steps of 3 s, and are one std off with this. Steps of 6 s may come to another root altogether: one
took both doors 8 m down, with 24 MN in the warps."""

SHORT_S = 0.5
"""Steps (s) no longer than this are never too long: they are those of a simulation."""


class DifferentiatedStepper(Stepper):
    """Time stepper that linearises each step at its root; that matrix begins the next step."""

    scheme = DAMPED

    def linearised_step(self, motion: Motion, tow: Tow, h: float) -> LinearisedStep:
        """Advance by ``h`` seconds to the boundary ``tow`` at the new time.

        Raises
        ------
        StepFailed
            If the iteration does not converge, or the step is too long for a board.
        """
        solved = self._solved(motion, tow, h)
        at = linearise_step(self.model, solved, tow)
        # The exact matrix is there now, so the root may as well be found to rounding.
        left = at.here.force - self.model.pattern.times(solved.inertia, solved.acceleration)
        new = solved.acceleration + at.factor.solve(left) / self.scheme.by_position(h)
        self._factor, self._factor_step = at.factor, h
        self.factorisations += 1
        return at.at(SolvedStep(solved.step, new, solved.inertia))

    def _solved(self, motion: Motion, tow: Tow, h: float) -> SolvedStep:
        solved = super()._solved(motion, tow, h)
        if h > SHORT_S and is_too_long(motion, solved):
            raise StepFailed('the time step was too long for a board')
        return solved

    def _keep_rate(self, h: float) -> float:
        return 0.0 if h > LONG_S else super()._keep_rate(h)

    def _is_done(self, size: float, last: float, enough: float) -> bool:
        # One more correction follows with the exact matrix, so it is the place where that is
        # made that must be near: by the rate of convergence, and not by the last correction.
        enough *= NEARER
        return size < enough or (size < last < np.inf and size * size < enough * (last - size))


def is_too_long(motion: Motion, solved: SolvedStep) -> bool:
    """True if a step from a motion has led a board away from where that was leading it."""
    beside = solved.step.scheme.by_position(solved.step.h) * (solved.acceleration - motion.averaged)
    boards: FloatArray = np.abs(beside[-12:].reshape(2, 2, 3)).max(axis=(0, 2))
    return bool(boards[0] > DEPARTURE_M or boards[1] > DEPARTURE_RAD)
