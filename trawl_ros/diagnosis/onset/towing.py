"""Tow of the model along a tow that goes on, with derivatives by all that may begin in it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.library.drift import Drift
from trawl_ros.diagnosis.onset.candidates import WATCHED, AtOneHour
from trawl_ros.diagnosis.onset.stretches import LIVE, LastStretch
from trawl_ros.effects.base.effect import Effect, Situation, sense
from trawl_ros.effects.effect_set import EffectSet
from trawl_ros.estimation.fit.error_terms import MODEL_ANGLE, MODEL_FRACTION
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS, without_errors
from trawl_ros.estimation.motion.towing.records import SETTLING_S, MovingTow
from trawl_ros.estimation.motion.towing.towed_stretch import (
    AGAIN_S,
    BY_SENSOR,
    NotTowed,
    refused_if_unstable,
    tow_along,
)
from trawl_ros.estimation.motion.towing.under_way import (
    AFTER_A_FALL,
    InputsUnderWay,
    MotionUnderWay,
)
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.effect_sensitivity import shown_values
from trawl_ros.solver.motion.course import InputPoint, by_values
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.stepper import StepFailed

ROWS = [OBSERVABLES.index(name) for name in WATCHED]


@dataclass(frozen=True)
class TowedStretch:
    """Stretch as the model was towed along it.

    Attributes
    ----------
    values : (k,) array
        Means of the watched channels by the model, weighted as their readings came.
    by_coefficients : (k, 12) array
    by_inputs : (k, e) array
        By a std of each of `INPUT_ERRORS`.
    by_values : (k, p) array
        By the values of effects that have been there for long.
    situation
        Of the effects.
    """

    values: FloatArray
    by_coefficients: FloatArray
    by_inputs: FloatArray
    by_values: FloatArray
    situation: Situation

    @property
    def model_error(self) -> FloatArray:
        """Std (k,) of the model's own error."""
        return np.array(
            [
                MODEL_ANGLE if CHANNELS[name].unit == 'rad' else MODEL_FRACTION * abs(value)
                for name, value in zip(WATCHED, self.values, strict=True)
            ]
        )


@dataclass(frozen=True)
class WatchedGear:
    """Gear that is towed along: the model, the effects that are there, and those that may begin."""

    model: GearModel
    acting: EffectSet
    effects: tuple[Effect, ...]

    @property
    def moving(self) -> tuple[Effect, ...]:
        """Effects that act on the gear or on what it is towed with."""
        return tuple(effect for effect in self.effects if acts_on_gear(effect))

    @property
    def parameters(self) -> MotionParameters:
        """Parameters of the derivatives in time."""
        errors = tuple(error.name for error in INPUT_ERRORS)
        return MotionParameters(effects=self.moving, inputs=errors)

    def counted(self, at: Situation) -> BoolArray:
        """Flags (p,) of the values that change what counters show."""
        shown, flags = np.array(at.inputs), []
        for effect in self.effects:
            for place, parameter in enumerate(effect.parameters):
                values = effect.neutral
                values[place] += parameter.std
                true = effect.apply_to_inputs(values, shown.copy(), at)
                flags.append(not np.array_equal(true[:2], shown[:2]))
        return np.array(flags, np.bool_)

    def by_values(self, moved: FloatArray, shown: FloatArray, at: Situation) -> FloatArray:
        """Derivatives (k, p) of readings by the values of all effects.

        Parameters
        ----------
        moved : (n_observables, m) array
            Of the observables by the values of those that act on the gear.
        shown : (n_observables,) array
            Observables.
        at
            The situation.
        """
        parts, first = [], 0
        for effect in self.effects:
            part = np.zeros((len(OBSERVABLES), len(effect.parameters)))
            if acts_on_gear(effect):
                last = first + len(effect.parameters)
                part, first = part + moved[:, first:last], last
            if type(effect).apply_to_sensors is not Effect.apply_to_sensors:
                part = (
                    part
                    + by_values(self.acting, effect, lambda there: shown_values(there, shown, at)).T
                )
            parts.append(part)
        return np.hstack(parts)[ROWS]


def acts_on_gear(effect: Effect) -> bool:
    """True if an effect may act on the gear or on what it is towed with."""
    own = effect.of if isinstance(effect, AtOneHour) and effect.of is not None else effect
    if isinstance(own, Drift) and not any(own.inputs):
        return False
    kind = type(own)
    return kind.gear is not Effect.gear or kind.apply_to_inputs is not Effect.apply_to_inputs


class ModelTow:
    """Tow of the model, stretch by stretch.

    Parameters
    ----------
    gear
        Gear that is towed.
    coefficients
        Of its boards (12,).

    Attributes
    ----------
    stopped
        Number of the stretch along which it could not be towed last; -1 before any.
    """

    def __init__(self, gear: WatchedGear, coefficients: FloatArray) -> None:
        self._gear = gear
        self._parameters = gear.parameters
        self._motion: MotionUnderWay | None = None
        self._next = -1
        self.stopped, self._again = -1, 0
        self._coefficients = coefficients

    @property
    def steady(self) -> tuple[float, float, float] | None:
        """Warp lengths (m) and speed (m/s) of the equilibrium that the motion began in."""
        return None if self._motion is None else self._began

    @property
    def under_way(self) -> bool:
        """True while there is a motion to go on from."""
        return self._motion is not None

    def advance(self, last: LastStretch) -> TowedStretch | str:
        """Tow along a stretch.

        Where there is no motion to go on from, it begins in the equilibrium of the inputs of the
        oldest of the minutes before, which the slowest motions are given to fade in.

        Returns
        -------
        TowedStretch or str
            Readings of the model, or the reason why there is no prediction.
        """
        if last.tow is None:
            self._motion = None
            return last.why_not
        if last.number < self._again:
            return 'the tow of the model is begun anew after a stop'
        if self._motion is None or last.number != self._next:
            if last.place * LIVE.stretch_s < SETTLING_S - 1e-6:
                return 'what the gear did before is not known'
            if last.fell:
                return BY_SENSOR if last.place in last.tow.fallen else AFTER_A_FALL
            try:
                self._motion = self._begun(last, last.tow)
            except (NoSteadyState, StepFailed) as reason:
                self._stop(last)
                return f'the model cannot be towed: {reason}'
            if self._motion is None:
                self._stop(last)
                return 'a board of the model falls over'
        self._next = last.number + 1
        found = self._towed(self._motion, last.tow, last.place)
        if not isinstance(found, NotTowed):
            return found
        if found.ends:
            self._stop(last)
        return found.why

    def _stop(self, last: LastStretch) -> None:
        self._motion, self.stopped = None, last.number
        self._again = last.number + round(AGAIN_S / LIVE.stretch_s)

    def _begun(self, last: LastStretch, tow: MovingTow) -> MotionUnderWay | None:
        """Motion at the beginning of a stretch; None where a board falls on the way there."""
        course = InputsUnderWay(without_errors(replace(tow.inputs, knots=())))
        model = self._gear.model.with_coefficients(self._coefficients)
        towed = DifferentiatedTow(model, self._parameters, course, self._gear.acting)
        port, starboard, speed = map(float, course(0.0).inputs)
        self._began = (port, starboard, speed)
        motion = MotionUnderWay(towed, course, DifferentiatedTow.observed, counts_from=0.0)
        way = motion.towed_on(last.place * tow.stretch_s, tow.step_s)
        return None if any(motion.fallen for _ in way) else motion

    def _towed(self, motion: MotionUnderWay, tow: MovingTow, place: int) -> TowedStretch | NotTowed:
        now = place * tow.stretch_s
        # Time counts from where the model began to be towed, for what grows with it.
        hours = (motion.towed.time - now) / 3600.0
        motion.follow(replace(tow.inputs, knots=(), hours=hours), np.zeros(0), now)
        # Channels without a reading in this stretch take the plain mean; nothing is compared.
        weights = np.full((len(OBSERVABLES), tow.steps + 1), 1.0 / (tow.steps + 1))
        noise = np.full(len(OBSERVABLES), np.nan)
        columns = zip(tow.channels, tow.weights[place], tow.noise[place], strict=True)
        for name, own, scatter in columns:
            if np.isfinite(own).all() and own.sum() > 0.5:
                weights[OBSERVABLES.index(name)] = own
                noise[OBSERVABLES.index(name)] = scatter

        def averaged(seen: list[MotionPrediction]) -> TowedStretch | NotTowed:
            values = np.einsum('sn,ns->n', [one.values for one in seen], weights)
            slopes = np.einsum('snm,ns->nm', [one.slopes for one in seen], weights)
            refused = refused_if_unstable(slopes[:, self._parameters.of_coefficients], noise)
            return refused or self._stretch(motion.course(motion.towed.time), values, slopes)

        return tow_along(motion, tow, place, averaged)

    def _stretch(self, point: InputPoint, values: FloatArray, slopes: FloatArray) -> TowedStretch:
        own = self._parameters
        at = Situation(
            (float(point.inputs[0]), float(point.inputs[1]), float(point.inputs[2])),
            point.heading,
            sense(point.heading),
            1.0,
        )
        shown = shown_values(self._gear.acting, values, at)
        return TowedStretch(
            shown[ROWS],
            slopes[ROWS, own.of_coefficients],
            slopes[ROWS, own.of_inputs],
            self._gear.by_values(slopes[:, own.of_effects], values, at),
            at,
        )


def measured(last: LastStretch, names: Sequence[str] = WATCHED) -> tuple[FloatArray, FloatArray]:
    """Means (k,) of the watched channels in a stretch, and their noise; NaN where none."""
    means, noise = np.full((2, len(names)), np.nan)
    if last.tow is not None:
        for place, name in enumerate(names):
            if name in last.tow.channels:
                column = last.tow.channels.index(name)
                means[place] = last.tow.means[last.place, column]
                noise[place] = last.tow.noise[last.place, column]
    return means, noise
