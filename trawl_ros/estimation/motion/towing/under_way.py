"""Motion of the model under way along a tow's inputs, which may become longer meanwhile."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.towing.inputs import CorrectedInputs, TowInputs
from trawl_ros.estimation.motion.towing.records import SETTLING_S
from trawl_ros.model.observables import fallen_boards
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.slopes import MotionSlopes
from trawl_ros.solver.motion.tow import DifferentiatedTow

HIGHEST_M = 0.0
"""Height above which a node has broken the surface."""

AFTER_A_STOP = 'the tow of the model was begun anew after a stop'

AFTER_A_FALL = 'boards had fallen shortly before'


@dataclass
class InputsUnderWay:
    """Inputs along which the model is towed; they may become longer on the way."""

    inputs: CorrectedInputs

    def __call__(self, time: float) -> InputPoint:
        """Inputs so many seconds after the motion began."""
        return self.inputs(time)


@dataclass
class MotionUnderWay:
    """Motion under way.

    Attributes
    ----------
    towed, course
        The tow of the model, and its inputs.
    observe
        Gives what is observed of the tow where it is.
    counts_from, settles
        Time (s) from which its stretches count, and why they do not before.
    held_since
        Time (s) since which its derivatives are held, where they are.
    seen
        Observables now.
    """

    towed: DifferentiatedTow
    course: InputsUnderWay
    observe: Callable[[DifferentiatedTow], MotionPrediction]
    counts_from: float
    held_since: float | None = None
    settles: str = AFTER_A_STOP
    _newest: dict[str, int] = field(default_factory=dict)
    _newest_from: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for knots in self.inputs.inputs.knots:
            self._newest[knots.channel] = knots.acting(self.time).stop - 1
        self.seen = self.observe(self.towed)

    @property
    def inputs(self) -> CorrectedInputs:
        """Inputs as they are now."""
        return self.course.inputs

    def follow(self, inputs: TowInputs, drifts: FloatArray, time: float | None = None) -> None:
        """Go on along inputs that have become longer, with errors at their knots; where they begin
        at another time, ``time`` (s) is the present one in theirs, and none of them has knots.
        """
        later = 0.0 if time is None else time - self.time
        begin = self.inputs.begin + later
        self.course.inputs = replace(self.inputs, inputs=inputs, drifts=drifts, begin=begin)
        self.counts_from += later
        if self.held_since is not None:
            self.held_since += later

    @property
    def time(self) -> float:
        """Time of the tow, s."""
        return self.inputs.begin + self.towed.time

    def advance(self, h: float) -> None:
        """Advance by a step; knots that begin to act take the columns of those forgotten."""
        for knots, _, first in self.inputs.inputs.knot_places:
            newest = knots.acting(self.time + 0.5 * h).stop - 1
            if newest > self._newest[knots.channel]:
                self._newest[knots.channel] = newest
                self._newest_from[knots.channel] = self.time
                column = self._of_inputs + first + newest % knots.columns
                self.towed.forget(slice(column, column + 1))
        self.towed.advance(h)

    def towed_on(self, end: float, step_s: float) -> Iterator[MotionPrediction]:
        """Advance to a time (s) in steps; give what is observed behind each."""
        while self.time < end - 1e-6:
            left = end - self.time
            self.advance(left if left < step_s - 1e-6 else step_s)
            self.seen = self.observe(self.towed)
            yield self.seen

    def hold(self, derivatives: tuple[MotionSlopes, FloatArray], begin: float) -> None:
        """Hold the derivatives as they were at a time (s); what began to act since has none."""
        if self.held_since is None:
            self.held_since = begin
            self.towed.hold(*derivatives)
            for column in self.begun_since(begin):
                self.towed.forget(slice(column, column + 1))

    def release(self) -> None:
        """Go on with the derivatives, and let them settle before stretches count."""
        self.towed.release()
        self.held_since, self.counts_from = None, self.time + SETTLING_S
        self.settles = AFTER_A_FALL

    def begun_since(self, begin: float) -> list[int]:
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
