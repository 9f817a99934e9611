"""Tow of a gear along given inputs, with the derivatives of its motion by parameters.

Memory is that of one state and its derivatives, however long the tow.
"""

from collections.abc import Callable

import numpy as np

from trawl_ros.core.arrays import FloatArray, Slice
from trawl_ros.effects.effect_set import NO_EFFECTS, EffectSet
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.line import BarProperties
from trawl_ros.model.slopes.observed import observed_slopes
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.motion.course import CoursePoint, InputPoint, course_point
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.partials import (
    GearAtPoint,
    NetLoads,
    StepEnd,
    effect_pushes,
    net_loads,
    pushes,
)
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.shown import shown_by_effects
from trawl_ros.solver.motion.slopes import (
    MotionSlopes,
    advance_slopes,
    unmoved,
)
from trawl_ros.solver.motion.start import starting_slopes
from trawl_ros.solver.motion.stepper import DifferentiatedStepper
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.stepper import StepFailed, at_rest

HALVINGS = 6
"""Number of halvings of a step that fails. A simulation goes on where more are needed, behind a
fall of milliseconds; derivatives through that are of no use, and who fits leaves it out."""

HalvedSteps = set[tuple[float, float]]
"""Steps that were halved: when each begins and how long it is, s."""


class DifferentiatedTow:
    """Tow along given inputs, with the derivatives of its motion.

    Parameters
    ----------
    model
        The gear without effects.
    parameters
        Parameters of the derivatives; with none of them it is towed alone.
    inputs
        Inputs at a time (s since the tow began); it begins in the equilibrium of the first.
    acting
        Effects that are there.
    start
        Equilibrium nearby from which that is sought.
    halved
        Steps that are halved at once; those that fail are added. Tows of one gear at several places
        that share them differ by their places, and not by which of their steps fail.

    Attributes
    ----------
    time, steps
        Time reached, s, and steps that led there.
    model
        The gear there, with its effects.
    motion, slopes
        Motion of the gear and its derivatives.
    course
        Towing boundary and its derivatives.
    first
        Equilibrium that it began in.

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
        halved: HalvedSteps | None = None,
    ) -> None:
        self._halved: HalvedSteps = set() if halved is None else halved
        self._plain, self._acting, self._inputs = model, acting, inputs
        self.parameters, self.time, self.steps = parameters, 0.0, 0
        self._net: tuple[BarProperties, NetLoads] | None = None
        self._showing: frozenset[str] = frozenset()
        self._held_at: FloatArray | None = None
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
            self.slopes = starting_slopes(
                self.model, state, tow, parameters, self.course.slopes, push
            )
        self._stepper = DifferentiatedStepper(self.model)

    def advance(self, h: float) -> None:
        """Advance by ``h`` seconds, in shorter steps where one fails.

        Raises
        ------
        StepFailed
            If not even short steps converge; the tow stays where it had come to.
        """
        self._advance(h, HALVINGS)

    @property
    def is_held(self) -> bool:
        """True where the derivatives stay as they are."""
        return self._held_at is not None

    @property
    def derivatives(self) -> tuple[MotionSlopes, FloatArray]:
        """Derivatives of the motion, and of the places (m, 2, 3) of the blocks it goes with."""
        return self.slopes, self.course.slopes.blocks

    def hold(self, slopes: MotionSlopes, blocks: FloatArray) -> None:
        """Hold the derivatives as they were before boards fell: none holds through that."""
        self.slopes, self._held_at = slopes, blocks.copy()

    def release(self) -> None:
        """Go on with the derivatives; the gear has gone with its blocks meanwhile."""
        assert self._held_at is not None
        along = (self.course.slopes.blocks - self._held_at).mean(axis=1).T
        places, nodes = self.slopes.places, 3 * self.model.nodes
        places[:nodes] += np.tile(along, (self.model.nodes, 1))
        places[nodes:].reshape(2, 6, -1)[:, :3] += along
        self._held_at = None

    @property
    def factorisations(self) -> int:
        """Matrices that were factorised so far, for steps that failed among them."""
        return self._stepper.factorisations

    def _advance(self, h: float, left: int) -> None:
        own = self.time, h
        if left == 0 or self.is_held or own not in self._halved:
            try:
                self.step(h)
            except StepFailed:
                if left == 0:
                    raise
                if not self.is_held:
                    self._halved.add(own)
            else:
                return
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
        if self.parameters and not self.is_held:
            at = self._stepper.linearised_step(self.motion, course.tow, h)
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
        """Set derivatives by some parameters to nought, as if these began to act now."""
        for slopes in self.slopes.arrays:
            slopes[:, columns] = 0.0
        if self._held_at is not None:
            self._held_at[columns] = 0.0
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
        """Observables of the present instant with their derivatives."""
        at = self.model, self.motion.state, self.course.tow
        along = self.slopes.places, self.slopes.velocities, self.course.slopes
        values, slopes = observed_slopes(*at, *along)
        if self._showing:
            gear, own = GearAtPoint(self._plain, self._acting, self._point), self.parameters
            slopes[:, own.of_effects] += shown_by_effects(gear, own, self._showing, *at[1:])
        return MotionPrediction(values, slopes)
