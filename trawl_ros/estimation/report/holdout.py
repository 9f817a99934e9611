# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hold-out errors: prediction of whole tows, or whole steady states, left out of the fit."""

from dataclasses import replace

import numpy as np

from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS, paper_values, stack
from trawl_ros.estimation.motion.holdout import HeldOut, dealt

NEAR_ENOUGH = 0.1
"""Step, in std, at which fits for hold-out have converged."""

PREDICTED = 0.2
"""Std of a reading within which they take first order for it: the errors of what is left out are
those of fits at rest to a hundredth, with three quarters of the steady states that 0.1 needs."""

STEPS = 3
"""They start at the rest of all windows, from where the first step leads nearly all the way."""


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
    tows = sorted({window.tow for window in windows})
    several = len(tows) > 1
    parts = [{w.state for w in windows if w.tow == tow} for tow in tows]
    left = parts if several else dealt(sorted(states), folds, seed)
    found = HeldOut(
        'tow' if several else 'state', len(tows) if several else len(states),
        stack([paper_values(window.means) for window in windows]), predicted,
        np.array([window.tow for window in windows]),
    )  # fmt: skip
    if found.groups < 2:
        return found
    options = replace(
        estimator.options,
        relinearise_final=PREDICTED,
        tolerance=NEAR_ENOUGH,
        iterations_final=STEPS,
        # They are stopped before they are at rest.
        second_start=False,
    )
    for number, left_out in enumerate(left):
        on_progress(WorkProgress('leaving out, one after another', number, len(left), 'fits'))
        rest = estimator.subset(states - left_out, options)
        if rest.finish() is None:
            continue
        rows = [i for i, window in enumerate(windows) if window.state in left_out]
        unseen = [windows[i] for i in rows]
        inputs = rest.inputs_of(unseen)
        predicted[rows] = rest.predictions(rest.coefficients, unseen, inputs=inputs)
    return found
