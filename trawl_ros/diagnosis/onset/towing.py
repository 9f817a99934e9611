# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
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
from trawl_ros.estimation.motion.towing.lineariser import BY_SENSOR, UNSTABLE_DERIVATIVE
from trawl_ros.estimation.motion.towing.moving import MovingCourse, MovingGear
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.effect_sensitivity import shown_values
from trawl_ros.solver.motion.course import InputPoint, by_values
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.stepper import StepFailed

SETTLING_S = 300.0
"""Time (s) that a tow of the model is given before its stretches are compared: what the gear did
before is not known."""

AGAIN_S = 120.0
"""Time (s) after which a tow of the model that has ended begins again."""

AFTER_A_FALL = 'boards had fallen shortly before'

ROWS = [OBSERVABLES.index(name) for name in WATCHED]


@dataclass(frozen=True)
class TowedStretch:
    """Stretch as the model was towed along it.

    Attributes
    ----------
    values : (k,) array
        Means of the watched channels by the model, weighted as their readings came.
    by_coefficients : (k, q) array
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
        board = self.model.board.law.parameters.names
        return MotionParameters(coefficients=board, effects=self.moving, inputs=errors)

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
        Of its boards (q,).

    Attributes
    ----------
    stopped
        Number of the stretch along which it could not be towed last; -1 before any.
    """

    def __init__(self, gear: WatchedGear, coefficients: FloatArray) -> None:
        self._gear = gear
        self._parameters = gear.parameters
        self._motion: MovingGear | None = None
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
            return 'the tow of the model is begun again after a stop'
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
        try:
            found = self._towed(self._motion, last.tow, last.place)
        except StepFailed as reason:
            self._stop(last)
            return f'the model cannot be towed: {reason}'
        if self._motion.fallen or (isinstance(found, str) and found == BY_SENSOR):
            self._stop(last)
        return found

    def _stop(self, last: LastStretch) -> None:
        self._motion, self.stopped = None, last.number
        self._again = last.number + round(AGAIN_S / LIVE.stretch_s)

    def _begun(self, last: LastStretch, tow: MovingTow) -> MovingGear | None:
        """Motion at the beginning of a stretch; None where a board falls on the way there."""
        course = MovingCourse(without_errors(replace(tow.inputs, knots=())))
        model = self._gear.model.with_coefficients(self._coefficients)
        towed = DifferentiatedTow(model, self._parameters, course, self._gear.acting)
        port, starboard, speed = map(float, course(0.0).inputs)
        self._began = (port, starboard, speed)
        motion = MovingGear(towed, course, DifferentiatedTow.observed)
        motion.advance_to(last.place * tow.stretch_s, tow.step_s)
        return None if motion.fallen else motion

    def _towed(self, motion: MovingGear, tow: MovingTow, place: int) -> TowedStretch | str:
        """Readings of the model in a stretch, or the reason why it has none."""
        if place in tow.fallen:
            return BY_SENSOR
        now = place * tow.stretch_s
        # Time counts from where the model began to be towed, for what grows with it.
        hours = (motion.towed.time - now) / 3600.0
        motion.follow(replace(tow.inputs, knots=(), hours=hours), np.zeros(0), now)
        # Channels without a reading in this stretch take the plain mean; nothing is compared.
        step_s, of_tow = tow.steps_of(place)
        weights = np.full((len(OBSERVABLES), of_tow.shape[1]), 1.0 / of_tow.shape[1])
        noise = np.full(len(OBSERVABLES), np.nan)
        columns = zip(tow.channels, of_tow, tow.noise[place], strict=True)
        for name, own, scatter in columns:
            if np.isfinite(own).all() and own.sum() > 0.5:
                weights[OBSERVABLES.index(name)] = own
                noise[OBSERVABLES.index(name)] = scatter

        seen = motion.advance_to(now + tow.stretch_s, step_s)
        if motion.fallen:
            return 'a board of the model falls over'
        if motion.surfaced:
            return 'the gear of the model breaks the surface'
        mean = motion.average(seen, weights, now)
        unstable = (
            np.abs(mean.slopes[:, self._parameters.of_coefficients])
            > UNSTABLE_DERIVATIVE * noise[:, None]
        )
        if np.any(unstable):
            return 'the motion of the model is unstable'
        return self._stretch(motion.course(motion.towed.time), mean.values, mean.slopes)

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
