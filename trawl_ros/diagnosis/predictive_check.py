# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quantities that a repair predicts worse on what was kept back, beyond their errors."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.holdout import predicted
from trawl_ros.diagnosis.inference.blocks import ErrorSize
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.refit import Refit
from trawl_ros.estimation.fit.error_terms import GROUP_OF, GROUPS
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.solver.predict import Predictor


@dataclass(frozen=True)
class QuantityOnHoldout:
    """Errors of one quantity, of both sides, on what was kept back.

    Attributes
    ----------
    name
        Of the quantity.
    before, after
        χ² of what boards alone and the repair miss by, with the errors of the repair's
        predictions: of the readings, their calibration, warp lengths and speed, the model's own,
        and of the estimate.
    number
        Of readings.
    part, part_std
        Part of what the repair changes that the readings want, and its std: 1 where it is right,
        less than a half where it makes this quantity worse. The std is infinite where nothing
        changes.
    """

    name: str
    before: float
    after: float
    number: int
    part: float = 1.0
    part_std: float = np.inf

    @property
    def probability(self) -> float:
        """Probability that errors alone make the repair miss by as much."""
        return float(chdtrc(self.number, self.after))

    def is_worse(self, options: InferenceOptions, looks: int = 1) -> bool:
        """Return True if the repair makes this quantity worse, beyond its errors.

        The odds against it are those of the cut, and errors alone seldom make it miss by as much,
        in any of so many ``looks`` at quantities.
        """
        odds = np.log(looks * options.cut / (1.0 - options.cut)) * options.temperature
        unlikely = self.probability < options.tail / looks
        return 0.5 * (self.after - self.before) > odds and unlikely


def on_holdout(
    predictor: Predictor,
    base: Refit,
    best: Refit,
    windows: Sequence[SteadyWindow],
    errors: ErrorSize,
) -> tuple[QuantityOnHoldout, ...]:
    """Compare a repair with the boards alone on windows to which neither was fitted.

    Windows for which either has no steady state are left out.

    Parameters
    ----------
    predictor
        The gear.
    base, best
        Refits of the boards alone, and with the effect.
    windows
        Kept back from both.
    errors
        Size of errors that readings do not tell.
    """
    pairs = []
    for window in windows:
        try:
            pairs.append([predicted(predictor, refit, window) for refit in (base, best)])
        except NoSteadyState:
            continue
    if not pairs:
        return ()
    without, repaired = (_held(refit, rows) for refit, rows in zip((base, best), zip(*pairs)))
    covariance = _covariance(repaired, best.fit.posterior.covariance, errors)
    changes = (without.residual - repaired.residual).ravel()
    shown = np.zeros(repaired.residual.shape, bool)
    for tow in repaired.errors:
        shown[tow.rows] = tow.present
    found = []
    for group, name in enumerate(GROUPS):
        rows = np.flatnonzero((shown & (group == GROUP_OF)).ravel())
        if len(rows):
            # The form of a cause is wrong by a part of what it changes.
            form = errors.form * changes[rows]
            own_covariance = covariance[np.ix_(rows, rows)] + np.outer(form, form)
            inverse = np.linalg.inv(own_covariance)
            missed = [fit.residual.ravel()[rows] for fit in (without, repaired)]
            before, after = (float(left @ inverse @ left) for left in missed)
            own = QuantityOnHoldout(name, before, after, len(rows))
            changed = missed[0] - missed[1]
            if information := float(changed @ inverse @ changed):
                part = 1.0 + float(changed @ inverse @ missed[1]) / information
                own = replace(own, part=part, part_std=information**-0.5)
            found.append(own)
    return tuple(found)


def _held(refit: Refit, windows: Sequence[Linearised]) -> Fit:
    """Fit of other windows at the coefficients and the noise of a refit."""
    return replace(
        refit.fit,
        windows=tuple(windows),
        coefficients=refit.estimate.values,
        weights=None,
        known=None,
    )


def _covariance(fit: Fit, estimate: FloatArray, errors: ErrorSize) -> FloatArray:
    """Return the covariance (windows k, windows k) of the residuals of predictions.

    ``estimate`` is the covariance of the estimate that predicts.
    """
    windows, channels = fit.residual.shape
    number = windows * channels
    jacobian = (fit.jacobian / fit.prior.std).reshape(number, -1)
    covariance = jacobian @ estimate @ jacobian.T
    model = np.zeros((windows, channels, fit.errors[0].model.shape[-1]))
    own = np.zeros((windows, channels))
    scales = np.array(fit.scales)[GROUP_OF]
    for tow in fit.errors:
        model[tow.rows] = tow.model
        own[tow.rows] = scales * tow.noise
        calibration = np.zeros((windows, channels, tow.calibration.shape[-1]))
        calibration[tow.rows] = errors.calibration * tow.calibration
        flat = calibration.reshape(number, -1)
        covariance += flat @ flat.T
        for row, inputs in zip(tow.rows, tow.inputs, strict=True):
            place = slice(row * channels, (row + 1) * channels)
            covariance[place, place] += inputs @ inputs.T
    flat = errors.model * model.reshape(number, -1)
    total: FloatArray = covariance + flat @ flat.T + np.diag(own.ravel() ** 2)
    return total
