# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Responses of the gear to effects that begin, as they fade into those of effects long there.

What an effect changes after its onset is what it would change had it been there for long, less a
part that fades: a free motion of the gear. That part is taken from one steady state and added at
all times, as the motions that are slow hardly differ from state to state; it is no exact
derivative. `docs/onset.md` has the measured performance.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.diagnosis.onset.stretches import LIVE, counter_leap_shares
from trawl_ros.diagnosis.onset.towing import ROWS, WatchedGear
from trawl_ros.effects.base.effect import Situation
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.records.channels import INPUTS
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.slow_mode import slow_mode

FOLLOWED = 20
"""Stretches through which responses are towed."""

STEP_S = 5.0
"""Step of that; a stretch is a whole number of it."""

LOG_TAPS = 8
"""Stretches for which an error of the log in one stretch is felt."""

LEAP_TAPS = 24
"""Stretches since a counter leapt in which the gear does not yet rest with that."""


ERRORS = [error.name for error in INPUT_ERRORS]


@dataclass(frozen=True)
class OnsetResponses:
    """Responses to a step at the beginning of a stretch.

    Attributes
    ----------
    fading : (a, k, p) array
        Part of an effect long there that is still missing in the means of the stretches since,
        by the values of all effects.
    grown : (a, k, p) array
        Integral of that over time, in hours, up to the middle of each stretch.
    log : (t, k) array
        Means of the stretches since by a log that shows 1 m/s too much in one stretch alone.
    applied : (a, p) array
        Part of each value that the model's inputs have followed: 1 but for errors of counters,
        whose level in the minutes before they are.
    counters : (l, k, 2) array
        Part of what each counter changes by 1 m too much for long that is still missing since it
        leapt by that, of what inputs have followed.
    """

    fading: FloatArray
    grown: FloatArray
    log: FloatArray
    applied: FloatArray
    counters: FloatArray

    def only(self, columns: Sequence[int]) -> 'OnsetResponses':
        """Responses to some of the values alone."""
        own = list(columns)
        return replace(
            self, fading=self.fading[..., own], grown=self.grown[..., own],
            applied=self.applied[:, own],
        )  # fmt: skip

    def since(self, lasting: FloatArray, ages: IntArray, growing: FloatArray) -> FloatArray:
        """Signatures (n, k, p) of effects that began so many stretches (n,) ago.

        Parameters
        ----------
        lasting : (k, p) array
            Change by effects that have been there for long.
        ages
            0 in the stretch with whose beginning the effect begins.
        growing : (p,) array
            1 for values with which an effect grows, else 0.
        """
        hours = (ages + 0.5) * LIVE.stretch_s / 3600.0
        known = np.minimum(ages, len(self.fading) - 1)
        steps = lasting * self.applied[known, None] - self.fading[known]
        late = _grown(1.0 - self.applied)
        ramps = lasting * (hours[:, None] - late[known])[:, None] - self.grown[known]
        signatures: FloatArray = steps * (1.0 - growing) + ramps * growing
        return signatures


def onset_responses(
    gear: WatchedGear,
    coefficients: FloatArray,
    inputs: tuple[float, float, float],
    oldest: int,
) -> OnsetResponses:
    """Responses at a steady state.

    Parameters
    ----------
    gear, coefficients
        Gear that is towed.
    inputs
        Warp lengths (m) and speed (m/s) of the state.
    oldest
        Stretches to which responses are known.

    Raises
    ------
    NoSteadyState
        If there is no such state.
    StepFailed
        If its motion cannot be computed.
    """
    parameters = gear.parameters
    point = _held(inputs)
    motion = DifferentiatedTow(
        gear.model.with_coefficients(coefficients), parameters, lambda time: point, gear.acting
    )
    lasting = motion.observed()
    own = parameters.of_effects, parameters.of_inputs
    motion.forget(slice(own[0].start, own[1].stop))
    steps, towed = round(LIVE.stretch_s / STEP_S), []
    last = motion.observed().slopes
    for _ in range(FOLLOWED):
        seen = [last]
        for _ in range(steps):
            motion.advance(STEP_S)
            seen.append(motion.observed().slopes)
        last = seen[-1]
        # The first of the two derivatives at an onset is that before it.
        means = np.array([0.5 * (a + b) for a, b in itertools.pairwise(seen)])
        towed.append(np.mean(means, axis=0))
    missing = lasting.slopes - np.array(towed)
    at = Situation(inputs, hours=1.0)
    shown = [gear.by_values(one[:, own[0]], lasting.values, at) for one in missing]
    # Errors of sensors show at once: they are not missing, and came in with each.
    nothing = gear.by_values(np.zeros_like(missing[0][:, own[0]]), lasting.values, at)
    # Beyond the towed stretches only the slowest motion is left.
    decay_s = max(slow_mode(motion.model, motion.first).decay_s, STEP_S)
    fading = _with_tail(np.array(shown) - nothing, oldest, decay_s)
    shares = counter_leap_shares(oldest)
    counted = gear.counted(at)
    fading[..., counted] = _followed(fading[..., counted], shares)
    applied = np.where(counted, shares[:, None], 1.0)
    places = [ERRORS.index(f'{name} offset') for name in INPUTS[:2]]
    stds = [INPUT_ERRORS[place].std for place in places]
    columns = [own[1].start + place for place in places]
    leapt = _with_tail(missing[:, ROWS][:, :, columns] / stds, LEAP_TAPS, decay_s)
    counters = _followed(leapt, shares[:LEAP_TAPS])
    log = _of_log(gear, np.array(towed), own[1].start)
    return OnsetResponses(fading, _grown(fading), log, applied, counters)


def _grown(values: FloatArray) -> FloatArray:
    """Integral over time, in hours, of values (a, ...) up to the middle of each stretch."""
    hours = LIVE.stretch_s / 3600.0
    total: FloatArray = hours * (np.cumsum(values, axis=0) - 0.5 * values)
    return total


def _followed(steps: FloatArray, shares: FloatArray) -> FloatArray:
    """Return the part still missing (a, k, m) since a counter leapt.

    Its course has followed by ``shares`` (a,); ``steps`` (a, k, m) is the part missing since a
    course leapt.
    """
    still = np.zeros_like(steps)
    for age, part in enumerate(np.diff(shares, prepend=0.0)):
        still[age:] += part * steps[: len(steps) - age]
    return still


def _of_log(gear: WatchedGear, towed: FloatArray, first: int) -> FloatArray:
    place = ERRORS.index('speed offset')
    # A log that shows too much is a ship that is slower; by a std of that error.
    steps = towed[:LOG_TAPS, :, first + place][:, ROWS] / INPUT_ERRORS[place].std
    pulses: FloatArray = np.diff(steps, axis=0, prepend=0.0)
    return pulses


def _held(inputs: tuple[float, float, float]) -> InputPoint:
    additions = np.zeros((len(INPUT_ERRORS), 3))
    for row, error in enumerate(INPUT_ERRORS):
        column = INPUTS.index(error.channel)
        additions[row, column] = -error.std * (inputs[column] if error.relative else 1.0)
    return InputPoint(
        np.array(inputs), np.zeros(3), hours=1.0,
        errors=additions, error_rates=np.zeros_like(additions),
    )  # fmt: skip


def _with_tail(fading: FloatArray, oldest: int, decay_s: float) -> FloatArray:
    """Extend the fading parts of `FOLLOWED` stretches to the ``oldest``.

    They fall to 1/e in ``decay_s``.
    """
    more = np.arange(1, max(oldest - len(fading), 0) + 1)
    tail = fading[-1] * np.exp(-more * LIVE.stretch_s / decay_s)[:, None, None]
    return np.concatenate((fading, tail))
