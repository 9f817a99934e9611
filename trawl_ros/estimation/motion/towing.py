"""Linearised tow in motion: means of its stretches, with derivatives by all that is towed."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.effects.effect_set import NO_EFFECTS, ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.motion.inputs import INPUT_ERRORS, CorrectedInputs
from trawl_ros.estimation.motion.records import LeftOut, MovingTow
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import fallen_boards
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.stepper import StepFailed

ADDED_MASS = catalogue()['board_added_mass']

AGAIN_S = 120.0
"""Time after which a tow that could not go on is begun anew."""

SETTLING_S = 300.0
"""Time that a tow which is begun anew is given before its stretches count: by then the slowest
motion, which is unknown there, has faded."""

AFTER_A_STOP = 'the tow of the model was begun anew after a stop'

HIGHEST_M = 0.0
"""Height above which a node has broken the surface."""


@dataclass(frozen=True)
class TowedGear:
    """Gear that is towed: the model as its file has it, with the effects that are there.

    ``motions`` is the number of slow motions with which a tow may begin.
    """

    model: GearModel
    acting: EffectSet = NO_EFFECTS
    motions: int = 0

    def with_added_mass(self, part: float) -> EffectSet:
        """Effects with an added mass of the boards beside that in the gear file."""
        known = self.acting.of(ADDED_MASS).values
        return self.acting.having(ActiveEffect(ADDED_MASS, known + part))


@dataclass(frozen=True)
class TowedPoint:
    """Point at which a tow is linearised.

    ``coefficients`` (12,), ``added_mass`` as a part of the cylinder of water around a board,
    ``errors`` (e,) of the inputs in std, ``drifts`` (knots,) their errors at all knots, SI.
    """

    coefficients: FloatArray
    added_mass: float
    errors: FloatArray
    drifts: FloatArray


@dataclass(frozen=True)
class LinearisedTow:
    """Tow at a point, in n stretches by k channels.

    Attributes
    ----------
    tow, point
        The tow, and where it is linearised.
    values : (n, k) array
        Predicted means; NaN in stretches that are left out.
    by_coefficients : (n, k, 12) array
    by_added_mass : (n, k, 1) array
    by_errors : (n, k, e) array
        By a std of each of `INPUT_ERRORS`.
    by_knots : (n, k, knots) array
        By an input's error at each knot, per SI unit.
    by_motions : (n, k, motions) array
        By a metre of each slow motion at the beginning.
    left_out
        Stretches that the model cannot tow, and why.
    """

    tow: MovingTow
    point: TowedPoint
    values: FloatArray
    by_coefficients: FloatArray
    by_added_mass: FloatArray
    by_errors: FloatArray
    by_knots: FloatArray
    by_motions: FloatArray
    left_out: tuple[LeftOut, ...]

    @property
    def towed(self) -> BoolArray:
        """Flags (n,) of the stretches that are not left out."""
        return np.asarray(np.isfinite(self.values).any(axis=1), np.bool_)

    @property
    def residual(self) -> FloatArray:
        """Measured minus predicted means (n, k), NaN where either is missing."""
        return self.tow.means - self.values


@dataclass
class _Motion:
    """Motion under way: the tow, when (s) it began, and when its stretches begin to count."""

    towed: DifferentiatedTow
    inputs: CorrectedInputs
    counts_from: float
    _newest: dict[str, int] = field(default_factory=dict)
    _newest_from: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for knots in self.inputs.inputs.knots:
            self._newest[knots.channel] = knots.acting(self.time).stop - 1

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


def linearise_tow(
    gear: TowedGear,
    tow: MovingTow,
    point: TowedPoint,
    required: BoolArray | None = None,
    on_stretch: Callable[[int], None] = lambda number: None,
) -> LinearisedTow:
    """Tow the gear along a tow's inputs, and linearise.

    Where the motion cannot be computed, a board falls over or the gear breaks the surface,
    stretches are left out. Behind the former two the tow is begun anew, in the equilibrium of the
    inputs there.

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
    rows = [OBSERVABLES.index(name) for name in tow.channels]
    n, k, number = len(tow), len(tow.channels), tow.inputs.number_of_knots
    result = LinearisedTow(
        tow, point,
        np.full((n, k), np.nan), np.zeros((n, k, 12)), np.zeros((n, k, 1)),
        np.zeros((n, k, len(INPUT_ERRORS))), np.zeros((n, k, number)),
        np.zeros((n, k, gear.motions)), (),
    )  # fmt: skip
    left_out: list[LeftOut] = []
    needed = np.zeros(n, bool) if required is None else required
    motion: _Motion | None = None
    again = 0.0

    def leave_out(stretch: int, why: str) -> None:
        begin = stretch * tow.stretch_s
        if needed[stretch]:
            raise NoSteadyState(f'{begin:.0f} s after the beginning {why}')
        left_out.append(LeftOut(begin, begin + tow.stretch_s, why))

    for stretch in range(n):
        begin = stretch * tow.stretch_s
        try:
            if motion is None and begin < again:
                leave_out(stretch, AFTER_A_STOP)
                continue
            if motion is None:
                motion = _begin(gear, tow, point, begin, stretch > 0)
                seen = [_observed(motion.towed, rows)]
            taken = list(_towed_on(motion, tow, stretch, rows))
        except (NoSteadyState, StepFailed) as error:
            leave_out(stretch, f'the model cannot be towed: {error}')
            motion, again = None, begin + AGAIN_S
            continue
        instants, seen = [seen[-1], *taken], taken
        if motion.fallen and not gear.model.paired:
            leave_out(stretch, 'a board of the model falls over')
            motion, again = None, begin + AGAIN_S
            continue
        if motion.surfaced:
            leave_out(stretch, 'the gear of the model breaks the surface')
        elif begin < motion.counts_from:
            leave_out(stretch, AFTER_A_STOP)
        else:
            _average(result, stretch, motion, instants)
        on_stretch(stretch)
    return LinearisedTow(**{**vars(result), 'left_out': tuple(left_out)})


def _begin(gear: TowedGear, tow: MovingTow, point: TowedPoint, begin: float, anew: bool) -> _Motion:
    inputs = CorrectedInputs(tow.inputs, point.errors, point.drifts, begin)
    parameters = MotionParameters(
        coefficients=True,
        effects=(ADDED_MASS,),
        inputs=inputs.names,
        motions=0 if anew else gear.motions,
    )
    model = gear.model.with_coefficients(point.coefficients)
    towed = DifferentiatedTow(model, parameters, inputs, gear.with_added_mass(point.added_mass))
    return _Motion(towed, inputs, begin + SETTLING_S if anew else 0.0)


def _towed_on(
    motion: _Motion, tow: MovingTow, stretch: int, rows: list[int]
) -> Iterator[MotionPrediction]:
    every = tow.every(stretch)
    for _ in range(0, tow.steps, every):
        motion.advance(every * tow.step_s)
        yield _observed(motion.towed, rows)


def _observed(towed: DifferentiatedTow, rows: list[int]) -> MotionPrediction:
    observed = towed.observed()
    return MotionPrediction(observed.values[rows], observed.slopes[rows])


def _average(
    result: LinearisedTow, stretch: int, motion: _Motion, instants: list[MotionPrediction]
) -> None:
    """Fill in a stretch from its instants."""
    weights, towed = result.tow.weights_of(stretch), motion.towed
    values = np.array([instant.values for instant in instants])
    slopes = np.array([instant.slopes for instant in instants])
    for column in motion.begun_since(stretch * result.tow.stretch_s):
        # The column of the newest knot was another's until this stretch began.
        slopes[0, :, column] = 0.0
    result.values[stretch] = np.einsum('ki,ik->k', weights, values)
    mean = np.einsum('ki,ikm->km', weights, slopes)
    parameters = towed.parameters
    result.by_coefficients[stretch] = mean[:, parameters.of_coefficients]
    result.by_added_mass[stretch] = mean[:, parameters.of_effects]
    of_inputs = mean[:, parameters.of_inputs]
    result.by_errors[stretch] = of_inputs[:, : len(INPUT_ERRORS)]
    for knots, own, first in result.tow.inputs.knot_places:
        for knot in knots.acting(motion.time - 1e-6):
            column = of_inputs[:, first + knot % knots.columns]
            result.by_knots[stretch][:, own.start + knot] = column
    motions = mean[:, parameters.of_motions]
    result.by_motions[stretch][:, : motions.shape[1]] = motions
