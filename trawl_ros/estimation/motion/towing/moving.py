# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Moving part of a tow: the motion of the model along inputs, which may become longer meanwhile."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.towing.held import projection
from trawl_ros.estimation.motion.towing.inputs import (
    INPUT_ERRORS,
    CorrectedInputs,
    MeanInputs,
    TowInputs,
)
from trawl_ros.model.observables import fallen_boards
from trawl_ros.records.channels import INPUTS
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.tow import DifferentiatedTow

HIGHEST_M = 0.0
"""Height (m) above which a node has broken the surface."""


@dataclass
class MovingCourse:
    """Course along which the model is towed; it may become longer on the way.

    ``first`` are the mean inputs of the equilibrium in which the motion begins; those at its
    beginning where None.
    """

    inputs: CorrectedInputs
    first: MeanInputs | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the additions to the inputs; the last three are those to the first alone."""
        firsts = () if self.first is None else tuple(f'first {name}' for name in INPUTS)
        return (*self.inputs.names, *firsts)

    def __call__(self, time: float) -> InputPoint:
        """Inputs so many seconds after the motion began."""
        point = self.inputs(time)
        if self.first is None:
            return point
        additions, paces = (
            np.vstack((own, np.zeros((3, 3)))) for own in (point.errors, point.error_rates)
        )
        if time > 0.0:
            return replace(point, errors=additions, error_rates=paces)
        additions[:], paces[:] = 0.0, 0.0
        additions[-3:] = np.eye(3)
        return replace(
            point, inputs=self.first.values, rates=np.zeros(3), yaw_rate=0.0,
            errors=additions, error_rates=paces,
        )  # fmt: skip


@dataclass
class MovingGear:
    """Gear in motion.

    Attributes
    ----------
    towed, course
        The tow of the model, and its inputs.
    observe
        Gives what is observed of the tow where it is.
    channels
        Names of the observables; not needed of inputs without knots.
    seen
        Observables now.
    """

    towed: DifferentiatedTow
    course: MovingCourse
    observe: Callable[[DifferentiatedTow], MotionPrediction]
    channels: tuple[str, ...] = ()
    _newest: dict[str, int] = field(default_factory=dict)
    _newest_from: dict[str, float] = field(default_factory=dict)
    _left: dict[str, dict[int, FloatArray]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for knots in self.inputs.inputs.knots:
            self._newest[knots.channel] = knots.acting(self.time).stop - 1
        self.seen = self.observe(self.towed)

    @property
    def inputs(self) -> CorrectedInputs:
        """Inputs as they are now."""
        return self.course.inputs

    def follow(self, inputs: TowInputs, drifts: FloatArray, time: float | None = None) -> None:
        """Follow inputs that have become longer, with errors at their knots.

        Where they begin at another time, ``time`` (s) is the present one in theirs, and none of
        them has knots.
        """
        later = 0.0 if time is None else time - self.time
        begin = self.inputs.begin + later
        self.course.inputs = replace(self.inputs, inputs=inputs, drifts=drifts, begin=begin)

    @property
    def time(self) -> float:
        """Time of the tow, s."""
        return self.inputs.begin + self.towed.time

    def advance(self, h: float) -> None:
        """Advance by a step; knots that begin to act take the columns of those forgotten.

        The slowest motions outlast the columns: what a knot leaves of them is kept as amplitudes.
        """
        for knots, _, first in self.inputs.inputs.knot_places:
            newest = knots.acting(self.time + 0.5 * h).stop - 1
            if newest > self._newest[knots.channel]:
                self._newest[knots.channel] = newest
                self._newest_from[knots.channel] = self.time
                column = self._of_inputs + first + newest % knots.columns
                if newest >= knots.columns:
                    shapes = self.seen.slopes[:, self.towed.parameters.of_motions]
                    left = projection(shapes, self.channels) @ self.seen.slopes[:, column]
                    self._left.setdefault(knots.channel, {})[newest - knots.columns] = left
                self.towed.forget(slice(column, column + 1))
        self.towed.advance(h)

    def advance_to(self, end: float, step_s: float) -> list[MotionPrediction]:
        """Advance to a time (s) in steps; return what is observed at the beginning and after each.

        Raises
        ------
        StepFailed
            If not even short steps converge.
        """
        instants = [self.seen]
        while self.time < end - 1e-6:
            left = end - self.time
            self.advance(left if left < step_s - 1e-6 else step_s)
            self.seen = self.observe(self.towed)
            instants.append(self.seen)
        return instants

    def average(
        self, instants: list[MotionPrediction], weights: FloatArray, begin: float
    ) -> MotionPrediction:
        """Weighted mean of instants from a time (s) on, by weights (k, s + 1)."""
        values = np.array([instant.values for instant in instants])
        slopes = np.array([instant.slopes for instant in instants])
        for column in self._begun_since(begin):
            # The column of the newest knot was another's until this stretch began.
            slopes[0, :, column] = 0.0
        return MotionPrediction(
            np.einsum('ki,ik->k', weights, values), np.einsum('ki,ikm->km', weights, slopes)
        )

    def input_slopes(self, slopes: FloatArray) -> dict[str, FloatArray]:
        """Derivatives by the errors (k, e) of the inputs, and by all knots (k, number) of each.

        Parameters
        ----------
        slopes : (k, m) array
            Derivatives of the motion.
        """
        of_inputs, first_mean = slopes[:, self.towed.parameters.of_inputs], self.course.first
        found = {'errors': of_inputs[:, : len(INPUT_ERRORS)]}
        if first_mean is not None:
            found['errors'] = found['errors'] + of_inputs[:, -3:] @ first_mean.by_errors.T
        for knots, _, first in self.inputs.inputs.knot_places:
            every = np.zeros((len(slopes), knots.number))
            acting = knots.acting(self.time - 1e-6)
            columns = [first + knot % knots.columns for knot in acting]
            every[:, acting.start : acting.stop] = of_inputs[:, columns]
            for knot, left in self._left.get(knots.channel, {}).items():
                every[:, knot] += slopes[:, self.towed.parameters.of_motions] @ left
            if first_mean is not None:
                weights = first_mean.by_knots[knots.channel]
                by_first = of_inputs[:, INPUTS.index(knots.channel) - len(INPUTS)]
                every[:, : len(weights)] += np.outer(by_first, weights)
            found[knots.channel] = every
        return found

    def _begun_since(self, begin: float) -> list[int]:
        """Columns of the knots that have begun to act since a time (s)."""
        return [
            self._of_inputs + first + self._newest[knots.channel] % knots.columns
            for knots, _, first in self.inputs.inputs.knot_places
            if self._newest_from.get(knots.channel, -np.inf) >= begin - 1e-6
        ]

    @property
    def _of_inputs(self) -> int:
        return self.towed.parameters.of_inputs.start

    @property
    def fallen(self) -> bool:
        """True where a board lies on its face or back; no board of two ships stands for one."""
        return not self.towed.model.paired and any(fallen_boards(self.towed.motion.state))

    @property
    def surfaced(self) -> bool:
        """True where a node has broken the surface."""
        return bool(np.max(self.towed.motion.state.nodes[:, 2]) > HIGHEST_M)
