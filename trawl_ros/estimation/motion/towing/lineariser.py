"""Lineariser of tows in motion: means of stretches, with derivatives by all that is towed."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.motion.towing.halved import TowHalved
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS, CorrectedInputs
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.records import SETTLING_S, LeftOut, MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import ADDED_MASS, TowedGear, TowedPoint
from trawl_ros.estimation.motion.towing.towed_means import TowedMeans, average_of
from trawl_ros.estimation.motion.towing.towed_stretch import (
    AGAIN_S,
    BY_SENSOR,
    NotTowed,
    refused_if_unstable,
    tow_along,
)
from trawl_ros.estimation.motion.towing.under_way import (
    AFTER_A_STOP,
    InputsUnderWay,
    MotionUnderWay,
)
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.effect_sensitivity import sensor_slopes, shown_values
from trawl_ros.solver.motion.parameters import NET, MotionParameters
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.stepper import StepFailed


class TowLineariser:
    """Tow of the gear along inputs, linearised stretch by stretch; a tow may grow between.

    Where boards fall, at sea or in the model, derivatives do not hold: they stay as they were
    before, the model is towed on, and stretches are left out until its derivatives have settled
    again. Where it lies for long, or no step leads on, the tow is begun anew in the equilibrium of
    the inputs there. Stretches in which the gear breaks the surface are left out too.

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
        self._again = 0.0
        self._means: list[TowedMeans | None] = []
        self._left_out: list[LeftOut] = []

    def __len__(self) -> int:
        return len(self._means)

    def extend(
        self,
        tow: MovingTow,
        drifts: FloatArray,
        most: int | None = None,
        required: BoolArray | None = None,
        spare: int = 0,
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
        spare
            Number of those that may be left out nonetheless.

        Returns
        -------
        int
            Number of stretches that were towed along.

        Raises
        ------
        NoSteadyState
            As soon as more stretches that are required must be left out than may be.
        """
        first = len(self)
        last = len(tow) if most is None else min(len(tow), first + most)
        self._point = replace(self._point, drifts=drifts)
        if self._motion is not None:
            self._motion.follow(tow.inputs, drifts)
        for stretch in range(first, last):
            found = self._towed(tow, stretch)
            if isinstance(found, NotTowed):
                begin = stretch * tow.stretch_s
                spare -= required is not None and bool(required[stretch])
                if spare < 0:
                    raise NoSteadyState(f'{begin:.0f} s after the beginning {found.why}')
                self._left_out.append(LeftOut(begin, begin + tow.stretch_s, found.why))
            self._means.append(None if isinstance(found, NotTowed) else found)
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

    def _towed(self, tow: MovingTow, stretch: int) -> TowedMeans | NotTowed:
        """Tow along a stretch; the means, or the reason for which it is left out."""
        begin, fell = stretch * tow.stretch_s, stretch in tow.fallen
        if self._motion is None and (fell or begin < self._again):
            return NotTowed(BY_SENSOR if fell else AFTER_A_STOP)
        try:
            motion = self._motion = self._motion or self._begun(tow, begin)
        except (NoSteadyState, StepFailed) as error:
            self._again = begin + AGAIN_S
            return NotTowed(f'the model cannot be towed: {error}')

        def averaged(instants: list[MotionPrediction]) -> TowedMeans | NotTowed:
            means = average_of(tow, stretch, motion, instants)
            return refused_if_unstable(means.by_coefficients, tow.noise[stretch]) or means

        before = motion.towed.factorisations
        found = tow_along(motion, tow, stretch, averaged)
        self.factorisations += motion.towed.factorisations - before
        if isinstance(found, NotTowed) and found.ends:
            self._motion, self._again = None, begin + AGAIN_S
        return found

    def _begun(self, tow: MovingTow, begin: float) -> MotionUnderWay:
        gear, point, anew = self._gear, self._point, begin > 0.0
        course = InputsUnderWay(CorrectedInputs(tow.inputs, point.errors, point.drifts, begin))
        parameters = MotionParameters(
            coefficients=True,
            net=bool(gear.net_std),
            effects=(ADDED_MASS, *gear.examined),
            inputs=course.inputs.names,
            motions=0 if anew else gear.motions,
        )
        acting = gear.with_added_mass(point.added_mass)
        halved = self._halved.setdefault(begin, set())
        towed = DifferentiatedTow(gear.model_at(point), parameters, course, acting, halved=halved)
        counts_from = begin + SETTLING_S if anew else 0.0
        return MotionUnderWay(towed, course, partial(self._observed, course), counts_from)

    def _observed(self, course: InputsUnderWay, towed: DifferentiatedTow) -> MotionPrediction:
        observed, acting = towed.observed(), self._gear.acting
        values, slopes = observed.values, observed.slopes
        if acting.on_sensors:
            at = course(towed.time).situation
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
