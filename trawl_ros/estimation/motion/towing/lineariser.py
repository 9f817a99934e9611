"""Lineariser of tows in motion: means of stretches, with derivatives by all that is towed."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.motion.towing.halved import TowHalved
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS, CorrectedInputs
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.records import LeftOut, MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import ADDED_MASS, TowedGear, TowedPoint
from trawl_ros.estimation.motion.towing.under_way import InputsUnderWay, MotionUnderWay
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.effect_sensitivity import sensor_slopes, shown_values
from trawl_ros.solver.motion.parameters import NET, MotionParameters
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.tow import DifferentiatedTow, HalvedSteps
from trawl_ros.solver.stepper import StepFailed

AGAIN_S = 120.0
"""Time after which a tow that could not go on is begun anew."""

SETTLING_S = 300.0
"""Time that a tow which is begun anew is given before its stretches count: by then the slowest
motion, which is unknown there, has faded."""

UNSTABLE = 1e6
"""Derivative of a mean by a coefficient, in its noise, from which a motion is unstable: behind a
tumble of boards derivatives may grow until normal equations are no longer definite."""

TOSSED = 8
"""Steps for each step of a tow, throughout a stretch, from which its boards are tossed about: where
they come to rest behind a jerk of the winches, four were enough."""

AFTER_A_STOP = 'the tow of the model was begun anew after a stop'


@dataclass(frozen=True)
class _TowedMeans:
    """Predicted means (k,) of a stretch with their derivatives; those by knots are each input's
    first knot that acts, and the derivatives (k, c) by it and those behind.
    """

    values: FloatArray
    by_coefficients: FloatArray
    by_added_mass: FloatArray
    by_errors: FloatArray
    by_knots: tuple[tuple[int, FloatArray], ...]
    by_motions: FloatArray
    by_net: FloatArray
    by_examined: FloatArray


class TowLineariser:
    """Tow of the gear along inputs, linearised stretch by stretch; a tow may grow between.

    Where the motion cannot be computed, a board falls over or the gear breaks the surface,
    stretches are left out. Behind the former two the tow is begun anew, in the equilibrium of the
    inputs there.

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
    halved
        Steps that were halved at other points and are at this; those that fail are added.

    Attributes
    ----------
    channels
        Measured channels.
    factorisations
        Matrices that were factorised so far.
    """

    def __init__(
        self,
        gear: TowedGear,
        channels: tuple[str, ...],
        point: TowedPoint,
        on_stretch: Callable[[int], None] = lambda number: None,
        halved: TowHalved | None = None,
    ) -> None:
        self._gear, self._point, self._on_stretch = gear, point, on_stretch
        self._halved: TowHalved = {} if halved is None else halved
        self.channels, self.factorisations = channels, 0
        self._rows = [OBSERVABLES.index(name) for name in channels]
        self._motion: MotionUnderWay | None = None
        self._seen: list[MotionPrediction] = []
        self._again = 0.0
        self._means: list[_TowedMeans | None] = []
        self._left_out: list[LeftOut] = []

    def __len__(self) -> int:
        return len(self._means)

    def extend(
        self,
        tow: MovingTow,
        drifts: FloatArray,
        most: int | None = None,
        required: BoolArray | None = None,
    ) -> int:
        """Tow on along a tow that has grown.

        Parameters
        ----------
        tow
            Inputs and stretches, of which the first have been towed along before.
        drifts
            Errors (knots,) of its inputs at all knots; those so far as they were.
        most
            Number of stretches that are towed along at most.
        required
            Flags (n,) of stretches that may not be left out, none where None.

        Returns
        -------
        int
            Number of stretches that were towed along.

        Raises
        ------
        NoSteadyState
            If a stretch that is required must be left out.
        """
        first = len(self)
        last = len(tow) if most is None else min(len(tow), first + most)
        self._point = replace(self._point, drifts=drifts)
        if self._motion is not None:
            self._motion.follow(tow.inputs, drifts)
        for stretch in range(first, last):
            found = self._towed(tow, stretch)
            if isinstance(found, str):
                begin = stretch * tow.stretch_s
                if required is not None and required[stretch]:
                    raise NoSteadyState(f'{begin:.0f} s after the beginning {found}')
                self._left_out.append(LeftOut(begin, begin + tow.stretch_s, found))
            self._means.append(None if isinstance(found, str) else found)
            if self._motion is not None:
                self._on_stretch(stretch)
        return max(last - first, 0)

    def linearised(self, tow: MovingTow) -> LinearisedTow:
        """Tow as it is linearised so far, of which all has been towed along."""
        n, k, number = len(tow), len(tow.channels), tow.inputs.number_of_knots
        gear = self._gear
        of_net = len(NET) if gear.net_std else 0
        examined = sum(len(effect.parameters) for effect in gear.examined)
        result = LinearisedTow(
            tow, self._point,
            np.full((n, k), np.nan), np.zeros((n, k, 12)), np.zeros((n, k, 1)),
            np.zeros((n, k, len(INPUT_ERRORS))), np.zeros((n, k, number)),
            np.zeros((n, k, gear.motions)), np.zeros((n, k, of_net)), np.zeros((n, k, examined)),
            tuple(self._left_out), self.factorisations,
        )  # fmt: skip
        places = tow.inputs.knot_places
        for stretch, means in enumerate(self._means[:n]):
            if means is None:
                continue
            result.values[stretch] = means.values
            result.by_coefficients[stretch] = means.by_coefficients
            result.by_added_mass[stretch] = means.by_added_mass
            result.by_errors[stretch] = means.by_errors
            for (_, own, _), (knot, slopes) in zip(places, means.by_knots, strict=True):
                at = own.start + knot
                result.by_knots[stretch][:, at : at + slopes.shape[1]] = slopes
            result.by_motions[stretch][:, : means.by_motions.shape[1]] = means.by_motions
            result.by_net[stretch] = means.by_net / self._point.net if of_net else 0.0
            result.by_examined[stretch] = means.by_examined
        return result

    def _towed(self, tow: MovingTow, stretch: int) -> _TowedMeans | str:
        """Tow along a stretch; the means, or the reason for which it is left out."""
        begin = stretch * tow.stretch_s
        if self._motion is None and begin < self._again:
            return AFTER_A_STOP
        try:
            if self._motion is None:
                halved = self._halved.setdefault(begin, set())
                self._motion = _begin(self._gear, tow, self._point, begin, stretch > 0, halved)
                self._seen = [self._observed(self._motion)]
            before = self._motion.towed.steps
            taken = list(self._towed_on(self._motion, tow))
        except (NoSteadyState, StepFailed) as error:
            self._stop(begin)
            return f'the model cannot be towed: {error}'
        motion = self._motion
        instants, self._seen = [self._seen[-1], *taken], taken
        if motion.fallen and not self._gear.model.paired:
            self._stop(begin)
            return 'a board of the model falls over'
        if motion.towed.steps - before >= TOSSED * tow.steps:
            self._stop(begin)
            return 'boards of the model are tossed about'
        if motion.surfaced:
            return 'the gear of the model breaks the surface'
        if begin < motion.counts_from:
            return AFTER_A_STOP
        means = _average(tow, stretch, motion, instants)
        sharp = np.abs(means.by_coefficients) / tow.noise[stretch][:, None]
        if np.any(sharp > UNSTABLE):
            self._stop(begin)
            return 'the motion of the model is unstable'
        return means

    def _stop(self, begin: float) -> None:
        self._motion, self._again = None, begin + AGAIN_S

    def _towed_on(self, motion: MotionUnderWay, tow: MovingTow) -> Iterator[MotionPrediction]:
        for _ in range(tow.steps):
            before = motion.towed.factorisations
            try:
                motion.advance(tow.step_s)
            finally:
                self.factorisations += motion.towed.factorisations - before
            yield self._observed(motion)

    def _observed(self, motion: MotionUnderWay) -> MotionPrediction:
        observed, acting = motion.towed.observed(), self._gear.acting
        values, slopes = observed.values, observed.slopes
        if acting.on_sensors:
            at = motion.course(motion.towed.time).situation
            slopes = sensor_slopes(acting, values, at) @ slopes
            values = shown_values(acting, values, at)
        return MotionPrediction(values[self._rows], slopes[self._rows])


def linearise_tow(
    gear: TowedGear,
    tow: MovingTow,
    point: TowedPoint,
    required: BoolArray | None = None,
    on_stretch: Callable[[int], None] = lambda number: None,
    halved: TowHalved | None = None,
) -> LinearisedTow:
    """Tow the gear along a tow's inputs from beginning to end, and linearise.

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
    halved
        Steps that were halved at other points and are at this; those that fail are added.

    Raises
    ------
    NoSteadyState
        If a stretch that is required must be left out.
    """
    lineariser = TowLineariser(gear, tow.channels, point, on_stretch, halved)
    lineariser.extend(tow, point.drifts, required=required)
    return lineariser.linearised(tow)


def _begin(
    gear: TowedGear,
    tow: MovingTow,
    point: TowedPoint,
    begin: float,
    anew: bool,
    halved: HalvedSteps,
) -> MotionUnderWay:
    course = InputsUnderWay(CorrectedInputs(tow.inputs, point.errors, point.drifts, begin))
    parameters = MotionParameters(
        coefficients=True,
        net=bool(gear.net_std),
        effects=(ADDED_MASS, *gear.examined),
        inputs=course.inputs.names,
        motions=0 if anew else gear.motions,
    )
    acting = gear.with_added_mass(point.added_mass)
    towed = DifferentiatedTow(gear.model_at(point), parameters, course, acting, halved=halved)
    return MotionUnderWay(towed, course, begin + SETTLING_S if anew else 0.0)


def _average(
    tow: MovingTow, stretch: int, motion: MotionUnderWay, instants: list[MotionPrediction]
) -> _TowedMeans:
    """Means of a stretch from its instants."""
    weights, parameters = tow.weights[stretch], motion.towed.parameters
    values = np.array([instant.values for instant in instants])
    slopes = np.array([instant.slopes for instant in instants])
    for column in motion.begun_since(stretch * tow.stretch_s):
        # The column of the newest knot was another's until this stretch began.
        slopes[0, :, column] = 0.0
    mean = np.einsum('ki,ikm->km', weights, slopes)
    of_effects, added = mean[:, parameters.of_effects], len(ADDED_MASS.parameters)
    of_inputs = mean[:, parameters.of_inputs]
    by_knots = []
    for knots, _, first in tow.inputs.knot_places:
        acting = knots.acting(motion.time - 1e-6)
        by_knots.append((acting.start, of_inputs[:, [first + k % knots.columns for k in acting]]))
    return _TowedMeans(
        values=np.einsum('ki,ik->k', weights, values),
        by_coefficients=mean[:, parameters.of_coefficients],
        by_added_mass=of_effects[:, :added],
        by_errors=of_inputs[:, : len(INPUT_ERRORS)],
        by_knots=tuple(by_knots),
        by_motions=mean[:, parameters.of_motions],
        by_net=mean[:, parameters.of_net],
        by_examined=of_effects[:, added:],
    )
