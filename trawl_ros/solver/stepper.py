"""Time integration: the generalised-α method on rotations and translations.

Second order, implicit, with numerical damping of the fastest axial vibrations of the ropes,
whose stiffness forbids explicit steps. Rotations advance by exponentials of rotation vectors
(Arnold and Brüls 2007), so a board may turn freely. The iteration matrix is kept as long as
it serves.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.model.assembly import forces, linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.factor import Factor, factorised

SPECTRAL_RADIUS = 0.4
"""Share of the fastest vibration that is left after a step; 1 keeps all, 0 none."""

TOLERANCE = 1.25e-4
"""Last correction of the gear's acceleration over the step (m/s³ or rad/s³) at which it is done:
a millionth of a metre in steps of 0.2 s. Errors that are left add up over steps, so they have to
fall faster than the square of the step."""

KEEP_RATE = 0.35
"""Convergence slower than this factor per iteration asks for a new iteration matrix."""

ITERATIONS = 12

LIMIT = 0.2
"""Largest correction of an iteration (m or rad)."""


class StepFailed(TrawlError):
    """A time step whose equations could not be solved; a shorter one may be."""


@dataclass(frozen=True)
class Motion:
    """State with its accelerations (dof,): the true one, and the method's averaged one."""

    state: State
    acceleration: FloatArray
    averaged: FloatArray


def at_rest(state: State) -> Motion:
    """Motion of a state without accelerations, such as an equilibrium."""
    zero = np.zeros_like(state.velocity)
    return Motion(state, zero, zero)


class Stepper:
    """Time stepper of one gear; holds the factorised iteration matrix between steps."""

    def __init__(self, model: GearModel) -> None:
        rho = SPECTRAL_RADIUS
        self.model = model
        self._alpha_m = (2 * rho - 1) / (rho + 1)
        self._alpha_f = rho / (rho + 1)
        self._gamma = 0.5 + self._alpha_f - self._alpha_m
        self._beta = 0.25 * (self._gamma + 0.5) ** 2
        self._factor: Factor | None = None
        self._factor_step = 0.0
        self.factorisations = 0

    def step(self, motion: Motion, tow: Tow, h: float) -> Motion:
        """Advance by ``h`` seconds to the boundary ``tow`` at the new time.

        Raises
        ------
        StepFailed
            If the iteration does not converge.
        """
        if self._factor_step != h:
            self._factor = None
        try:
            return self._solve(motion, tow, h, KEEP_RATE)
        except StepFailed:
            # Ropes that go slack or taut within the step: a matrix for every iteration.
            self._factor = None
            return self._solve(motion, tow, h, 0.0)

    def _solve(self, motion: Motion, tow: Tow, h: float, keep_rate: float) -> Motion:
        model = self.model
        share = (1 - self._alpha_f) / (1 - self._alpha_m)
        by_velocity = h * self._gamma * share
        by_position = h * h * self._beta * share
        start, velocity = motion.state, motion.state.velocity
        old, averaged = motion.acceleration, motion.averaged
        carried = (self._alpha_f * old - self._alpha_m * averaged) / (1 - self._alpha_m)
        # With the new acceleration q, places move by `way` + by_position q, and velocities
        # become `pace` + by_velocity q.
        way = h * velocity + h * h * ((0.5 - self._beta) * averaged + self._beta * carried)
        pace = velocity + h * ((1 - self._gamma) * averaged + self._gamma * carried)
        new = averaged.copy()
        inertia = None
        last = np.inf
        for iteration in range(ITERATIONS):
            state = start.moved(way + by_position * new).with_velocity(pace + by_velocity * new)
            if inertia is None:
                # Added mass turns with the ropes; taking it at the predicted place keeps
                # the order of the method.
                inertia = mass(model, state, tow)
            if self._factor is None:
                here = linearised(model, state, tow)
                force = here.force
                self._factor = factorised(
                    model.pattern,
                    here.stiffness
                    + (by_velocity / by_position) * here.damping
                    + inertia / by_position,
                )
                self._factor_step = h
                self.factorisations += 1
            else:
                force = forces(model, state, tow)
            correction = self._factor.solve(force - model.pattern.times(inertia, new))
            size = float(np.abs(correction).max())
            if not np.isfinite(size) or (iteration > 2 and size > 10 * last):
                raise StepFailed('the time step did not converge')
            new = new + correction * (min(1.0, LIMIT / max(size, LIMIT)) / by_position)
            if size < TOLERANCE * h**3:
                state = start.moved(way + by_position * new)
                speed = pace + by_velocity * new
                return Motion(state.with_velocity(speed), new, carried + share * new)
            if size > keep_rate * last:
                self._factor = None
            last = size
        raise StepFailed('the time step did not converge')
