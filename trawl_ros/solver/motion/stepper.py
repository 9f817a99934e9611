"""Time stepper that linearises each step at its root."""

import numpy as np

from trawl_ros.model.state import Tow
from trawl_ros.solver.motion.slopes import LinearisedStep, linearise_step
from trawl_ros.solver.stepper import SCHEME, Motion, SolvedStep, Stepper

NEARER = 0.05
"""The root is found to this part of the tolerance before it is linearised. Bars that go slack
change their stiffness over a ten-thousandth of strain: with the tolerance as it is, derivatives of
the default gear are up to 4e-4 off those at the root itself, with a tenth of it 5e-6."""


class DifferentiatedStepper(Stepper):
    """Time stepper that linearises each step at its root; that matrix begins the next step."""

    def linearised_step(self, motion: Motion, tow: Tow, h: float) -> LinearisedStep:
        """Advance by ``h`` seconds to the boundary ``tow`` at the new time.

        Raises
        ------
        StepFailed
            If the iteration does not converge.
        """
        solved = self._solved(motion, tow, h)
        at = linearise_step(self.model, solved, tow)
        # The exact matrix is there now, so the root may as well be found to rounding.
        left = at.here.force - self.model.pattern.times(solved.inertia, solved.acceleration)
        new = solved.acceleration + at.factor.solve(left) / SCHEME.by_position(h)
        self._factor, self._factor_step = at.factor, h
        self.factorisations += 1
        return at.at(SolvedStep(solved.step, new, solved.inertia))

    def _is_done(self, size: float, last: float, enough: float) -> bool:
        # One more correction follows with the exact matrix, so it is the place where that is
        # made that must be near: by the rate of convergence, and not by the last correction.
        enough *= NEARER
        return size < enough or (size < last < np.inf and size * size < enough * (last - size))
