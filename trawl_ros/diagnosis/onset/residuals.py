# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Residual rows of a watched tow: the estimator's residuals, derivatives and error covariance.

Lasting parameters are those of the estimator that act on all stretches: coefficients, added mass,
constant errors of the model, of the inputs and of the sensors. The errors of the inputs along the
way and the slowest motions at the beginning of a part are in the covariance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np
from scipy.linalg import block_diag

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.chain import Belief
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.part import LIVE
from trawl_ros.estimation.motion.nuisances import TowLayout, columns, layout_of
from trawl_ros.estimation.motion.processes import ErrorTimes, GroupRows, group_rows
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear

MODEL_FACTOR_IN_MANOEUVRES = 3.0
"""Factor on the model's error while winches run or the speed changes: derivatives are less exact
then, and a gear that is not the model differs more."""

UNREST_S = 150.0
"""Time in which the unrest of a manoeuvre fades to 1/e."""

PASSING_MODEL_FACTOR, PASSING_S = 3.0, 30.0
"""Std of an error of the model that no two stretches share when a manoeuvre begins, in the model's
error, and time in which it fades to 1/e: boards lean over in passing."""


STATED_STD_FACTOR = 1.2
"""Factor on the std of all errors that are stated, as for steady windows."""


def belief_of(known: Knowledge) -> Belief:
    """Return the belief of the lasting parameters before anything is watched."""
    covariance, number = known.covariance, len(TowLayout(len(known.values), 0, (), WATCHED))
    roots = np.linalg.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance)))
    others = STATED_STD_FACTOR * np.eye(number - len(roots))
    return Belief(np.zeros(number), block_diag(roots, others))


def log_factor(known: Knowledge, density: float) -> float:
    """Return the factor on the errors of a log whose readings show a noise density."""
    return max(known.sizes.log, known.densities.get('speed', 0.0) / density)


@dataclass(frozen=True)
class ResidualRows:
    """Rows of a tow, ordered by stretch.

    Attributes
    ----------
    stretches, channels : (n,) arrays
        Stretch and watched channel of each.
    model : (n,) array
        Std of the model's own error.
    residual : (n,) array
        Measured less predicted, at the mean of the belief.
    columns : (n, q) array
        Derivatives by the belief's parameters, in units of its root.
    covariance : (n, n) array
        Covariance, that of the belief among it.
    """

    stretches: IntArray
    channels: IntArray
    model: FloatArray
    residual: FloatArray
    columns: FloatArray
    covariance: FloatArray

    def of(self, stretch: int) -> 'ResidualRows':
        """Return the rows of a stretch, with their covariance with all rows before."""
        first, last = np.searchsorted(self.stretches, (stretch, stretch + 1))
        own = {name: array[first:last] for name, array in vars(self).items()}
        return ResidualRows(**own | {'covariance': self.covariance[first:last, :last]})


def residual_rows(
    gear: TowedGear,
    linear: LinearisedTow,
    belief: Belief,
    known: Knowledge,
    *,
    log_density: float,
    unrest: FloatArray,
    absorbed: FloatArray,
) -> ResidualRows:
    """Return the rows of a linearised tow.

    Parameters
    ----------
    gear, linear
        The gear, and its tow as it was linearised.
    belief
        Distribution of the lasting parameters; coefficients as departures from the known ones.
    known
        Knowledge of the boards and of the sizes of errors.
    log_density
        Noise density (m/s/√Hz) that the log's readings show.
    unrest : (n,) array
        1 in stretches of a manoeuvre, from which it fades.
    absorbed : (n, k, a) array
        Signatures of what has been found before, each in units of its prior std.
    """
    tow, layout = linear.tow, layout_of(linear.tow, gear, 1.0)
    sizes = known.sizes.tempered(STATED_STD_FACTOR)
    # Means scatter no less than neighbouring readings share.
    densities = np.array([known.densities.get(name, 0.0) for name in WATCHED])
    noise = np.maximum(tow.noise, densities / np.sqrt(LIVE.stretch_s))
    groups = group_rows(tow, linear.values, noise)
    of_errors = block_diag(
        *(
            _wider(own, unrest[own.stretches]).covariance(sizes.of_group(number), ErrorTimes())
            for number, own in enumerate(groups)
        )
    )
    rows = np.hstack([(own.stretches, own.channels) for own in groups])
    order = np.argsort(rows[0], kind='stable')
    stretches, channels = place = tuple(rows[:, order])
    model = np.hstack([own.model for own in groups])[order]
    slopes = columns(linear, layout, np.ones(len(known.values)))[place]
    lasting, std = np.ones(len(layout), np.bool_), np.full(len(layout), STATED_STD_FACTOR)
    lasting[layout.slices['starts']] = lasting[layout.of_knots] = False
    std[layout.of_log] *= log_factor(known, log_density)
    own_columns = slopes[:, lasting] @ belief.root
    everything = np.hstack((own_columns, (slopes * std)[:, ~lasting], absorbed[place]))
    shift = linear.by['coefficients'] @ (linear.point.coefficients - known.values)
    residual = (linear.residual + shift)[place] - slopes[:, lasting] @ belief.mean
    covariance = of_errors[np.ix_(order, order)] + everything @ everything.T
    return ResidualRows(stretches, channels, model, residual, own_columns, covariance)


def _wider(rows: GroupRows, unrest: FloatArray) -> GroupRows:
    """Return rows (m,) with the model's error larger, as it is in unrest (m,)."""
    more = 1.0 + (MODEL_FACTOR_IN_MANOEUVRES - 1.0) * unrest
    passing = PASSING_MODEL_FACTOR * unrest ** (UNREST_S / PASSING_S) * rows.model
    return replace(rows, model=more * rows.model, noise=np.hypot(rows.noise, passing))


def unrest_of(manoeuvres: Sequence[bool]) -> FloatArray:
    """Return the unrest (n,) of stretches: 1 in a manoeuvre, from which it fades."""
    fading = np.exp(-LIVE.stretch_s / UNREST_S)
    fade = accumulate(map(float, manoeuvres), lambda unrest, moves: moves or fading * unrest)
    return np.array(list(fade))
