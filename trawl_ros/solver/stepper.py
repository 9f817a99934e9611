# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Time integration: the generalised-α method on rotations and translations.

Second order, implicit, with numerical damping of the fastest axial vibrations of the ropes,
whose stiffness forbids explicit steps. Rotations advance by exponentials of rotation vectors
(Arnold and Brüls 2007), so a board may turn freely. The iteration matrix is kept as long as the
iteration converges fast enough with it (modified Newton).
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
from trawl_ros.solver.patches import (
    NO_PATCH,
    PATCH_OPTIONS,
    ImplicitStep,
    PatchOptions,
    balanced,
    grown_patch,
)

HALVINGS = 10
"""Number of halvings of a time step that fails before the tow is given up: in one of 1000 hours of
random commands a fallen board took nine."""


class StepFailed(TrawlError):
    """Time step whose equations could not be solved; a shorter step may succeed."""


@dataclass(frozen=True)
class Motion:
    """State with its accelerations (dof,): the true one, and the method's averaged one."""

    state: State
    acceleration: FloatArray
    averaged: FloatArray


def at_rest(state: State) -> Motion:
    """Return the motion of a state without accelerations, such as an equilibrium."""
    zero = np.zeros_like(state.velocity)
    return Motion(state, zero, zero)


@dataclass(frozen=True)
class Scheme:
    """Constants α_m, α_f, γ and β of the generalised-α method."""

    alpha_m: float
    alpha_f: float
    gamma: float
    beta: float

    @classmethod
    def of(cls, rho: float) -> 'Scheme':
        """Return the constants for a spectral radius ρ∞ (Chung and Hulbert 1993).

        ρ∞ is the share of the fastest vibration that is left after a step: 1 keeps all, 0 none.
        """
        alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
        gamma = 0.5 + alpha_f - alpha_m
        return cls(alpha_m, alpha_f, gamma, 0.25 * (gamma + 0.5) ** 2)

    @property
    def share(self) -> float:
        """Share of the new acceleration in the new averaged one."""
        return (1 - self.alpha_f) / (1 - self.alpha_m)

    def known_acceleration(self, old: FloatArray, averaged: FloatArray) -> FloatArray:
        """Return the part of the new averaged acceleration that is known before the step."""
        # (1 - α_m) ā₁ = (1 - α_f) a₁ + α_f a₀ - α_m ā₀, without the unknown a₁.
        return (self.alpha_f * old - self.alpha_m * averaged) / (1 - self.alpha_m)

    def by_position(self, h: float) -> float:
        """Return the change of the new position per new acceleration, s²."""
        return h * h * self.beta * self.share

    def by_velocity(self, h: float) -> float:
        """Return the change of the new velocity per new acceleration, s."""
        return h * self.gamma * self.share

    def predicted_displacement(
        self, velocity: FloatArray, averaged: FloatArray, known: FloatArray, h: float
    ) -> FloatArray:
        """Return the part of the displacement in a step of ``h`` s that is known before it."""
        return h * velocity + h * h * ((0.5 - self.beta) * averaged + self.beta * known)

    def predicted_velocity(
        self, velocity: FloatArray, averaged: FloatArray, known: FloatArray, h: float
    ) -> FloatArray:
        """Return the part of the new velocity that is known before the step."""
        return velocity + h * ((1 - self.gamma) * averaged + self.gamma * known)


SCHEME = Scheme.of(0.4)
"""Scheme of a simulation, with spectral radius 0.4."""


@dataclass(frozen=True)
class StepperOptions:
    """Options of the iterations of a time step.

    Attributes
    ----------
    tolerance
        Last correction of the acceleration per step (m/s³ or rad/s³) at which a step is converged:
        1e-6 m in steps of 0.2 s. Errors add up over steps, so they must fall faster than h².
    max_convergence_rate
        Ratio of two corrections above which the iteration matrix is made again.
    iterations
        Iterations with a kept matrix.
    full_newton_iterations
        Iterations with a new matrix each, after those with a kept one have not converged.
    max_correction
        Largest correction of an iteration, m or rad.
    flip_correction_m
        Correction of a node that comes from a bar that flips between slack and taut.
    patches
        Options of the nonlinear elimination of such nodes.
    """

    tolerance: float = 1.25e-4
    max_convergence_rate: float = 0.35
    iterations: int = 12
    full_newton_iterations: int = 36
    max_correction: float = 0.2
    flip_correction_m: float = 0.02
    patches: PatchOptions = PATCH_OPTIONS


STEPPER_OPTIONS = StepperOptions()


@dataclass(frozen=True)
class Step:
    """Step of ``h`` seconds from a motion, as a function of the new acceleration."""

    start: Motion
    h: float
    scheme: Scheme = SCHEME

    @cached_property
    def known_acceleration(self) -> FloatArray:
        """Known part (dof,) of the new averaged acceleration."""
        return self.scheme.known_acceleration(self.start.acceleration, self.start.averaged)

    @cached_property
    def predicted_displacement(self) -> FloatArray:
        """Known part (dof,) of the displacement."""
        given = self.start.state.velocity, self.start.averaged, self.known_acceleration
        return self.scheme.predicted_displacement(*given, self.h)

    @cached_property
    def predicted_velocity(self) -> FloatArray:
        """Known part (dof,) of the new velocity."""
        given = self.start.state.velocity, self.start.averaged, self.known_acceleration
        return self.scheme.predicted_velocity(*given, self.h)

    def displacement(self, new: FloatArray) -> FloatArray:
        """Return the displacement (dof,) with an acceleration (dof,) at the end."""
        return self.predicted_displacement + self.scheme.by_position(self.h) * new

    def state(self, new: FloatArray) -> State:
        """Return the state at the end with an acceleration (dof,) there."""
        velocity = self.predicted_velocity + self.scheme.by_velocity(self.h) * new
        return self.start.state.moved(self.displacement(new)).with_velocity(velocity)

    def motion(self, new: FloatArray) -> Motion:
        """Return the motion at the end with an acceleration (dof,) there."""
        return Motion(self.state(new), new, self.known_acceleration + self.scheme.share * new)


@dataclass(frozen=True)
class SolvedStep:
    """Step with its new acceleration (dof,) and the mass as data on the pattern."""

    step: Step
    acceleration: FloatArray
    inertia: FloatArray


class Stepper:
    """Time stepper of one gear; keeps the factorised iteration matrix between steps."""

    scheme = SCHEME

    def __init__(self, model: GearModel, options: StepperOptions = STEPPER_OPTIONS) -> None:
        self.model, self.options = model, options
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

    def _solved(
        self, motion: Motion, tow: Tow, h: float, guess: FloatArray | None = None
    ) -> SolvedStep:
        """Solve a step, from a guess of its acceleration (dof,) where there is one."""
        if self._factor_step != h:
            self._factor = None
        keep_rate, kept = self._keep_rate(h), self._factor is not None
        try:
            return self._solve(motion, tow, h, keep_rate, guess)
        except StepFailed:
            if keep_rate == 0.0 and not kept:
                # Already refactorised in every iteration; a retry cannot succeed.
                raise
            # Ropes go slack or taut within the step: use a new matrix in every iteration.
            self._factor = None
            return self._solve(motion, tow, h, 0.0)

    def _keep_rate(self, h: float) -> float:
        """Return the convergence rate up to which a step keeps its matrix; 0 for full Newton."""
        return self.options.max_convergence_rate

    def _is_done(self, size: float, last: float, enough: float) -> bool:
        """Return True if a correction of a size, after one of the last size, is small enough."""
        return size < enough

    def _solve(
        self, motion: Motion, tow: Tow, h: float, keep_rate: float, guess: FloatArray | None = None
    ) -> SolvedStep:
        model, options, step = self.model, self.options, Step(motion, h, self.scheme)
        by_velocity, by_position = self.scheme.by_velocity(h), self.scheme.by_position(h)
        new = predicted = motion.averaged
        state = step.state(predicted)
        # Added mass turns with the ropes. Taken at the predicted place once a step, it
        # keeps the second order of the method and leaves M out of the Jacobian.
        inertia = mass(model, state, tow)
        if guess is not None:
            new = guess
        last, patch, enough = np.inf, NO_PATCH, options.tolerance * h**3
        # In full Newton, corrections may grow before they shrink.
        full_newton = keep_rate == 0.0
        most = options.full_newton_iterations if full_newton else options.iterations
        for iteration in range(most):
            if new is not predicted:
                state = step.state(new)
            if self._factor is None:
                here = linearised(model, state, tow)
                force = here.force
                # Jacobian by the position: K + (h γ / h² β) C + M / (h² β), each with α factors.
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
            if not np.isfinite(size) or (iteration > 2 and size > 10 * last and not full_newton):
                raise StepFailed(f'the time step of {h:g} s did not converge')
            new = new + correction * (
                min(1.0, options.max_correction / max(size, options.max_correction)) / by_position
            )
            if self._is_done(size, last, enough):
                return SolvedStep(step, new, inertia)
            slow = full_newton or size > keep_rate * last
            if slow or len(patch) or size > options.flip_correction_m:
                grown = grown_patch(model, patch, correction, enough, options.patches)
                if slow and len(grown) in (0, len(patch)):
                    self._factor = None
                if len(patch := grown):
                    implicit = ImplicitStep(inertia, by_position, by_velocity, enough)
                    new = balanced(
                        model, step.state(new), tow, implicit, new, patch, options.patches
                    )
            last = size
        raise StepFailed(f'the time step of {h:g} s did not converge')
