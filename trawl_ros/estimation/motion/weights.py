"""Robust weights: means that no other of their channels bears out count less, and stretches in
which the model is in another state than the gear was do not count.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import cho_solve

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.information import LinearGroup
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes, group_rows
from trawl_ros.estimation.motion.records import LeftOut
from trawl_ros.estimation.motion.towing import LinearisedTow

FAR_TIMES = 4.0
"""Times the misfit of the median stretch from which a stretch is far off. In tows whose boards
stand the largest was 2.6 times the median, where a fit begins and where it ends; where boards
leaned over 4 to 18 times (trials of `trawl study motion --seed 48`)."""

FAR_LEAST = 3.0
"""Misfit, in std of the errors as stated, below which none is far off."""


def robust_factors(
    group: LinearGroup,
    here: FloatArray,
    sizes: FloatArray,
    times: ErrorTimes,
    stated: FloatArray,
    huber: float,
) -> FloatArray:
    """Factors (m,) on the noise of a group's means by Huber's weights.

    Each residual is held against what all other means of the group make of it by the processes of
    their errors, so an outlier is one though the residuals around it are large alike.

    Parameters
    ----------
    group
        Rows of the group, with noise as it was weighted last.
    here
        Parameters (p,).
    sizes, times
        Of the errors.
    stated : (m,) array
        Noise without weights.
    huber
        Std beyond which a residual counts less.
    """
    if not len(group.residual):
        return np.ones(0)
    inverse = cho_solve((group.root(sizes, times), True), np.eye(len(group.residual)))
    diagonal = np.diag(inverse)
    away = inverse @ (group.residual - group.columns @ here) / diagonal
    # The weighted noise is in the variance of a mean about the others, and comes out again.
    own, weighted = (sizes[0] * stated) ** 2, (sizes[0] * group.rows.noise) ** 2
    variance = np.maximum(1.0 / diagonal - weighted + own, 1e-300)
    beyond = np.maximum(np.abs(away) / np.sqrt(variance) / huber - 1.0, 0.0)
    factors: FloatArray = np.sqrt(1.0 + beyond * variance / np.maximum(own, 1e-300))
    return factors


def without_far_off(linear: LinearisedTow, sizes: ErrorSizes) -> LinearisedTow:
    """Linearised tow without the stretches that are far off, which are told.

    A board that leans over, or a gear on its way back from that, differs from what was measured by
    hundreds of standard deviations. Such a stretch says nothing of parameters, and beside it no
    other stretch counts.

    Parameters
    ----------
    linear
        As the model was towed.
    sizes
        Of the errors, as stated.
    """
    misfits = stretch_misfits(linear, sizes)
    there = np.isfinite(misfits)
    if not there.any():
        return linear
    usual = float(np.median(misfits[there]))
    far = there & (misfits > max(FAR_TIMES * usual, FAR_LEAST))
    if not far.any():
        return linear
    length = linear.tow.stretch_s
    why = f'the model is in another state, {FAR_TIMES:g} times as far off as usual and more'
    told = [LeftOut(n * length, (n + 1) * length, why) for n in map(float, np.flatnonzero(far))]
    every = sorted((*linear.left_out, *told), key=lambda part: part.begin)
    values = np.where(far[:, None], np.nan, linear.values)
    return replace(linear, values=values, left_out=tuple(every))


def stretch_misfits(linear: LinearisedTow, sizes: ErrorSizes) -> FloatArray:
    """Root mean square (n,) of each stretch's residuals in std of their errors; NaN without any."""
    squares, counts = np.zeros(len(linear.tow)), np.zeros(len(linear.tow))
    for group, rows in enumerate(group_rows(linear.tow, linear.values, linear.tow.noise)):
        each = (rows.noise, rows.drift, rows.model, rows.state, rows.change)
        parts = zip(sizes.of_group(group), each, strict=True)
        variance = sum(((size * part) ** 2 for size, part in parts), np.zeros(len(rows.noise)))
        away = linear.residual[rows.stretches, rows.channels]
        np.add.at(squares, rows.stretches, away**2 / variance)
        np.add.at(counts, rows.stretches, 1.0)
    found: FloatArray = np.sqrt(squares / np.where(counts > 0.0, counts, np.nan))
    return found
