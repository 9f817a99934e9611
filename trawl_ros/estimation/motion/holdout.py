# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hold-out of steady states from a fit in motion, at the place where its tows are linearised."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.fit.linearised import measured_inputs
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.linear_problem import Place
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.information import LinearGroup
from trawl_ros.estimation.motion.processes import GroupRows
from trawl_ros.estimation.motion.sizes import LinearData
from trawl_ros.estimation.motion.steps import linear_problem
from trawl_ros.estimation.motion.towing.inputs import corrected
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.windows.records import SteadyWindow

Predict = Callable[[FloatArray, Sequence[SteadyWindow], FloatArray | None, FloatArray], FloatArray]
"""Channels of eq. 35 (n, 4) in windows, by coefficients (q,), factors (2,) on drag and weight
of the net, None where these are held, and warp lengths (m) and speed (m/s) (n, 3)."""


def hold_out_states(
    fit: MotionFit,
    prior: ParameterVector,
    windows: Sequence[SteadyWindow],
    tow_of: Sequence[tuple[int, ...]],
    predict: Predict,
    options: MotionOptions,
) -> FloatArray:
    """Predict each window by a fit without its tow, or its state where there is one tow.

    A state is left out with the motion that led to it: from the end of the state before to its own
    end. The tows are not towed again. Counters and log err in it as in the rest of its tow, and not
    at all where no part of that is left: so it is for the windows (`Estimator.inputs_of`).

    Parameters
    ----------
    fit, prior
        The fit in motion.
    windows
        Steady windows (n).
    tow_of
        Of each tow of the fit, the numbers of its tows among the windows.
    predict
        Predicts windows.
    options
        With which the tows were fitted.
    """
    predicted = np.full((len(windows), len(PAPER_CHANNELS)), np.nan)
    folds, tows = folds_of(windows), {window.tow for window in windows}
    if len(folds) < 2:
        return predicted
    for fold in folds:
        hidden = {window.tow for window in windows if window.state in fold}
        keep = [
            np.zeros(len(linear.tow), np.bool_)
            if len(tows) > 1 and hidden & set(numbers)
            else ~_stretches(linear.tow, windows, fold, numbers)
            for linear, numbers in zip(fit.linear, tow_of, strict=True)
        ]
        data = restricted(fit.data, keep)
        problem = linear_problem(data, fit.parameters, prior, fit.sizes, options.largest_step)
        there = problem.target()
        rows = [i for i, window in enumerate(windows) if window.state in fold]
        values = prior.start + prior.std * there[0][: len(prior)]
        net = fit.layouts[0].net(there[0]) if fit.net else None
        left_out = [windows[i] for i in rows]
        inputs = np.array([_inputs(fit, there, window, tow_of) for window in left_out])
        predicted[rows] = predict(values, left_out, net, inputs)
    return predicted


def folds_of(windows: Sequence[SteadyWindow], folds: int = 5, seed: int = 0) -> list[set[int]]:
    """States of windows that are left out together: those of a tow.

    Of a single tow they are dealt to folds in a random order, so that a fold is not one warp length
    at all speeds. With fewer states than folds each is left out alone.
    """
    tows = sorted({window.tow for window in windows})
    if len(tows) > 1:
        return [{window.state for window in windows if window.tow == tow} for tow in tows]
    states = np.random.default_rng(seed).permutation(sorted({w.state for w in windows}))
    parts = np.array_split(states, min(folds, max(len(states), 1)))
    return [set(part.tolist()) for part in parts]


def _inputs(
    fit: MotionFit, place: Place, window: SteadyWindow, tow_of: Sequence[tuple[int, ...]]
) -> FloatArray:
    """Warp lengths and speed (3,) of a window, corrected for their errors.

    The errors are those in the part of its tow that is nearest to it.
    """

    def away(number: int) -> float:
        tow = fit.linear[number].tow
        end = (window.end_ns - tow.start_ns) / SECOND
        return max(-end, end - len(tow) * tow.stretch_s)

    shown = measured_inputs(window)
    parts = [number for number, numbers in enumerate(tow_of) if window.tow in numbers]
    if not parts:
        return shown
    nearest = min(parts, key=away)
    return corrected(shown, place[nearest][fit.layouts[nearest].slices['errors']])


def _stretches(
    tow: MovingTow, windows: Sequence[SteadyWindow], states: set[int], numbers: Sequence[int]
) -> BoolArray:
    """Flags (n,) of the stretches that belong to states, with what led to them."""
    flags = np.zeros(len(tow), np.bool_)
    own = sorted((w for w in windows if w.tow in numbers), key=lambda window: window.end_ns)
    before = -np.inf
    for number, window in enumerate(own):
        end = (window.end_ns - tow.start_ns) / SECOND
        if window.state in states:
            flags |= (tow.middles > before) & (tow.middles <= end)
        if number + 1 == len(own) or own[number + 1].state != window.state:
            before = end
    return flags


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
