"""Quantities that a repair predicts worse on what was kept back, beyond their errors."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.holdout import predicted
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.rules import DOUBT, WORSE, WORSE_BY
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

    @property
    def worse(self) -> bool:
        """True if the repair makes this quantity worse, beyond its errors."""
        return self.after - self.before > WORSE_BY and self.probability < WORSE


def on_holdout(
    predictor: Predictor, base: Refit, best: Refit, windows: Sequence[SteadyWindow]
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
    covariance = _covariance(repaired, best.fit.posterior.covariance)
    shown = np.zeros(repaired.residual.shape, bool)
    for tow in repaired.errors:
        shown[tow.rows] = tow.present
    found = []
    for group, name in enumerate(GROUPS):
        rows = np.flatnonzero((shown & (group == GROUP_OF)).ravel())
        if len(rows):
            inverse = np.linalg.inv(covariance[np.ix_(rows, rows)])
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


def _covariance(fit: Fit, estimate: FloatArray) -> FloatArray:
    """Covariance of all residuals (windows k, windows k) of predictions with an estimate of this
    covariance.
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
        calibration[tow.rows] = DOUBT * tow.calibration
        flat = calibration.reshape(number, -1)
        covariance += flat @ flat.T
        for row, inputs in zip(tow.rows, tow.inputs, strict=True):
            place = slice(row * channels, (row + 1) * channels)
            covariance[place, place] += inputs @ inputs.T
    flat = DOUBT * model.reshape(number, -1)
    total: FloatArray = covariance + flat @ flat.T + np.diag(own.ravel() ** 2)
    return total
