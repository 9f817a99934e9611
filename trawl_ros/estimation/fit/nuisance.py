"""Nuisance elimination: square-root information of the coefficients alone.

A reading's residual is r = ε + G δ + U ν + M μ + J Δ: the reading's own error ε of variance D,
errors δ of the window's inputs and what it lacks of rest, calibration ν of the tow, the model's
own error μ and the step Δ of the coefficients; δ, ν, μ are normal with unit variance. Windows
are whitened by V = D/w + G Gᵀ, then each tow's ν and then μ are eliminated by QR, which leaves a
triangle for Δ. A Huber loss acts, through the weights w, on each reading's own error
D V⁻¹ (r - U ν - M μ) and not on a mixture, so that one bad sensor is weighed down and its
neighbours are not.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import erf, ndtr

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import TowErrors

ROUNDS = 50
"""Reweighting converges fast; this is a guard, not a setting."""

ALIKE = 1e-5
"""Weights that change by less are the last; they err the cost by the square of that."""

STEADY = 0.9
"""Factor from one step of the weights to the next up to which their end is extrapolated."""


@dataclass(frozen=True)
class TowPart:
    """Contribution of one tow; n windows by k channels, p errors of calibration.

    Attributes
    ----------
    errors : TowErrors
        Of this tow.
    std : (n, k) array
        Of the reading's own error, noise scale included.
    weights : (n, k) array
        Huber weights, 1 for a reading within the limit.
    roots : (n, k, k) array
        Lower Cholesky factors of V.
    triangle : (p, p + m + q) array
        Of ν in terms of ν, μ and Δ, with q coefficients.
    own : (n, k) array
        The readings' own errors, in std.
    calibration : (p,) array
        Most likely errors of calibration, in std.
    inputs : (n, 4) array
        Most likely errors of each window's inputs and rest, in std.
    cost : float
        Huber loss of the readings' own errors and half the squares of δ and ν.
    """

    errors: TowErrors
    std: FloatArray
    weights: FloatArray
    roots: FloatArray
    triangle: FloatArray
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
        In the order of their numbers.
    triangle, right : (q, q) and (q,) arrays
        Square-root information of Δ from the data alone.
    model_triangle : (m, m + q) array
        Of μ in terms of μ and Δ.
    model : (m,) array
        Most likely errors of the model at Δ = 0, in std.
    cost : float
        Robust cost at Δ = 0, without the prior of the coefficients.
    """

    tows: tuple[TowPart, ...]
    triangle: FloatArray
    right: FloatArray
    model_triangle: FloatArray
    model: FloatArray
    cost: float


def eliminate_nuisance(
    tows: Sequence[TowErrors],
    scales: FloatArray,
    residual: FloatArray,
    jacobian: FloatArray,
    huber: float,
    weights: Sequence[FloatArray] | None = None,
) -> NuisanceElimination:
    """Eliminate all nuisance parameters, robustly.

    Parameters
    ----------
    tows
        Errors of the windows, tow by tow.
    scales
        Factor (k,) on the stated noise of each channel.
    residual
        Measured minus predicted (windows, k), 0 where a window has no such channel.
    jacobian
        Sensitivities (windows, k, q) to the coefficients in units of their prior's std.
    huber
        Limit in std from where the loss grows linearly.
    weights
        Huber weights (n, k) of each tow that are taken as they are; found if None.
    """
    if weights is not None:
        return _solved(tows, weights, scales, residual, jacobian, huber)
    guess: Sequence[FloatArray] = [np.ones(tow.noise.shape) for tow in tows]
    before: Sequence[FloatArray] | None = None
    for _ in range(ROUNDS):
        elimination = _solved(tows, guess, scales, residual, jacobian, huber)
        updated = reweighted(elimination, huber)
        steps = [a - b for a, b in zip(updated, guess, strict=True)]
        if max((float(np.max(np.abs(step))) for step in steps), default=0.0) < ALIKE:
            break
        guess, before = _extrapolated(updated, steps, before)
    return elimination


def _extrapolated(
    updated: Sequence[FloatArray], steps: Sequence[FloatArray], before: Sequence[FloatArray] | None
) -> tuple[Sequence[FloatArray], Sequence[FloatArray] | None]:
    """Weights at the end of steps that fall by one factor (Aitken 1926), after two such; and the
    steps that the next are compared with.
    """
    if before is None:
        return updated, steps
    square = sum(float(np.vdot(old, old)) for old in before)
    along = sum(float(np.vdot(new, old)) for new, old in zip(steps, before, strict=True))
    if not 0.0 < along < STEADY * square:
        return updated, steps
    beyond = along / (square - along)
    ends = [
        np.clip(weight + beyond * step, 0.5 * weight, 1.0)
        for weight, step in zip(updated, steps, strict=True)
    ]
    return ends, None


def reweighted(elimination: NuisanceElimination, huber: float) -> tuple[FloatArray, ...]:
    """Huber weights (n, k) of each tow for the readings' own errors."""
    return tuple(huber / np.maximum(np.abs(tow.own), huber) for tow in elimination.tows)


def _solved(
    tows: Sequence[TowErrors],
    weights: Sequence[FloatArray],
    scales: FloatArray,
    residual: FloatArray,
    jacobian: FloatArray,
    huber: float,
) -> NuisanceElimination:
    m = tows[0].model.shape[2] if tows else 0
    q = jacobian.shape[2]
    whitened, remainders = [], []
    for tow, weight in zip(tows, weights, strict=True):
        std = np.where(tow.present, tow.noise * scales, 1.0)
        roots = _roots(tow, std, weight)
        columns = np.concatenate(
            (
                tow.calibration,
                tow.model,
                jacobian[tow.rows],
                residual[tow.rows][:, :, None],
            ),
            axis=2,
        )
        solved = np.asarray(np.linalg.solve(roots, columns), np.float64)
        rows = solved.reshape(-1, columns.shape[2])
        p = tow.calibration.shape[2]
        triangle = _eliminated(rows, p)
        whitened.append((std, roots, triangle[:p]))
        remainders.append(triangle[p:, p:])
    rest = np.vstack(remainders) if remainders else np.zeros((0, m + q + 1))
    triangle = _eliminated(rest, m)
    of_model, of_coefficients = triangle[:m], triangle[m:, m:]
    padded = np.vstack((of_coefficients, np.zeros((q + 1, q + 1))))
    last = triangular(padded)
    model = solve_triangular(of_model[:, :m], of_model[:, -1])
    tow_parts = tuple(
        _explained(tow, weight, *solution, model, residual, huber)
        for tow, weight, solution in zip(tows, weights, whitened, strict=True)
    )
    return NuisanceElimination(
        tows=tow_parts,
        triangle=last[:q, :q],
        right=last[:q, q],
        model_triangle=of_model[:, :-1],
        model=model,
        cost=float(sum(tow_part.cost for tow_part in tow_parts) + 0.5 * model @ model),
    )


def _roots(tow: TowErrors, std: FloatArray, weights: FloatArray) -> FloatArray:
    variance = std**2 / weights
    diagonal = variance[:, :, None] * np.eye(variance.shape[1])
    return np.linalg.cholesky(diagonal + tow.inputs @ tow.inputs.transpose(0, 2, 1))


def _eliminated(rows: FloatArray, number: int) -> FloatArray:
    """Triangular rows with unit normal priors on the first columns added."""
    prior = np.zeros((number, rows.shape[1]))
    prior[:, :number] = np.eye(number)
    return triangular(np.vstack((prior, rows)))


def triangular(rows: FloatArray) -> FloatArray:
    """Triangular factor R of a QR decomposition of the rows."""
    return np.asarray(np.linalg.qr(rows, mode='r'))


def _explained(
    tow: TowErrors,
    weights: FloatArray,
    std: FloatArray,
    roots: FloatArray,
    triangle: FloatArray,
    model: FloatArray,
    residual: FloatArray,
    huber: float,
) -> TowPart:
    p, m = len(triangle), len(model)
    right = triangle[:, -1] - triangle[:, p : p + m] @ model
    calibration = solve_triangular(triangle[:, :p], right)
    left = residual[tow.rows] - tow.calibration @ calibration - tow.model @ model
    half = np.linalg.solve(roots, left[:, :, None])
    solved = np.linalg.solve(roots.transpose(0, 2, 1), half)
    inputs = (tow.inputs.transpose(0, 2, 1) @ solved)[:, :, 0]
    own = std / weights * solved[:, :, 0] * tow.present
    size = np.abs(own)
    loss = np.where(size <= huber, 0.5 * size**2, huber * (size - 0.5 * huber))
    squares = float(np.sum(inputs**2) + calibration @ calibration)
    return TowPart(
        errors=tow,
        std=std,
        weights=weights,
        roots=roots,
        triangle=triangle[:, :-1],
        own=own,
        calibration=calibration,
        inputs=inputs,
        cost=float(loss.sum() + 0.5 * squares),
    )


def redundancy_numbers(
    elimination: NuisanceElimination, jacobian: FloatArray, root: FloatArray
) -> FloatArray:
    """Redundancy numbers (windows, k): share of each reading's variance kept by its own error.

    The rest goes into inputs, calibration, the model's errors and the coefficients: diagonal of
    D P with P = V⁻¹ - V⁻¹ X C Xᵀ V⁻¹, where C is the posterior covariance of all those.

    Parameters
    ----------
    elimination
        From `eliminate_nuisance` with the same ``jacobian``.
    jacobian
        Sensitivities (windows, k, q) per prior std.
    root
        Of the posterior covariance (q, q) of the coefficients, S Sᵀ, in prior std.
    """
    shares = np.zeros(jacobian.shape[:2])
    joint = joint_root(elimination, root)
    for tow_part in elimination.tows:
        tow = tow_part.errors
        p = tow_part.triangle.shape[0]
        upper = np.concatenate((tow.model, jacobian[tow.rows]), axis=2)
        solved = solve_triangular(tow_part.triangle[:, :p], np.eye(p))
        of_tow = tow.calibration @ solved
        of_upper = upper - of_tow @ tow_part.triangle[:, p:]
        terms = np.concatenate((of_tow, of_upper @ joint), axis=2)
        inverse = np.linalg.inv(tow_part.roots)
        known = inverse.transpose(0, 2, 1) @ (inverse @ terms)
        own = np.einsum('nij,nij->nj', inverse, inverse) - np.einsum('nkt,nkt->nk', known, known)
        shares[tow.rows] = np.where(tow.present, tow_part.std**2 / tow_part.weights * own, 0.0)
    return shares


def joint_root(elimination: NuisanceElimination, root: FloatArray) -> FloatArray:
    """Root (m + q, m + q) of the posterior covariance of the model's errors and coefficients.

    ``root`` (q, q) is that of the coefficients alone.
    """
    m, q = len(elimination.model), len(root)
    solved = solve_triangular(elimination.model_triangle[:, :m], np.eye(m))
    joint = np.zeros((m + q, m + q))
    joint[:m, :m] = solved
    joint[:m, m:] = -solved @ elimination.model_triangle[:, m:] @ root
    joint[m:, m:] = root
    return joint


def calibration_root(tow_part: TowPart, joint: FloatArray) -> FloatArray:
    """Root (p, p + m + q) of the posterior covariance of a tow's errors of calibration.

    ``joint`` is from `joint_root`.
    """
    p = len(tow_part.triangle)
    solved = solve_triangular(tow_part.triangle[:, :p], np.eye(p))
    return np.hstack((solved, -solved @ tow_part.triangle[:, p:] @ joint))


def clipped_variance(limit: FloatArray) -> FloatArray:
    """Mean of min(|z|, limit)² for a standard normal z."""
    density = np.exp(-0.5 * limit**2) / np.sqrt(2.0 * np.pi)
    mean: FloatArray = erf(limit / np.sqrt(2.0)) + 2.0 * limit * (limit * ndtr(-limit) - density)
    return mean
