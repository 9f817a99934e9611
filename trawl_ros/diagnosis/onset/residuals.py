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

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.chain import Belief
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.part import LIVE
from trawl_ros.estimation.motion.nuisances import TowLayout, columns, layout_of
from trawl_ros.estimation.motion.processes import ErrorTimes, group_rows
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


@dataclass(frozen=True)
class ErrorModel:
    """Errors with which a tow is watched.

    Attributes
    ----------
    known
        Knowledge of the boards and of the sizes of errors.
    inflation
        Factor on the std of all errors that are stated, as for steady windows.
    """

    known: Knowledge
    inflation: float = 1.2

    def belief(self, layout: TowLayout) -> Belief:
        """Return the belief of the lasting parameters before anything is watched."""
        covariance, lasting = self.known.covariance, lasting_flags(layout)
        roots = np.linalg.cholesky(covariance + 1e-12 * np.diag(np.diag(covariance)))
        others = self.inflation * np.eye(int(lasting.sum()) - len(roots))
        return Belief(np.zeros(int(lasting.sum())), block_diag(roots, others))

    def noise(self, noise: FloatArray) -> FloatArray:
        """Return the noise (n, k) of means, no less than neighbouring readings share."""
        densities = np.array([self.known.densities.get(name, 0.0) for name in WATCHED])
        return np.asarray(np.maximum(noise, densities / np.sqrt(LIVE.stretch_s)), np.float64)

    def log_factor(self, density: float) -> float:
        """Return the factor on the errors of a log whose readings show a noise density."""
        return max(self.known.sizes.log, self.known.densities.get('speed', 0.0) / density)


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
        own = slice(first, last)
        return ResidualRows(
            self.stretches[own], self.channels[own], self.model[own], self.residual[own],
            self.columns[own], self.covariance[own, :last],
        )  # fmt: skip


def lasting_flags(layout: TowLayout) -> BoolArray:
    """Return flags (p,) of the parameters that last beyond a part of a tow."""
    flags = np.ones(len(layout), np.bool_)
    flags[layout.slices['starts']] = flags[layout.of_knots] = False
    return flags


def residual_rows(
    gear: TowedGear,
    linear: LinearisedTow,
    belief: Belief,
    errors: ErrorModel,
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
    errors
        Errors of the rows.
    log_density
        Noise density (m/s/√Hz) that the log's readings show.
    unrest : (n,) array
        1 in stretches of a manoeuvre, from which it fades.
    absorbed : (n, k, a) array
        Signatures of what has been found before, each in units of its prior std.
    """
    tow, layout, known = linear.tow, layout_of(linear.tow, gear, 1.0), errors.known
    sizes = known.sizes.tempered(errors.inflation)
    more = 1.0 + (MODEL_FACTOR_IN_MANOEUVRES - 1.0) * unrest
    passing = PASSING_MODEL_FACTOR * unrest ** (UNREST_S / PASSING_S)
    groups = group_rows(tow, linear.values, errors.noise(tow.noise))
    wider = [
        replace(
            own, model=more[own.stretches] * own.model,
            noise=np.hypot(own.noise, passing[own.stretches] * own.model),
        )
        for own in groups
    ]  # fmt: skip
    of_errors = block_diag(
        *(own.covariance(sizes.of_group(n), ErrorTimes()) for n, own in enumerate(wider))
    )
    rows = np.hstack([(own.stretches, own.channels) for own in groups])
    order = np.argsort(rows[0], kind='stable')
    place, model = tuple(rows[:, order]), np.hstack([own.model for own in groups])[order]
    slopes = columns(linear, layout, np.ones(len(known.values)))[place]
    lasting, std = lasting_flags(layout), np.full(len(layout), errors.inflation)
    std[layout.of_log] *= errors.log_factor(log_density)
    own_columns = slopes[:, lasting] @ belief.root
    everything = np.hstack((own_columns, (slopes * std)[:, ~lasting], absorbed[place]))
    shift = linear.by['coefficients'] @ (linear.point.coefficients - known.values)
    residual = (linear.residual + shift)[place] - slopes[:, lasting] @ belief.mean
    covariance = of_errors[np.ix_(order, order)] + everything @ everything.T
    return ResidualRows(*place, model, residual, own_columns, covariance)


def unrest_of(manoeuvres: Sequence[bool]) -> FloatArray:
    """Return the unrest (n,) of stretches: 1 in a manoeuvre, from which it fades."""
    fading = np.exp(-LIVE.stretch_s / UNREST_S)
    fade = accumulate(map(float, manoeuvres), lambda unrest, moves: moves or fading * unrest)
    return np.array(list(fade))
