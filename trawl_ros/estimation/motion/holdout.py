# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hold-out of tows, or of the steady states of one, at the place where tows are linearised."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS, stack
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.information import LinearGroup
from trawl_ros.estimation.motion.processes import GroupRows
from trawl_ros.estimation.motion.sizes import LinearData
from trawl_ros.estimation.motion.steps import linear_problem

FOLDS_OF_ONE_TOW, SEED_OF_FOLDS = 5, 0
"""Parts into which the states of a single tow are dealt, and the seed of their random order."""


@dataclass(frozen=True)
class HeldOut:
    """Predictions of what was left out of a fit, in the channels of eq. 35.

    Attributes
    ----------
    by
        'tow' or 'state'.
    groups
        Number of tows or states.
    measured, predicted : (n, 4) arrays
        In the order of `PAPER_CHANNELS`; NaN where a fit or a steady state is missing.
    tows : (n,) int array
        Number of the tow of each row.
    """

    by: str = 'tow'
    groups: int = 0
    measured: FloatArray = field(default_factory=lambda: stack(()))
    predicted: FloatArray = field(default_factory=lambda: stack(()))
    tows: IntArray = field(default_factory=lambda: np.zeros(0, np.int64))


def dealt(
    states: Sequence[int], folds: int = FOLDS_OF_ONE_TOW, seed: int = SEED_OF_FOLDS
) -> list[set[int]]:
    """Deal states to folds in a random order, so that a fold is not one warp length at all speeds.

    With fewer states than folds each is left out alone.
    """
    order = np.random.default_rng(seed).permutation(sorted(set(states)))
    parts = np.array_split(order, min(folds, max(len(order), 1)))
    return [set(part.tolist()) for part in parts]


def hold_out_states(
    fit: MotionFit,
    prior: ParameterVector,
    tow_of: Sequence[int],
    options: MotionOptions,
) -> HeldOut:
    """Predict steady stretches by a fit without their tow, or their state where there is one tow.

    A state is left out with the motion that led to it: from the end of the state before to its own
    end. The tows are not towed again: predictions are of first order about the fit of all. Counters
    and log err in what is left out as in the rest of its tow; errors of its sensors are not
    corrected.

    Parameters
    ----------
    fit, prior
        The fit.
    tow_of
        Number of the tow of which each tow of the fit is a part.
    options
        With which the tows were fitted.
    """
    several = len(set(tow_of)) > 1
    states, before = [], 0
    for number, linear in zip(tow_of, fit.linear, strict=True):
        part = before + linear.tow.steady_part
        states.append(np.where(linear.tow.steady, number if several else part, -1))
        before = int(part[-1])
    every = np.unique(np.concatenate(states))
    every = every[every >= 0]
    folds = [{int(tow)} for tow in every] if several else dealt(every.tolist())
    predicted = [np.full(linear.values.shape, np.nan) for linear in fit.linear]
    for fold in folds if len(every) > 1 else ():
        hidden = [
            np.full(len(own), number in fold) if several else _led_to(own, fold)
            for number, own in zip(tow_of, states, strict=True)
        ]
        data = restricted(fit.data, [~flags for flags in hidden])
        problem = linear_problem(data, fit.parameters, prior, fit.sizes, options.largest_step)
        for number, z in enumerate(problem.target()):
            found = _predicted(fit, number, z)
            own = hidden[number] & (states[number] >= 0)
            predicted[number][own] = found[own]
    return _gathered(fit, predicted, states, tow_of, 'tow' if several else 'state', len(every))


def _led_to(states: IntArray, fold: set[int]) -> BoolArray:
    """Flags (n,) of the stretches of states in a fold, with those that led to them."""
    # A moving stretch belongs to the steady state behind it.
    own, state = np.zeros(len(states), np.int64), -1
    for stretch in reversed(range(len(states))):
        state = int(states[stretch]) if states[stretch] >= 0 else state
        own[stretch] = state
    return np.isin(own, sorted(fold))


def _predicted(fit: MotionFit, number: int, z: FloatArray) -> FloatArray:
    """Means (n, k) of a tow at parameters (p,), without errors of its sensors or of the model."""
    tow, slices = fit.linear[number].tow, fit.layouts[number].slices
    z = z.copy()
    z[slices['model']] = z[slices['calibration']] = 0.0
    found = np.full(tow.means.shape, np.nan)
    for group in fit.data.tows[number]:
        place = group.rows.stretches, group.rows.channels
        found[place] = tow.means[place] - group.residual + group.columns @ z
    return found


def _gathered(
    fit: MotionFit,
    predicted: Sequence[FloatArray],
    states: Sequence[IntArray],
    tow_of: Sequence[int],
    by: str,
    groups: int,
) -> HeldOut:
    """Stretches whose four channels of eq. 35 were all measured."""
    rows: list[tuple[FloatArray, FloatArray, IntArray]] = []
    for linear, values, state, tow in zip(fit.linear, predicted, states, tow_of, strict=True):
        measured = _paper_rows(linear.tow.means, linear.tow.channels)
        there = np.isfinite(measured).all(axis=1) & (state >= 0)
        found = _paper_rows(values, linear.tow.channels)
        rows.append((measured[there], found[there], np.full(int(there.sum()), tow)))
    measured, found, tows = (np.concatenate(part) for part in zip(*rows, strict=True))
    return HeldOut(by, groups, measured, found, tows)


def _paper_rows(means: FloatArray, channels: Sequence[str]) -> FloatArray:
    """Channels of eq. 35 (n, 4) by means (n, k)."""
    columns = []
    for row in PAPER_CHANNELS:
        own = [channels.index(name) for name in row.observables if name in channels]
        columns.append(means[:, own].mean(axis=1) if own else np.full(len(means), np.nan))
    return np.stack(columns, axis=1)


def restricted(data: LinearData, keep: Sequence[BoolArray]) -> LinearData:
    """Linearised tows with the flagged (n,) stretches of each alone."""
    tows = []
    for groups, flags in zip(data.tows, keep, strict=True):
        found = []
        for group in groups:
            rows = flags[group.rows.stretches]
            parts = {name: values[rows] for name, values in vars(group.rows).items()}
            found.append(LinearGroup(GroupRows(**parts), group.columns[rows], group.residual[rows]))
        tows.append(tuple(found))
    return replace(data, tows=tuple(tows))
