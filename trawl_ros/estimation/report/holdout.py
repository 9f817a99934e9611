# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hold-out errors: prediction of whole tows, or whole steady states, left out of the fit."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS, stack
from trawl_ros.estimation.motion.holdout import folds_of
from trawl_ros.estimation.windows.records import SteadyWindow

NEAR_ENOUGH = 0.1
"""Step, in std, at which fits for hold-out have converged."""

PREDICTED = 0.2
"""Std of a reading within which they take first order for it: the errors of what is left out are
those of fits at rest to a hundredth, with three quarters of the steady states that 0.1 needs."""

STEPS = 3
"""They start at the rest of all windows, from where the first step leads nearly all the way."""


@dataclass(frozen=True)
class HeldOut:
    """Hold-out predictions of the windows left out.

    Attributes
    ----------
    by
        'tow' or 'state'.
    groups
        Number of tows or states.
    predicted : (n, 4) array
        In the order of `PAPER_CHANNELS`, NaN where a fit or a steady state is missing.
    """

    by: str = 'tow'
    groups: int = 0
    predicted: FloatArray = field(default_factory=lambda: stack(()))


def held_out_by(windows: Sequence[SteadyWindow], predicted: FloatArray) -> HeldOut:
    """Hold-out by tows where there are several, else by states, with predictions (n, 4)."""
    by = 'tow' if len({window.tow for window in windows}) > 1 else 'state'
    return HeldOut(by, len({getattr(window, by) for window in windows}), predicted)


def hold_out(
    estimator: Estimator,
    folds: int = 5,
    seed: int = 0,
    on_progress: OnProgress = ignore,
) -> HeldOut:
    """Predict each window by a fit without any window of its tow.

    With a single tow it is the window's steady state that the fit has not seen: less of a
    test, since errors of calibration are the same throughout a tow.

    Parameters
    ----------
    estimator
        With all its windows and at rest; it is left as it is.
    folds
        Parts into which the states of a single tow are divided; with fewer states each is left
        out alone. Of several tows each is.
    seed
        Of the random order in which states are dealt to the folds, so that a fold is not
        one warp length at all speeds.
    on_progress
        Called before each fit.
    """
    windows = estimator.windows
    predicted = np.full((len(windows), len(PAPER_CHANNELS)), np.nan)
    states = {window.state for window in windows}
    folds_of_states = folds_of(windows, folds, seed)
    if len(states) < 2:
        return held_out_by(windows, predicted)
    options = replace(
        estimator.options,
        relinearise_final=PREDICTED,
        tolerance=NEAR_ENOUGH,
        iterations_final=STEPS,
        # They are stopped before they are at rest.
        second_start=False,
    )
    for number, left_out in enumerate(folds_of_states):
        on_progress(
            WorkProgress('leaving out, one after another', number, len(folds_of_states), 'fits')
        )
        rest = estimator.subset(states - left_out, options)
        if rest.finish() is None:
            continue
        rows = [i for i, window in enumerate(windows) if window.state in left_out]
        unseen = [windows[i] for i in rows]
        inputs = rest.inputs_of(unseen)
        predicted[rows] = rest.predictions(rest.coefficients, unseen, inputs=inputs)
    return held_out_by(windows, predicted)
