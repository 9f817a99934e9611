# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Robust elimination of the nuisance parameters from steady windows, tow by tow.

The residual r (k,) of a window, measured minus predicted, is r = J Δ + M μ + U ν + G δ + ε with

- Δ (q,): step of the coefficients in prior std, shared by all tows;
- μ (m,): errors of the model itself, shared by all tows;
- ν (p,): calibration errors of the instruments, constant through a tow;
- δ (4,): errors of the window's three inputs, and the gear's remaining motion to equilibrium;
- ε (k,): the reading's own errors, with diagonal covariance D.

μ, ν and δ are normal with unit variance. Each window is whitened by V = D/w + G Gᵀ. The Huber
weights w are found by iteratively reweighted least squares. They depend on the most likely own
errors ε = (D/w) V⁻¹ (r - U ν - M μ), and not on the whitened residual. Whitening mixes the
channels, so a bad sensor would also lower the weights of good ones.

Letters in shapes: t tows, n windows of a tow, k channels; q, m and p as above.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_stack import ErrorStack, stacked
from trawl_ros.estimation.fit.error_terms import TowErrors
from trawl_ros.estimation.least_squares.information import Information, Joined, joined

MAX_ELIMINATIONS = 50
"""Safeguard on the number of eliminations; the last one uses the final weights."""

WEIGHT_TOLERANCE = 1e-5
"""Change of the weights below which they have converged. The cost errs by about its square."""

MAX_STEP_RATIO = 0.9
"""Ratio of successive steps of the weights up to which their limit is extrapolated."""


@dataclass(frozen=True)
class TowPart:
    """Contribution of one tow; n windows, k channels, p calibration errors.

    Attributes
    ----------
    errors : TowErrors
        Error terms of this tow.
    information : Information
        Information on Δ, μ and ν, linearised at Δ = 0.
    std : (n, k) array
        Std of each reading's own error ε, noise scale included, in the channel's unit.
    weights : (n, k) array
        Huber weights w, 1 for a reading within the limit.
    roots : (n, k, k) array
        Lower Cholesky factors of V.
    own : (n, k) array
        Most likely own errors ε of the readings, in units of ``std``.
    calibration : (p,) array
        Most likely calibration errors ν, in prior std.
    inputs : (n, 4) array
        Most likely δ of each window, in prior std.
    cost : float
        Huber loss of ε plus half the squares of δ and ν.
    """

    errors: TowErrors
    information: Information
    std: FloatArray
    weights: FloatArray
    roots: FloatArray
    own: FloatArray
    calibration: FloatArray
    inputs: FloatArray
    cost: float


@dataclass(frozen=True)
class NuisanceElimination:
    """Result of the nuisance elimination over all tows.

    Attributes
    ----------
    tows : tuple of TowPart
        One per tow, in the order of the tow numbers.
    joined : Joined
        Information of all tows on Δ and μ at Δ = 0. The prior of Δ is not included.
    model : (m,) array
        Most likely errors μ of the model at Δ = 0, in prior std.
    """

    tows: tuple[TowPart, ...]
    joined: Joined
    model: FloatArray

    @property
    def cost(self) -> float:
        """Robust cost at Δ = 0, without the prior of the coefficients."""
        return float(sum(tow.cost for tow in self.tows) + 0.5 * self.model @ self.model)

    @property
    def coefficients(self) -> Joined:
        """Information (q, q) of the data on the coefficients, with μ eliminated too."""
        both, q = self.joined, len(self.joined.right) - len(self.model)
        information = Information(both.matrix, both.right, 0.0, 0.0)
        return joined([information], [both.precision], q)


def eliminate_nuisance(
    tows: Sequence[TowErrors],
    scales: FloatArray,
    residual: FloatArray,
    jacobian: FloatArray,
    huber: float,
    weights: Sequence[FloatArray] | None = None,
) -> NuisanceElimination:
    """Eliminate all nuisance parameters with Huber weights on the readings' own errors.

    Parameters
    ----------
    tows
        Error terms of the windows, one record per tow.
    scales
        Factor (k,) on the stated noise of each channel.
    residual
        Measured minus predicted (windows, k); 0 where a window lacks the channel.
    jacobian
        Derivatives (windows, k, q) of the predictions by the coefficients, per prior std.
    huber
        Own error, in std, above which the loss grows linearly.
    weights
        Fixed Huber weights (n, k) of each tow. If None, they are computed.
    """
    if not tows:
        no_data = np.zeros(jacobian.shape[2])
        empty = Joined(np.diag(no_data), no_data, no_data, 0.0)
        return NuisanceElimination((), empty, np.zeros(0))
    stack = stacked(tows, scales, residual, jacobian)
    if weights is None:
        q, m = jacobian.shape[2], tows[0].model.shape[2]
        padded = _robust_weights(stack, stack.columns[..., q:], m, huber)
    else:
        # Tows have different numbers of windows; the padding keeps weight 1.
        padded = np.ones(stack.std.shape)
        for tow, weight in enumerate(weights):
            padded[tow, : len(weight)] = weight
    return _eliminate_with_weights(stack, tows, padded, huber)


def _robust_weights(stack: ErrorStack, columns: FloatArray, m: int, huber: float) -> FloatArray:
    """Find Huber weights (t, n, k) that are consistent with the own errors they lead to.

    This is the fixed point of iteratively reweighted least squares at Δ = 0.
    """
    weights, previous_step = np.ones(stack.std.shape), None
    for _ in range(1, MAX_ELIMINATIONS):
        updated = _huber_weights(_most_likely(stack, columns, m, weights).own, huber)
        step = updated - weights
        if float(np.max(np.abs(step))) < WEIGHT_TOLERANCE:
            break
        weights, previous_step = _extrapolated(updated, step, previous_step)
    return weights


@dataclass(frozen=True)
class _MostLikely:
    """Most likely errors at Δ = 0.

    Those of the model μ (m,), of calibration ν (t, p), ε ``own`` (t, n, k) in std, and V⁻¹ times
    the residual less what μ and ν explain, ``solved`` (t, n, k).
    """

    model: FloatArray
    calibration: FloatArray
    own: FloatArray
    solved: FloatArray


def _most_likely(
    stack: ErrorStack, columns: FloatArray, m: int, weights: FloatArray
) -> _MostLikely:
    """Find the most likely errors with fixed weights (t, n, k).

    ``columns`` (t, n, k, m + p + 1) are [M U r].
    """
    t, n, k, width = columns.shape
    variances = stack.shared + (stack.std**2 / weights)[..., None] * np.eye(k)
    solved = np.linalg.solve(variances, columns)
    # Normal equations of each tow: [M U r]ᵀ V⁻¹ [M U r].
    flat = columns.reshape(t, n * k, width)
    normal = flat.swapaxes(1, 2) @ solved.reshape(t, n * k, width)
    # Eliminate ν, whose prior precision is I: ν = C⁻¹ Uᵀ V⁻¹ (r - M μ), C = Uᵀ V⁻¹ U + I.
    # ``eliminated`` (t, p, m + 1) is C⁻¹ Uᵀ V⁻¹ [M r].
    across = np.concatenate((normal[:, m:-1, :m], normal[:, m:-1, -1:]), axis=2)
    eliminated = np.linalg.solve(normal[:, m:-1, m:-1] + np.eye(width - 1 - m), across)
    # Solve for μ with the Schur complements of all tows; its prior precision is I, once.
    matrix = np.sum(normal[:, :m, :m] - normal[:, :m, m:-1] @ eliminated[..., :m], axis=0)
    right = np.sum(normal[:, :m, -1] - (normal[:, :m, m:-1] @ eliminated[..., m:])[..., 0], axis=0)
    model = np.linalg.solve(matrix + np.eye(m), right)
    calibration = eliminated[..., m] - eliminated[..., :m] @ model
    # [M U r] @ (-μ, -ν, 1) is r - M μ - U ν.
    combination = np.ones((t, 1, width, 1))
    combination[:, 0, :m, 0] = -model
    combination[:, 0, m:-1, 0] = -calibration
    left = (solved @ combination)[..., 0]
    # ε = (D/w) V⁻¹ (r - M μ - U ν), divided by the std.
    own: FloatArray = stack.std / weights * left * stack.present
    return _MostLikely(model, calibration, own, left)


def _extrapolated(
    updated: FloatArray, step: FloatArray, previous_step: FloatArray | None
) -> tuple[FloatArray, FloatArray | None]:
    """Extrapolate the weights to the limit of geometrically decreasing steps (Aitken 1926).

    Returns
    -------
    tuple
        Weights, and the step to compare the next one with. The weights are extrapolated if the
        two steps point the same way and shrink. The step is then None, and a new pair begins.
    """
    if previous_step is None:
        return updated, step
    # Ratio of the steps by least squares: ρ = projection / square.
    square = float(np.vdot(previous_step, previous_step))
    projection = float(np.vdot(step, previous_step))
    if not 0.0 < projection < MAX_STEP_RATIO * square:
        return updated, step
    # The remaining steps add up to step · (ρ + ρ² + …) = step · ρ / (1 - ρ).
    remaining = projection / (square - projection)
    # Weights are positive and at most 1, so an overshoot is limited to half of the update.
    return np.clip(updated + remaining * step, 0.5 * updated, 1.0), None


def reweighted(elimination: NuisanceElimination, huber: float) -> tuple[FloatArray, ...]:
    """Return Huber weights (n, k) of each tow for the own errors of an elimination."""
    return tuple(_huber_weights(tow.own, huber) for tow in elimination.tows)


def _huber_weights(own: FloatArray, huber: float) -> FloatArray:
    """Return min(1, huber / abs(own)) for own errors in std."""
    weights: FloatArray = huber / np.maximum(np.abs(own), huber)
    return weights


def _eliminate_with_weights(
    stack: ErrorStack, tows: Sequence[TowErrors], weights: FloatArray, huber: float
) -> NuisanceElimination:
    """Eliminate δ, ν and μ with fixed Huber weights (t, n, k)."""
    t, n, k, width = stack.columns.shape
    m, p = tows[0].model.shape[2], tows[0].calibration.shape[2]
    q = width - p - m - 1
    # Whiten each window with the Cholesky factor of V = D/w + G Gᵀ. This eliminates δ.
    diagonal = (stack.std**2 / weights)[..., None] * np.eye(k)
    roots = np.asarray(np.linalg.cholesky(diagonal + stack.shared), np.float64)
    rows = np.linalg.solve(roots, stack.columns).reshape(t, n * k, width)
    squares = rows.swapaxes(1, 2) @ rows
    determinants = 2.0 * np.log(np.diagonal(roots, axis1=2, axis2=3)).sum((1, 2))
    blocks = [
        Information(square[:-1, :-1], square[:-1, -1], float(square[-1, -1]), float(determinant))
        for square, determinant in zip(squares, determinants, strict=True)
    ]
    # Prior precisions: 0 for Δ, whose prior is added later, and 1 for μ and ν.
    precision = np.concatenate((np.zeros(q), np.ones(m + p)))
    found = _most_likely(stack, stack.columns[..., q:], m, weights)
    # δ = Gᵀ V⁻¹ (r - M μ - U ν).
    inputs = (stack.inputs.swapaxes(2, 3) @ found.solved[..., None])[..., 0]
    size = np.abs(found.own)
    loss = np.where(size <= huber, 0.5 * size**2, huber * (size - 0.5 * huber))
    squares_of_rest = np.sum(inputs**2, (1, 2)) + np.sum(found.calibration**2, 1)
    costs = loss.sum((1, 2)) + 0.5 * squares_of_rest
    parts = []
    for number, (tow, block) in enumerate(zip(tows, blocks, strict=True)):
        own = number, slice(len(tow.rows))
        parts.append(
            TowPart(
                tow, block, stack.std[own], weights[own], roots[own], found.own[own],
                found.calibration[number], inputs[own], float(costs[number]),
            )
        )  # fmt: skip
    return NuisanceElimination(tuple(parts), joined(blocks, [precision] * t, q + m), found.model)
