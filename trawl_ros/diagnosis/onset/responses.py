# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Responses of the gear to effects that begin, as they fade into those of effects long there.

What an effect changes after its onset is what it would change had it been there for long, less a
part that fades: a free motion of the gear. That part is taken from one steady state and added at
all times, as the motions that are slow hardly differ from state to state; it is no exact
derivative. `docs/onset.md` has the measured performance.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.diagnosis.onset.gear import ROWS, WatchedGear
from trawl_ros.diagnosis.onset.part import LIVE, counter_leap_shares
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.slow_mode import slow_mode

FOLLOWED = 20
"""Stretches through which responses are towed."""

STEP_S = 5.0
"""Step of that; a stretch is a whole number of it."""


@dataclass(frozen=True)
class OnsetResponses:
    """Responses to a step at the beginning of a stretch.

    Attributes
    ----------
    fading : (a, k, p) array
        Part of an effect long there that is still missing in the means of the stretches since,
        by the values of all effects.
    applied : (a, p) array
        Part of each value that the model's inputs have followed: 1 but for errors of counters,
        whose level in the minutes before they are.
    """

    fading: FloatArray
    applied: FloatArray

    def since(self, lasting: FloatArray, ages: IntArray, growing: FloatArray) -> FloatArray:
        """Signatures (n, k, p) of effects that began so many stretches (n,) ago.

        Parameters
        ----------
        lasting : (k, p) or (n, k, p) array
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
        ramps = lasting * (hours[:, None] - late[known])[:, None] - _grown(self.fading)[known]
        return np.where(growing > 0.0, ramps, steps)


def onset_responses(
    gear: WatchedGear, coefficients: FloatArray, inputs: FloatArray, oldest: int
) -> OnsetResponses:
    """Responses at a steady state.

    Parameters
    ----------
    gear, coefficients
        Gear that is towed.
    inputs : (3,) array
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
    parameters = MotionParameters(effects=gear.towed.examined)
    point = InputPoint(inputs, np.zeros(3), hours=1.0)
    motion = DifferentiatedTow(
        gear.model.with_coefficients(coefficients), parameters, lambda time: point, gear.acting
    )
    lasting, own = motion.observed(), parameters.of_effects
    motion.forget(own)
    steps, slopes = round(LIVE.stretch_s / STEP_S), [motion.observed().slopes]
    for _ in range(FOLLOWED * steps):
        motion.advance(STEP_S)
        slopes.append(motion.observed().slopes)
    # The first of the two derivatives at an onset is that before it.
    means = 0.5 * (np.array(slopes[1:]) + np.array(slopes[:-1]))
    towed = means.reshape(FOLLOWED, steps, *means.shape[1:]).mean(axis=1)
    missing = (lasting.slopes - towed)[:, ROWS, own]
    shown, at = lasting.values[ROWS], point.situation
    # Errors of sensors show at once: they are not missing, and came in with each.
    at_once = gear.by_values(np.zeros_like(missing[0]), shown, at)
    fading = np.array([gear.by_values(one, shown, at) for one in missing]) - at_once
    # Beyond the towed stretches only the slowest motion is left.
    decay_s = max(slow_mode(motion.model, motion.first).decay_s, STEP_S)
    more = np.arange(1, max(oldest - FOLLOWED, 0) + 1)
    tail = fading[-1] * np.exp(-more * LIVE.stretch_s / decay_s)[:, None, None]
    fading = np.concatenate((fading, tail))
    shares, counted = counter_leap_shares(oldest), gear.counted(at)
    fading[..., counted] = _followed(fading[..., counted], shares)
    applied = np.where(counted, shares[:, None], 1.0)
    return OnsetResponses(fading, applied)


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
