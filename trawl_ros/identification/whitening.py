"""From a window's residuals to independent ones of unit variance, robustly.

A window's residual is r = ε + Jn·δ: readings' errors ε with variances R, and errors δ of the
measured warp lengths and speed with variances S. Marginalising δ gives V = R + Jn S Jnᵀ. A
Huber loss acts on each reading's own error ε̂ = R V⁻¹ r, not on the whitened mixture, so that
one bad sensor is weighed down and its neighbours are not.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import erf, ndtr


@dataclass(frozen=True)
class Whitened:
    """One window's robustly whitened residual.

    Attributes
    ----------
    root : (n, n) array
        Maps residual and sensitivities to independent rows of unit variance.
    cost : float
        Huber loss of the readings' errors plus half the squared input errors.
    spread, expected : float
        Sum of squared (clipped) errors, and what it is on average where the noise is as
        stated; their ratio measures the noise. To some per cent: that clipping also moves
        the input errors is left out.
    weights : (n,) array
        Huber weights, 1 for a reading within the limit.
    """

    root: np.ndarray
    cost: float
    spread: float
    expected: float
    weights: np.ndarray


def whiten(
    residual: np.ndarray,
    std: np.ndarray,
    by_inputs: np.ndarray,
    input_std: np.ndarray,
    huber: float,
) -> Whitened:
    """Whiten measured minus predicted.

    Parameters
    ----------
    residual, std
        Measured minus predicted (n,) and the std (n,) of each reading.
    by_inputs
        Sensitivity (n, 3) of the readings to warp lengths and speed.
    input_std
        Standard deviations (3,) of these.
    huber
        Limit in standard deviations, from where the loss grows linearly.
    """
    error = residual / std
    gain = by_inputs * input_std / std[:, None]
    weights = np.ones(len(error))
    # Reweighting converges fast; 50 rounds are a guard, not a setting.
    for _ in range(50):
        own, inputs = _split(error, gain, weights)
        size = np.abs(own)
        updated = huber / np.maximum(size, huber)
        change = np.max(np.abs(updated - weights))
        weights = updated
        if change < 1e-9:
            break
    loss = np.where(size <= huber, 0.5 * size**2, huber * (size - 0.5 * huber))
    clipped = np.minimum(size, huber)
    own_share = np.diag(np.linalg.inv(np.eye(len(error)) + gain @ gain.T))
    return Whitened(
        root=np.linalg.inv(np.linalg.cholesky(np.diag(1.0 / weights) + gain @ gain.T)) / std,
        cost=float(loss.sum() + 0.5 * inputs @ inputs),
        spread=float(clipped @ clipped + inputs @ inputs),
        expected=float(
            np.sum(own_share * _clipped_variance(huber / np.sqrt(own_share)))
            + np.sum(1.0 - own_share)
        ),
        weights=weights,
    )


def _split(
    error: np.ndarray, gain: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Readings' own errors (n,) and errors of the inputs (3,), both in stated std."""
    weighted = gain.T * weights
    inputs = np.linalg.solve(np.eye(gain.shape[1]) + weighted @ gain, weighted @ error)
    return error - gain @ inputs, inputs


def _clipped_variance(limit: np.ndarray) -> np.ndarray:
    """Mean of min(|z|, limit)² for a standard normal z."""
    density = np.exp(-0.5 * limit**2) / np.sqrt(2.0 * np.pi)
    return erf(limit / np.sqrt(2.0)) + 2.0 * limit * (limit * ndtr(-limit) - density)
