"""Time integration: the generalised-α method on rotations and translations.

Second order, implicit, with numerical damping of the fastest axial vibrations of the ropes,
whose stiffness forbids explicit steps. Rotations advance by exponentials of rotation vectors
(Arnold and Brüls 2007), so a board may turn freely. The iteration matrix is kept as long as
it serves.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.model.assembly import forces, linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.linear.factor import Factor, factorised
from trawl_ros.solver.patches import NO_PATCH, ImplicitStep, balanced, grown_patch

SPECTRAL_RADIUS = 0.4
"""Share of the fastest vibration that is left after a step; 1 keeps all, 0 none."""

TOLERANCE = 1.25e-4
"""Last correction of the gear's acceleration over the step (m/s³ or rad/s³) at which it is done:
a millionth of a metre in steps of 0.2 s. Errors that are left add up over steps, so they have to
fall faster than the square of the step."""

KEEP_RATE = 0.35
"""Convergence slower than this factor per iteration asks for a new iteration matrix."""

ITERATIONS = 12

PATIENCE = 36
"""Iterations with a matrix for each of them, when those with a kept one have not come to rest."""

HALVINGS = 10
"""Number of halvings of a time step that fails before the tow is given up: in one of 1000 hours of
random commands a fallen board took nine."""

LIMIT = 0.2
"""Largest correction of an iteration (m or rad)."""

FLUNG = 0.02
"""Correction (m) from which nodes are flung away by a flip, and not on their way."""


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


@dataclass(frozen=True)
class Scheme:
    """Constants of the generalised-α method, by the share of the fastest vibration it keeps."""

    alpha_m: float
    alpha_f: float
    gamma: float
    beta: float

    @classmethod
    def of(cls, rho: float) -> 'Scheme':
        """Constants for a spectral radius (Chung and Hulbert 1993)."""
        alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
        gamma = 0.5 + alpha_f - alpha_m
        return cls(alpha_m, alpha_f, gamma, 0.25 * (gamma + 0.5) ** 2)

    @property
    def share(self) -> float:
        """Share of the new acceleration in the new averaged one."""
        return (1 - self.alpha_f) / (1 - self.alpha_m)

    def carried(self, old: FloatArray, averaged: FloatArray) -> FloatArray:
        """Part of the new averaged acceleration that is known before the step."""
        return (self.alpha_f * old - self.alpha_m * averaged) / (1 - self.alpha_m)

    def by_position(self, h: float) -> float:
        """Change of the new position by the new acceleration, s²."""
        return h * h * self.beta * self.share

    def by_velocity(self, h: float) -> float:
        """Change of the new velocity by the new acceleration, s."""
        return h * self.gamma * self.share

    def way(
        self, velocity: FloatArray, averaged: FloatArray, carried: FloatArray, h: float
    ) -> FloatArray:
        """Part of the way through a step of ``h`` s that is known before it."""
        return h * velocity + h * h * ((0.5 - self.beta) * averaged + self.beta * carried)

    def pace(
        self, velocity: FloatArray, averaged: FloatArray, carried: FloatArray, h: float
    ) -> FloatArray:
        """Part of the new velocity that is known before the step."""
        return velocity + h * ((1 - self.gamma) * averaged + self.gamma * carried)


SCHEME = Scheme.of(SPECTRAL_RADIUS)


@dataclass(frozen=True)
class Step:
    """A step of ``h`` seconds from a motion as a function of the new acceleration."""

    start: Motion
    h: float
    scheme: Scheme = SCHEME

    @cached_property
    def carried(self) -> FloatArray:
        """Part (dof,) of the new averaged acceleration that is known."""
        return self.scheme.carried(self.start.acceleration, self.start.averaged)

    @cached_property
    def way(self) -> FloatArray:
        """Part (dof,) of the way that is known."""
        given = self.start.state.velocity, self.start.averaged, self.carried
        return self.scheme.way(*given, self.h)

    @cached_property
    def pace(self) -> FloatArray:
        """Part (dof,) of the new velocity that is known."""
        given = self.start.state.velocity, self.start.averaged, self.carried
        return self.scheme.pace(*given, self.h)

    def shift(self, new: FloatArray) -> FloatArray:
        """Way (dof,) of the gear with an acceleration (dof,) at the end."""
        return self.way + self.scheme.by_position(self.h) * new

    def state(self, new: FloatArray) -> State:
        """State at the end with an acceleration (dof,) there."""
        velocity = self.pace + self.scheme.by_velocity(self.h) * new
        return self.start.state.moved(self.shift(new)).with_velocity(velocity)

    def motion(self, new: FloatArray) -> Motion:
        """Motion at the end with an acceleration (dof,) there."""
        return Motion(self.state(new), new, self.carried + self.scheme.share * new)


@dataclass(frozen=True)
class SolvedStep:
    """Step with its new acceleration (dof,) and the mass as data on the pattern."""

    step: Step
    acceleration: FloatArray
    inertia: FloatArray


class Stepper:
    """Time stepper of one gear; holds the factorised iteration matrix between steps."""

    scheme = SCHEME

    def __init__(self, model: GearModel) -> None:
        self.model = model
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
        solved = self._solved(motion, tow, h)
        return solved.step.motion(solved.acceleration)

    def _solved(self, motion: Motion, tow: Tow, h: float) -> SolvedStep:
        if self._factor_step != h:
            self._factor = None
        keep_rate, kept = self._keep_rate(h), self._factor is not None
        try:
            return self._solve(motion, tow, h, keep_rate)
        except StepFailed:
            if keep_rate == 0.0 and not kept:
                # The same once more would fail as it did.
                raise
            # Ropes that go slack or taut within the step: a matrix for every iteration.
            self._factor = None
            return self._solve(motion, tow, h, 0.0)

    def _keep_rate(self, h: float) -> float:
        """Rate of convergence at which a step keeps its matrix; 0 for a matrix per iteration."""
        return KEEP_RATE

    def _is_done(self, size: float, last: float, enough: float) -> bool:
        """True if a correction of a size, after one of the last size, is small enough."""
        return size < enough

    def _solve(self, motion: Motion, tow: Tow, h: float, keep_rate: float) -> SolvedStep:
        model, step = self.model, Step(motion, h, self.scheme)
        by_velocity, by_position = self.scheme.by_velocity(h), self.scheme.by_position(h)
        new = motion.averaged.copy()
        inertia = None
        last, patch, enough = np.inf, NO_PATCH, TOLERANCE * h**3
        # With a matrix for every iteration corrections may grow before they shrink.
        patient = keep_rate == 0.0
        for iteration in range(PATIENCE if patient else ITERATIONS):
            state = step.state(new)
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
            if not np.isfinite(size) or (iteration > 2 and size > 10 * last and not patient):
                raise StepFailed('the time step did not converge')
            new = new + correction * (min(1.0, LIMIT / max(size, LIMIT)) / by_position)
            if self._is_done(size, last, enough):
                return SolvedStep(step, new, inertia)
            slow = patient or size > keep_rate * last
            if slow or len(patch) or size > FLUNG:
                grown = grown_patch(model, patch, correction, enough)
                if slow and len(grown) in (0, len(patch)):
                    self._factor = None
                if len(patch := grown):
                    implicit = ImplicitStep(inertia, by_position, by_velocity, enough)
                    new = balanced(model, step.state(new), tow, implicit, new, patch)
            last = size
        raise StepFailed('the time step did not converge')
