"""Errors on whole steady states that were left out of the fit."""

from dataclasses import replace

import numpy as np

from trawl_ros.identification.estimator import Estimator
from trawl_ros.identification.objective import PAPER_CHANNELS

RELINEARISE = 0.1
"""Fits for hold-out start at their rest but for one fold: a tenth of a std is near enough."""


def hold_out(estimator: Estimator, folds: int = 5, seed: int = 0) -> np.ndarray:
    """Predict each window by a fit that has seen no window of its steady state.

    Parameters
    ----------
    estimator
        With all its windows and at rest; it is left as it is.
    folds
        Parts into which the states are divided; with fewer states each is left out alone.
    seed
        Of the random order in which states are dealt to the folds, so that a fold is not
        one warp length at all speeds.

    Returns
    -------
    (n, 4) array in the order of `PAPER_CHANNELS`, NaN where a fit or a steady state is
    missing, as everywhere when there are fewer than two states.
    """
    windows = estimator.windows
    predicted = np.full((len(windows), len(PAPER_CHANNELS)), np.nan)
    states = np.array(sorted({window.state for window in windows}))
    if len(states) < 2:
        return predicted
    order = np.random.default_rng(seed).permutation(states)
    options = replace(estimator.options, relinearise_final=RELINEARISE)
    for left_out in np.array_split(order, min(folds, len(states))):
        part = estimator.subset(set(states.tolist()) - set(left_out.tolist()), options)
        if part.finish() is None:
            continue
        rows = [i for i, window in enumerate(windows) if window.state in left_out]
        predicted[rows] = part.predictions(part.coefficients, [windows[i] for i in rows])
    return predicted
