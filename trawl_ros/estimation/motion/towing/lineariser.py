# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Lineariser of tows, a chain of parts: steady ones by equilibria, moving ones integrated in time.

A part in which the inputs have been held for long is predicted by the equilibrium of its inputs. A
moving part is integrated from the equilibrium of the steady part before it, and ends at the next.
Between parts the amplitudes of the gear's slowest motions are carried. Where a part cannot
be predicted it is left out, and the next steady part begins with unknown amplitudes.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import NoReturn

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.motion.towing.held import HeldGear, hold_gear, projection
from trawl_ros.estimation.motion.towing.inputs import CorrectedInputs, MeanInputs
from trawl_ros.estimation.motion.towing.linearisation import (
    SLOW_MOTIONS,
    Linearisation,
    unknown_amplitudes,
)
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.moving import MovingCourse, MovingGear
from trawl_ros.estimation.motion.towing.records import LeftOut, MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.motion.guide import TowGuide
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.stepper import StepFailed

UNSTABLE_DERIVATIVE = 1e6
"""Derivative of a mean by a coefficient, in noise of the mean, above which motion is unstable."""

BY_SENSOR = 'a board has fallen, by its sensor'

MOVES = 'the gear moves, and its steady parts alone are fitted'

NEARBY = np.array([*(WindowOptions.length_tolerance,) * 2, 0.5 * WindowOptions.speed_tolerance])
"""Largest departure of warp lengths (m) and speed (m/s) from those of an equilibrium that is used
for a stretch."""


class NotPredicted(Exception):
    """Reason why a stretch has no prediction."""


class TowLineariser:
    """Predictions of a tow with derivatives, stretch by stretch; the tow may grow between calls.

    Parameters
    ----------
    gear
        The gear that is towed.
    channels
        Measured channels (k).
    point
        Point of linearisation.
    on_stretch
        Called after each stretch, with its number.
    guides
        Time steps of each moving part, by its beginning (s), at another point; None if those here
        are not to be noted either.

    Attributes
    ----------
    channels
        Measured channels.
    guides
        Time steps of each moving part here.
    equilibria
        Equilibria that were found.
    """

    def __init__(
        self,
        gear: TowedGear,
        channels: tuple[str, ...],
        point: TowedPoint,
        on_stretch: Callable[[int], None] = lambda number: None,
        guides: Mapping[float, TowGuide] | None = None,
    ) -> None:
        self._guides, self.guides = guides, dict[float, TowGuide]()
        self._gear, self._point, self._on_stretch = gear, point, on_stretch
        self.channels = channels
        self._held: HeldGear | None = None
        self.equilibria: list[Equilibrium] = []
        self._moving: MovingGear | None = None
        self._amplitudes: Linearisation | None = None
        self._since = 0.0
        self._failed, self._lost_part = '', -1
        self._means: list[Linearisation | None] = []
        self._left_out: list[LeftOut] = []

    def __len__(self) -> int:
        return len(self._means)

    @property
    def failed(self) -> str:
        """Reason why no moving stretch is predicted before the next steady one; '' if they are."""
        return self._failed

    def extend(
        self,
        tow: MovingTow,
        drifts: FloatArray,
        most: int | None = None,
        required: BoolArray | None = None,
        spare: int = 0,
    ) -> int:
        """Predict the new stretches of a tow that has grown.

        Parameters
        ----------
        tow
            Inputs and stretches, of which the first have been predicted before.
        drifts
            Errors (knots,) of its inputs at all knots; those so far as they were.
        most
            Number of stretches that are predicted at most.
        required
            Flags (n,) of stretches that may not be left out, none where None.
        spare
            Number of those that may be left out nonetheless.

        Returns
        -------
        int
            Number of stretches that were predicted or left out.

        Raises
        ------
        NoSteadyState
            As soon as more stretches that are required must be left out than may be.
        """
        first = len(self)
        last = len(tow) if most is None else min(len(tow), first + most)
        self._point = replace(self._point, drifts=drifts)
        if self._moving is not None:
            self._moving.follow(tow.inputs, drifts)
        for stretch in range(first, last):
            begin = stretch * tow.stretch_s
            try:
                self._means.append(self._predicted(tow, stretch))
            except NotPredicted as reason:
                spare -= required is not None and bool(required[stretch])
                if spare < 0:
                    raise NoSteadyState(f'{begin:.0f} s after the beginning {reason}') from None
                self._left_out.append(LeftOut(begin, begin + tow.stretch_s, str(reason)))
                self._means.append(None)
            self._on_stretch(stretch)
        return max(last - first, 0)

    def linearised(self, tow: MovingTow) -> LinearisedTow:
        """Tow as it is linearised so far, of which all has been predicted."""
        return LinearisedTow.of(tow, self._point, self._gear, self._means, tuple(self._left_out))

    def _predicted(self, tow: MovingTow, stretch: int) -> Linearisation:
        if stretch in tow.fallen:
            self._fail(BY_SENSOR)
        try:
            if tow.steady[stretch]:
                if tow.steady_part[stretch] == self._lost_part:
                    raise NotPredicted(self._failed)
                return self._in_steady(tow, stretch)
            if tow.steady_only:
                self._held = self._amplitudes = None
                self._failed = ''
                raise NotPredicted(MOVES)
            if self._failed:
                raise NotPredicted(self._failed)
            return self._in_motion(tow, stretch)
        except (NoSteadyState, StepFailed) as error:
            if tow.steady[stretch]:
                # It takes long to find that there is no equilibrium, and none is near.
                self._lost_part = int(tow.steady_part[stretch])
            self._fail(f'the model cannot be towed: {error}')

    def _fail(self, why: str) -> NoReturn:
        """End the part; the next steady stretch begins another."""
        self._moving = self._held = self._amplitudes = None
        self._failed = why
        raise NotPredicted(why)

    def _mean_inputs(self, tow: MovingTow, begin: float, end: float) -> MeanInputs:
        along = CorrectedInputs(tow.inputs, self._point.errors, self._point.drifts)
        return along.mean(begin, end)

    def _hold(self, mean: MeanInputs) -> HeldGear:
        """Equilibrium of mean inputs, that found last where it is near enough."""
        held = self._held
        if held is None or np.any(np.abs(mean.values - held.inputs) > NEARBY):
            self._held = held = self._sought(mean)
            self.equilibria.append(held.equilibrium)
        return held

    def _sought(self, mean: MeanInputs) -> HeldGear:
        """Equilibrium of mean inputs, sought from one known nearby, that found last, and without.

        That found last may be far away, and lead to another branch with the least change.
        """
        starts = *self._gear.nearest(mean.values), *self.equilibria[-1:]
        for start in starts:
            try:
                return hold_gear(self._gear, self._point, mean, self.channels, start)
            except NoSteadyState:
                continue
        return hold_gear(self._gear, self._point, mean, self.channels)

    def _in_steady(self, tow: MovingTow, stretch: int) -> Linearisation:
        """Means of a steady stretch."""
        begin, end = stretch * tow.stretch_s, (stretch + 1) * tow.stretch_s
        # The net's depth follows the speed in many minutes, and the log scatters more than the
        # ship's speed changes while it is held.
        mean = self._mean_inputs(tow, end - tow.held_s[stretch], end)
        last, held = self._held, self._hold(mean)
        if self._moving is not None:
            departure = self._parts(self._moving, self._moving.seen).plus(held.at(mean), -1.0)
            self._amplitudes = departure.through(held.projection)
            self._moving, self._since = None, begin
        elif self._amplitudes is None:
            self._amplitudes = unknown_amplitudes(int(tow.steady_part[stretch]))
            self._since = begin
        elif last is not None and last is not held:
            self._carry(last, begin, held.projection)
        self._failed = ''
        left = held.decayed(self._amplitudes, begin + 0.5 * tow.stretch_s - self._since)
        return held.at(mean).plus(left.through(held.shapes))

    def _in_motion(self, tow: MovingTow, stretch: int) -> Linearisation:
        """Means of a moving stretch."""
        begin = stretch * tow.stretch_s
        if self._moving is None:
            self._moving = self._begun(tow, begin)
        moving = self._moving
        step_s, weights = tow.steps_of(stretch)
        instants = moving.advance_to(begin + tow.stretch_s, step_s)
        if moving.fallen:
            self._fail('a board of the model falls over')
        if moving.surfaced:
            raise NotPredicted('the gear of the model breaks the surface')
        means = self._parts(moving, moving.average(instants, weights, begin))
        if np.any(
            np.abs(means.by['coefficients']) > UNSTABLE_DERIVATIVE * tow.noise[stretch][:, None]
        ):
            self._fail('the motion of the model is unstable')
        return means

    def _begun(self, tow: MovingTow, begin: float) -> MovingGear:
        """Motion begun in the equilibrium before a stretch."""
        point, gear = self._point, self._gear
        inputs = CorrectedInputs(tow.inputs, point.errors, point.drifts, begin)
        course, start = MovingCourse(inputs), None
        if self._held is None:
            self._amplitudes = unknown_amplitudes(0)
        else:
            since = begin - tow.held_s[round(begin / tow.stretch_s) - 1]
            course.first = self._mean_inputs(tow, since, begin)
            start = self._held.equilibrium

        noted = None
        if self._guides is not None:
            noted = self.guides[begin] = TowGuide()

        def observed(towed: DifferentiatedTow) -> MotionPrediction:
            return gear.observed(towed, course(towed.time).situation, self.channels)

        towed = DifferentiatedTow(
            gear.model_at(point), gear.parameters(course.names, motions=SLOW_MOTIONS), course,
            gear.with_added_mass(point.added_mass), start,
            guide=None if self._guides is None else self._guides.get(begin), noted=noted,
        )  # fmt: skip
        moving = MovingGear(towed, course, observed, self.channels)
        if self._held is not None:
            shapes = moving.seen.slopes[:, towed.parameters.of_motions]
            self._carry(self._held, begin, projection(shapes, self.channels))
        return moving

    def _carry(self, held: HeldGear, time: float, onto: FloatArray) -> None:
        """Carry the amplitudes of an equilibrium's motions to a time, as those of another's.

        The shapes of a motion that is alike on both sides, but for its sign, have any sign.
        """
        assert self._amplitudes is not None
        left = held.decayed(self._amplitudes, time - self._since)
        self._amplitudes, self._since = left.through(onto @ held.shapes), time

    def _parts(self, moving: MovingGear, found: MotionPrediction) -> Linearisation:
        """Prediction with what is left of the slowest motions from before."""
        parameters = moving.towed.parameters
        by = self._gear.parts(found.slopes, parameters)
        by.update(moving.input_slopes(found.slopes))
        plain = Linearisation(found.values, by)
        if self._amplitudes is None:
            return plain
        return plain.plus(self._amplitudes.through(found.slopes[:, parameters.of_motions]))


def linearise_tow(
    gear: TowedGear,
    tow: MovingTow,
    point: TowedPoint,
    required: BoolArray | None = None,
    on_stretch: Callable[[int], None] = lambda number: None,
) -> LinearisedTow:
    """Predict a tow from beginning to end, with derivatives.

    Parameters
    ----------
    gear
        The gear that is towed.
    tow
        Inputs and stretches.
    point
        Point of linearisation.
    required
        Flags (n,) of stretches that may not be left out, none where None.
    on_stretch
        Called after each stretch, with its number.

    Raises
    ------
    NoSteadyState
        If a stretch that is required must be left out.
    """
    lineariser = TowLineariser(gear, tow.channels, point, on_stretch)
    lineariser.extend(tow, point.drifts, required=required)
    return lineariser.linearised(tow)
