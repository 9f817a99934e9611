# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tow of a gear along given inputs, with the derivatives of its motion by parameters.

Memory is that of one state and its derivatives, however long the tow.
"""

from collections.abc import Callable

import numpy as np

from trawl_ros.core.arrays import FloatArray, Slice
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.effects.effect_set import NO_EFFECTS, EffectSet
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.line import BarProperties
from trawl_ros.model.slopes.observed import observed_slopes
from trawl_ros.model.state import State, Tow, TowSlopes
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.linear.factor import solve_refined
from trawl_ros.solver.modes import linearised_motion
from trawl_ros.solver.motion.course import CoursePoint, InputPoint, course_point
from trawl_ros.solver.motion.guide import TowGuide
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.partials import (
    GearAtPoint,
    NetLoads,
    StepEnd,
    effect_pushes,
    net_loads,
    pushes,
    shown_by_effects,
)
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.slopes import (
    MotionSlopes,
    advance_slopes,
    unmoved,
)
from trawl_ros.solver.motion.stepper import (
    STEP_OPTIONS,
    DifferentiatedStepper,
    LinearisedStepOptions,
)
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.rest_linearisation import rest_linearisation
from trawl_ros.solver.stepper import StepFailed, at_rest

MAX_STEP_HALVINGS = 6
"""Number of halvings of a step that fails. A simulation takes more, through a fall that lasts
milliseconds; derivatives through such a fall are of no use, and a fit leaves it out."""

REAL_RATE = 1e-6
"""Part of a rate that its imaginary part may be by rounding."""

EXTRA_MODES = 6
"""Modes sought beyond those asked for: oscillations come in pairs, and some may be missed."""


class DifferentiatedTow:
    """Tow along given inputs, with the derivatives of its motion.

    Parameters
    ----------
    model
        The gear without effects.
    parameters
        Parameters of the derivatives; without any, only the motion is computed.
    inputs
        Inputs at a time (s since the tow began); it begins in the equilibrium of the first.
    acting
        Effects that act on the gear.
    start
        Equilibrium nearby, from which the search for the first one starts.
    options
        Options of the time steps.
    guide, noted
        Steps of a tow along the same times, with other parameters; where to note those of this one.

    Attributes
    ----------
    time, steps
        Time reached, s, and number of steps taken.
    model
        The gear there, with its effects.
    motion, slopes
        Motion of the gear and its derivatives.
    course
        Towing boundary and its derivatives.
    first
        Equilibrium in which the tow began.

    Raises
    ------
    NoSteadyState
        If the gear has none to start from.
    """

    def __init__(
        self,
        model: GearModel,
        parameters: MotionParameters,
        inputs: Callable[[float], InputPoint],
        acting: EffectSet = NO_EFFECTS,
        start: Equilibrium | None = None,
        options: LinearisedStepOptions = STEP_OPTIONS,
        guide: TowGuide | None = None,
        noted: TowGuide | None = None,
    ) -> None:
        self._guide, self._noted = guide, noted
        self._plain, self._acting, self._inputs = model, acting, inputs
        self.parameters, self.time, self.steps = parameters, 0.0, 0
        self._net: tuple[BarProperties, NetLoads] | None = None
        self._showing: frozenset[str] = frozenset()
        point = inputs(0.0)
        self._point = point
        self.model = acting.gear(model, point.situation)
        self.course = course_point(model, acting, parameters, point)
        true = acting.apply_to_inputs(point.inputs, point.situation)
        port, starboard, speed = map(float, true)
        wanted = OperatingPoint(port, starboard, speed, point.heading)
        self.first = find_equilibrium(self.model, wanted, start)
        self.motion = at_rest(self.first.state)
        state, tow = self.motion.state, self.course.tow
        self.slopes = unmoved(model.dof, len(parameters))
        if parameters:
            end = StepEnd(state, self.motion.acceleration, tow, state)
            push = self._pushes(self.model, point, end, self.course)
            self.slopes = _starting_slopes(
                self.model, state, tow, parameters, self.course.slopes, push
            )
        self._stepper = DifferentiatedStepper(self.model, options)

    def advance(self, h: float) -> None:
        """Advance by ``h`` seconds, in shorter steps where one fails.

        Raises
        ------
        StepFailed
            If not even short steps converge; the tow stays at the last converged step.
        """
        self._advance(h, MAX_STEP_HALVINGS)

    @property
    def factorisations(self) -> int:
        """Number of factorisations so far, including those of failed steps."""
        return self._stepper.factorisations

    def _advance(self, h: float, left: int) -> None:
        if self._guide is None or not left or not self._guide.is_halved(self.time, h):
            try:
                self.step(h)
            except StepFailed:
                if left == 0:
                    raise
            else:
                return
        if self._noted is not None:
            self._noted.note_halved(self.time, h)
        self._advance(0.5 * h, left - 1)
        self._advance(0.5 * h, left - 1)

    def step(self, h: float) -> None:
        """Advance by one step of ``h`` seconds.

        Raises
        ------
        StepFailed
            If the iteration does not converge; the tow stays where it was.
        """
        time = self.time + h
        point = self._inputs(time)
        model = self._acting.gear(self._plain, point.situation)
        course = course_point(model, self._acting, self.parameters, point, self.course, h)
        self._stepper.model = model
        if self.parameters:
            guess = None if self._guide is None else self._guide.guess(self.time, h)
            at = self._stepper.linearised_step(self.motion, course.tow, h, guess)
            if self._noted is not None:
                self._noted.note(self.time, h, at.solved.acceleration)
            motion = at.solved.step.motion(at.solved.acceleration)
            end = StepEnd(motion.state, motion.acceleration, course.tow, at.predicted)
            push = self._pushes(model, point, end, course)
            self.slopes = advance_slopes(model, at, self.slopes, course.tow, course.slopes, push)
        else:
            motion = self._stepper.step(self.motion, course.tow, h)
        self.model, self.course, self.motion, self.time = model, course, motion, time
        self.steps += 1
        self._point = point

    def _pushes(
        self, model: GearModel, point: InputPoint, end: StepEnd, course: CoursePoint
    ) -> FloatArray:
        if self._net is None or self._net[0] is not model.bars:
            self._net = model.bars, net_loads(model)
        gear, own = GearAtPoint(self._plain, self._acting, point), self.parameters
        by_effects = effect_pushes(gear, own, end)
        self._showing |= by_effects.showing
        return pushes(model, own, end, course.slopes, self._net[1], by_effects.push)

    def forget(self, columns: Slice) -> None:
        """Set the derivatives by some parameters to zero, as if these began to act now."""
        for slopes in self.slopes.arrays:
            slopes[:, columns] = 0.0
        course = self.course
        for slopes in (
            course.way.slopes,
            course.velocity_slopes,
            course.slopes.blocks,
            course.slopes.block_velocities,
            course.slopes.lengths,
            course.slopes.length_rates,
        ):
            slopes[columns] = 0.0

    def observed(self) -> MotionPrediction:
        """Return the observables of the present instant with their derivatives."""
        at = self.model, self.motion.state, self.course.tow
        along = self.slopes.places, self.slopes.velocities, self.course.slopes
        values, slopes = observed_slopes(*at, *along)
        if self._showing:
            gear, own = GearAtPoint(self._plain, self._acting, self._point), self.parameters
            slopes[:, own.of_effects] += shown_by_effects(gear, own, self._showing, *at[1:])
        return MotionPrediction(values, slopes)


def _starting_slopes(
    model: GearModel,
    state: State,
    tow: Tow,
    parameters: MotionParameters,
    boundary: TowSlopes,
    push: FloatArray,
) -> MotionSlopes:
    """Return the derivatives of the equilibrium that a tow begins in.

    Parameters
    ----------
    model, state, tow
        The equilibrium.
    parameters
        Of the derivatives.
    boundary
        Derivatives of the boundary there. The whole gear goes with the blocks.
    push
        Derivatives (dof, m) of the forces, by the boundary too, all motion held.

    Raises
    ------
    NoSteadyState
        If the gear has fewer slow motions than are asked for.
    """
    known = rest_linearisation(model, state, tow)
    n, number = model.nodes, len(parameters)
    along = boundary.block_velocities.mean(axis=1).T
    velocities = np.zeros((model.dof, number))
    velocities[: 3 * n] = np.tile(along, (n, 1))
    velocities[3 * n :].reshape(2, 6, number)[:, :3] = along
    pattern, motion = model.pattern, known.motion
    right = push - pattern.matrix(motion.damping) @ velocities
    slopes = MotionSlopes(
        solve_refined(known.factor, right), velocities, *np.zeros((2, model.dof, number))
    )
    if parameters.motions:
        places, paces, accelerations = slow_motions(model, state, tow, parameters.motions)
        own = parameters.of_motions
        slopes.places[:, own], slopes.velocities[:, own] = places, paces
        slopes.accelerations[:, own] = slopes.averaged[:, own] = accelerations
    return slopes


def slow_motions(
    model: GearModel, state: State, tow: Tow, number: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Find the slowest motions that decay by more than they swing: |Re λ| > |Im λ|.

    Two that decay alike become a pair λ, λ* with the least change of the gear. It has the shapes
    Re v and Im v, so that what the motions span changes little.

    Returns
    -------
    tuple of (dof, number) arrays
        Shapes, whose largest displacement of a node is 1 m, their velocities and accelerations.

    Raises
    ------
    NoSteadyState
        If there are fewer of them.
    """
    motion = linearised_motion(model, state, tow)
    found = decaying_courses(*motion.nearest(0.0, number + EXTRA_MODES, tolerance=1e-8))
    if len(found) < number:
        raise NoSteadyState(
            f'found {len(found)} slow motions of the gear that decay, expected {number}'
        )
    places, paces, accelerations = found[:number].transpose(1, 2, 0)
    ways = places[: 3 * model.nodes]
    largest = ways[np.abs(ways).argmax(axis=0), range(number)]
    return places / largest, paces / largest, accelerations / largest


def decaying_courses(rates: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return motions that decay by more than they swing, as real courses, the slowest first.

    Parameters
    ----------
    rates, vectors : (m,) and (n, m) arrays
        Eigenvalues λ, 1/s, and eigenvectors v, both complex; of a pair one is enough.

    Returns
    -------
    (k, 3, n) array
        Shape, velocity and acceleration of each: v, λ v and λ² v, of a pair their real and their
        imaginary parts.
    """
    paired = np.abs(rates.imag) > REAL_RATE * np.abs(rates)
    decays = (rates.real < 0.0) & (np.abs(rates.imag) < np.abs(rates.real))
    courses = []
    for mode in sorted(np.flatnonzero(decays), key=lambda mode: -rates.real[mode]):
        twins = np.isclose(rates, rates[mode].conj(), rtol=REAL_RATE, atol=0.0)
        if paired[mode] and rates.imag[mode] < 0.0 and twins.any():
            continue
        course = np.stack([rates[mode] ** power * vectors[:, mode] for power in range(3)])
        courses += [course.real, course.imag] if paired[mode] else [course.real]
    return np.array(courses).reshape(-1, 3, len(vectors))
