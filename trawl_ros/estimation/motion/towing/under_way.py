"""Motion of the model under way along a tow's inputs, which may become longer meanwhile."""

from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.towing.inputs import CorrectedInputs, TowInputs
from trawl_ros.estimation.motion.towing.records import SETTLING_S
from trawl_ros.model.observables import fallen_boards
from trawl_ros.solver.motion.course import InputPoint
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
    """Motion under way: the tow, its inputs, when (s) its stretches begin to count and why they do
    not before, and since when its derivatives are held, where they are.
    """

    towed: DifferentiatedTow
    course: InputsUnderWay
    counts_from: float
    held_since: float | None = None
    settles: str = AFTER_A_STOP
    _newest: dict[str, int] = field(default_factory=dict)
    _newest_from: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for knots in self.inputs.inputs.knots:
            self._newest[knots.channel] = knots.acting(self.time).stop - 1

    @property
    def inputs(self) -> CorrectedInputs:
        """Inputs as they are now."""
        return self.course.inputs

    def follow(self, inputs: TowInputs, drifts: FloatArray) -> None:
        """Go on along inputs that have become longer, with errors at their knots."""
        self.course.inputs = replace(self.inputs, inputs=inputs, drifts=drifts)

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
        """True where a board lies on its face or back."""
        return any(fallen_boards(self.towed.motion.state))

    @property
    def surfaced(self) -> bool:
        """True where a node has broken the surface."""
        return bool(np.max(self.towed.motion.state.nodes[:, 2]) > HIGHEST_M)
