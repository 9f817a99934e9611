# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Whitening filter: innovations of a tow that goes on, and what a signature leaves in them.

A Kalman filter over all that may be wrong without an effect: coefficients as far as they are
known, errors of counters and log, calibration, and the processes of `estimation/motion`. What an
effect changes passes through the same filter, and comes out as its mark on the innovations.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import solve_triangular

from trawl_ros.core.arrays import BoolArray, FloatArray, Slice
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.knowledge import STATED, Knowledge
from trawl_ros.diagnosis.onset.responses import LEAP_TAPS, LOG_TAPS, OnsetResponses
from trawl_ros.diagnosis.onset.stretches import (
    LIVE,
    CounterLeap,
    LastStretch,
    counter_leap_shares,
)
from trawl_ros.diagnosis.onset.towing import TowedStretch
from trawl_ros.estimation.fit.error_terms import GROUPS, group_of
from trawl_ros.estimation.motion.processes import STATE_SHARE, ErrorTimes
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.records.channels import CHANNELS, INPUTS

MOST_ABSORBED = 6
"""Values of effects that are known already and taken along, at most."""

INPUT_TIMES = (600.0, 600.0, 900.0)
"""Correlation times (s) of the errors of both counters and of the log that change along the way."""

STATE_LEAP, LEAPS = 0.5, {'door_spread': 1.5}
"""Std of what a channel is wrong by more or less in the next state of a tow, in its bias: assumed,
and of the spread as measured at a dock (0.6 m, `config/instruments/default.yaml`)."""

RUNNING, UNREST_S = 3.0, 150.0
"""Factor on the model's own error while winches run or speed changes, and time in which it fades:
derivatives are less exact then, and a gear that is not the model differs more."""

LEANING, LEANING_S = 3.0, 30.0
"""Std of what boards that lean over in passing change, when winches or speed begin to change, in
the model's own error, and time in which it fades. Boards near their stall were 6 to 10 of it off in
pitch and roll in one stretch, depths and spread 8 in the next, and nothing in the third: as part of
what fades in minutes that spoke for a slope of the lift, of a rarity of 8.2; with this, of 6.4."""

APART = 0.5
"""Std of what the model is wrong by on one side more than on both, in what it is on both."""

AWAY = 0.2
"""Part of what a channel changes by boards as they were learned, and as they may be still, for
which that is wrong: derivatives are of the boards that the model is towed with."""

MOST_LEAP_M = 3.4
"""Four std of how a counter leaps from one state to the next: measured ones are wrong by 0.6 m in
each (`config/instruments/default.yaml`)."""

COUNTER_STD_M = LIVE.counter_std_m
"""Std of those of the counters, as for the fit in motion."""


@dataclass(frozen=True)
class Whitened:
    """Innovations (r,) of a stretch, white and of unit size, with what made them so.

    Attributes
    ----------
    residual
        As they are.
    root : (r, r) array
        Lower root of their covariance, as wide as none of them is beyond `MAX_INNOVATION`.
    rows
        Flags (k,) of the watched channels that are among them.
    gain : (s, r) array
        Of the filter.
    """

    residual: FloatArray
    root: FloatArray
    rows: BoolArray
    gain: FloatArray
    model: FloatArray

    def whitened(self, innovations: FloatArray) -> FloatArray:
        """Innovations (r, ...) in units of their own errors."""
        flat = innovations.reshape(len(self.root), -1)
        white = solve_triangular(self.root, flat, lower=True, check_finite=False)
        return np.asarray(white.reshape(innovations.shape), np.float64)


@dataclass(frozen=True)
class FilterState:
    """State of the filter: estimates (s,), their covariance (s, s), and how far the gear is from
    its rest.
    """

    mean: FloatArray
    variance: FloatArray
    unrest: float


class WhiteningFilter:
    """Whitening filter.

    Parameters
    ----------
    known
        The boards, and how large errors are, as they are known.
    responses
        Of the gear, to errors of the log and to counters that leap.
    inflation
        Factor on the std of all errors that are stated.
    state
        To begin in; by default nothing is known but ``known``.

    Attributes
    ----------
    unrest
        1 while winches or speed change; it fades within `UNREST_S`.
    """

    def __init__(
        self,
        known: Knowledge,
        responses: OnsetResponses,
        inflation: float,
        state: FilterState | None = None,
    ) -> None:
        self._start, self._responses, self._inflation = known.values, responses, inflation
        self._sizes = known.sizes
        # Averaging wears errors that neighbouring readings share down as slowly as in windows.
        self._least = {
            name: density / np.sqrt(LIVE.stretch_s) for name, density in known.densities.items()
        }
        covariance = known.covariance
        self._known = np.linalg.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance)))
        self.mean = np.zeros(self.size)
        self.variance = np.eye(self.size)
        self.variance[self._absorbed, self._absorbed] = 0.0
        for part in self._leaps:
            self.variance[part, part] = 0.0
        self.unrest = 0.0
        if state is not None:
            self.mean, self.variance = state.mean.copy(), state.variance.copy()
            self.unrest = state.unrest

    @property
    def state(self) -> FilterState:
        """State as it is."""
        return FilterState(self.mean.copy(), self.variance.copy(), self.unrest)

    @cached_property
    def _starts(self) -> tuple[int, ...]:
        return _starts(len(self._start))

    @property
    def size(self) -> int:
        """Number of states s."""
        return self._starts[-1]

    def _part(self, number: int) -> Slice:
        return slice(self._starts[number], self._starts[number + 1])

    @property
    def _absorbed(self) -> Slice:
        return self._part(7)

    @property
    def _leaps(self) -> tuple[Slice, Slice]:
        """Slices of the leaps of both counters, by the stretches since."""
        return self._part(8), self._part(9)

    @property
    def calibrations(self) -> Slice:
        """Slice of the calibration of each watched channel."""
        return self._part(4)

    @property
    def coefficients(self) -> FloatArray:
        """Coefficients (q,) by the present estimate."""
        values: FloatArray = self._start + self._known @ self.mean[self._part(0)]
        return values

    @property
    def covariance(self) -> FloatArray:
        """Covariance (q, q) of the coefficients."""
        own = self._part(0)
        found: FloatArray = self._known @ self.variance[own, own] @ self._known.T
        return found

    def loosen(self) -> None:
        """Take calibration for as little known as at the beginning."""
        diagonal = np.einsum('ii->i', self.variance)
        diagonal[self.calibrations] += 1.0

    def begin_state(self) -> None:
        """Take sensors for wrong by another amount: winches or speed begin to change.

        The dock where they were measured says so of the spread; leaps of counters are seen.
        """
        diagonal = np.einsum('ii->i', self.variance)
        leaps = np.array([LEAPS.get(name, STATE_LEAP) for name in WATCHED])
        more = _by_channel(self._sizes.state) / _by_channel(STATED.state)
        diagonal[self.calibrations] += np.square(leaps * more)

    def absorb(self, number: int, scale: float) -> None:
        """Take a value along that has been found, of a size up to ``scale``."""
        place = self._absorbed.start + number
        self.variance[place], self.variance[:, place] = 0.0, 0.0
        self.variance[place, place] = scale**2
        self.mean[place] = 0.0

    def step(
        self, means: FloatArray, noise: FloatArray, towed: TowedStretch | None,
        linearised_at: FloatArray, last: LastStretch, absorbed: FloatArray,
    ) -> Whitened | None:  # fmt: skip
        """Advance by a stretch.

        Parameters
        ----------
        means, noise
            Of the watched channels (k,), NaN where there is no reading.
        towed
            The model; None where there is no prediction.
        linearised_at
            Coefficients (q,) with which it was towed.
        last
            The stretch: its log's error, and how its counters leapt.
        absorbed : (k, `MOST_ABSORBED`) array
            Signatures of what is taken along.

        Returns
        -------
        Whitened or None
            Innovations; None where nothing could be compared.
        """
        self.advance(self.mean)
        self._spread(last.log_std)
        fading = np.exp(-LIVE.stretch_s / UNREST_S)
        self.unrest = 1.0 if any(last.moves) else self.unrest * float(fading)
        for number, leap in enumerate(last.leaps):
            self._leap(number, leap)
        if towed is None:
            return None
        rows = np.isfinite(means) & np.isfinite(noise)
        if not rows.any():
            return None
        model = self._model(towed, absorbed, linearised_at)[rows]
        shift = towed.by_coefficients @ (self._start - linearised_at)
        residual = (means - towed.values - shift)[rows] - model @ self.mean
        own = np.array([CHANNELS[name].noise for name in WATCHED])
        least = [self._least.get(name, 0.0) for name in WATCHED]
        scatter = np.maximum(_by_channel(self._sizes.noise) * noise, least)
        drift = _by_channel(self._sizes.drift) * own
        leaning = LEANING * self.unrest ** (UNREST_S / LEANING_S) * towed.model_error
        white = (self._inflation**2 * (scatter**2 + drift**2) + leaning**2)[rows]
        root = np.linalg.cholesky(model @ self.variance @ model.T + np.diag(white))
        # A reading far off is one at the edge of errors that large: in the filter and in all that
        # a signature leaves in it, or what explains such readings would not be what made them.
        far = np.maximum(np.abs(solve_triangular(root, residual, lower=True)) / MAX_INNOVATION, 1.0)
        # The filter is moved as by the edge itself: where boards are not known yet, all is far off.
        known = solve_triangular(root, model @ self.variance, lower=True) / far[:, None]
        gain = solve_triangular(root, known, trans='T', lower=True).T
        wider = root * np.sqrt(far**2 - 1.0)
        errors = np.diag(white) + wider @ wider.T
        root = root * far
        self.mean = self.mean + gain @ residual
        kept = np.eye(self.size) - gain @ model
        self.variance = kept @ self.variance @ kept.T + gain @ errors @ gain.T
        return Whitened(residual, root, rows, gain, model)

    def advance(self, states: FloatArray) -> None:
        """Advance states (s, ...) in time by a stretch, in place."""
        states *= self._decay.reshape(-1, *(1,) * (states.ndim - 1))
        for taps in (self._part(3), *self._leaps):
            states[taps] = np.roll(states[taps], 1, axis=0)
            states[taps.start] = 0.0

    @cached_property
    def _decay(self) -> FloatArray:
        """Factors (s,) of the states from one stretch to the next."""
        decay, times = np.ones(self.size), ErrorTimes()
        decay[self._part(2)] = np.exp(-LIVE.stretch_s / np.array(INPUT_TIMES))
        decay[self._part(5)] = np.exp(-LIVE.stretch_s / times.state)
        decay[self._part(6)] = np.exp(-LIVE.stretch_s / times.model)
        return decay

    def _spread(self, log_std: float) -> None:
        """Advance the covariance in time by a stretch."""
        self.advance(self.variance)
        self.advance(self.variance.T)
        diagonal = np.einsum('ii->i', self.variance)
        for number in (2, 5, 6):
            part = self._part(number)
            diagonal[part] += 1.0 - self._decay[part] ** 2
        log_std = max(self._sizes.log * log_std, self._least.get('speed', 0.0))
        diagonal[self._part(3).start] = (log_std * self._inflation) ** 2

    def _leap(self, number: int, leap: CounterLeap) -> None:
        """Take a counter for wrong by so much more, which the gear begins to be towed with."""
        unit = COUNTER_STD_M * self._inflation
        both = [self._part(2).start + number, self._leaps[number].start]
        # More than instruments leap is left to candidates.
        usual = abs(leap.length) < MOST_LEAP_M
        self.mean[both] += leap.length / unit if usual else 0.0
        self.variance[np.ix_(both, both)] += (leap.std / unit) ** 2

    def _model(
        self, towed: TowedStretch, absorbed: FloatArray, linearised_at: FloatArray
    ) -> FloatArray:
        """Change of the watched channels (k, s) by each state of unit size."""
        k = len(WATCHED)
        bias = np.array(
            [
                CHANNELS[name].bias_std(value)
                for name, value in zip(WATCHED, towed.values, strict=True)
            ]
        )
        errors = [error.name for error in INPUT_ERRORS]
        offsets = [errors.index(f'{name} offset') for name in INPUTS]
        per_unit = towed.by_inputs[:, offsets] / [INPUT_ERRORS[place].std for place in offsets]
        log = CHANNELS['speed'].bias_std(towed.situation.speed)
        sizes = np.array([COUNTER_STD_M, COUNTER_STD_M, self._sizes.log * STATE_SHARE * log])
        groups, apart = np.zeros((2, k, len(GROUPS)))
        worse = 1.0 + (RUNNING - 1.0) * self.unrest
        errors_of_model = worse * _by_channel(self._sizes.model) * towed.model_error
        moved = towed.by_coefficients @ (self.coefficients - linearised_at)
        still = np.einsum(
            'ki,ij,kj->k', towed.by_coefficients, self.covariance, towed.by_coefficients
        )
        errors_of_model = np.sqrt(errors_of_model**2 + AWAY**2 * (moved**2 + still))
        for row, name in enumerate(WATCHED):
            group = group_of(name)
            groups[row, GROUPS.index(group)] = errors_of_model[row]
            if name != group:
                way = 1.0 if name.startswith('port') else -1.0
                apart[row, GROUPS.index(group)] = way * APART * errors_of_model[row]
        stated = self._inflation
        return np.hstack(
            (
                towed.by_coefficients @ self._known,
                towed.by_inputs * stated,
                per_unit * sizes * stated,
                self._responses.log.T,
                np.diag(bias) * stated,
                # Leaps between states, as measured, are added where a state begins (`LEAPS`).
                np.diag(STATE_SHARE * bias * _by_channel(self._sizes.state)) * stated,
                np.hstack((groups, apart)) * stated,
                absorbed,
                -self._still_missing(per_unit[:, :2]) * COUNTER_STD_M * stated,
            )
        )

    def _still_missing(self, lasting: FloatArray) -> FloatArray:
        """Part (k, 2 l) missing since counters leapt, of what they change (k, 2) for long."""
        to_come = 1.0 - counter_leap_shares(LEAP_TAPS)
        missing = self._responses.counters + to_come[:, None, None] * lasting
        return np.hstack((missing[..., 0].T, missing[..., 1].T))


def _by_channel(sizes: Sequence[float]) -> FloatArray:
    """Sizes (k,) of the watched channels, of those of `GROUPS`."""
    return np.array([sizes[GROUPS.index(group_of(name))] for name in WATCHED])


def states_for(coefficients: int) -> int:
    """Number of states of a filter for so many coefficients."""
    return _starts(coefficients)[-1]


def _starts(coefficients: int) -> tuple[int, ...]:
    k = len(WATCHED)
    sizes = (
        coefficients, len(INPUT_ERRORS), len(INPUTS), LOG_TAPS, k, k, 2 * len(GROUPS),
        MOST_ABSORBED, LEAP_TAPS, LEAP_TAPS,
    )  # fmt: skip
    return tuple(int(one) for one in np.cumsum((0, *sizes)))


MAX_INNOVATION = 4.0
"""Size of whitened innovations, at most: one reading alone is no onset."""
