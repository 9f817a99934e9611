# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
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

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_stack import ErrorStack, stacked
from trawl_ros.estimation.fit.error_terms import TowErrors

ROUNDS = 50
"""Eliminations, the last with the weights that are kept: a guard, not a setting."""

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
    if not tows:
        return _nothing(jacobian.shape[2])
    stack = stacked(tows, scales, residual, jacobian)
    if weights is None:
        every = _robust_weights(stack, tows, huber)
    else:
        every = np.ones(stack.std.shape)
        for place, weight in enumerate(weights):
            every[place, : len(weight)] = weight
    return _solved(stack, tows, every, huber)


def _nothing(q: int) -> NuisanceElimination:
    """Elimination of no errors, from no tows."""
    none = np.zeros(0)
    return NuisanceElimination((), np.zeros((q, q)), np.zeros(q), np.zeros((0, q)), none, 0.0)


def _robust_weights(stack: ErrorStack, tows: Sequence[TowErrors], huber: float) -> FloatArray:
    """Huber weights (t, n, k) that belong to the readings' own errors with them."""
    p, m = tows[0].calibration.shape[2], tows[0].model.shape[2]
    known = np.concatenate((stack.columns[..., : p + m], stack.columns[..., -1:]), axis=-1)
    weights, before = np.ones(stack.std.shape), None
    for _ in range(1, ROUNDS):
        updated = _huber_weights(_own_errors(stack, known, p, weights), huber)
        step = updated - weights
        if float(np.max(np.abs(step))) < ALIKE:
            break
        weights, before = _extrapolated(updated, step, before)
    return weights


def _own_errors(stack: ErrorStack, known: FloatArray, p: int, weights: FloatArray) -> FloatArray:
    """The readings' own errors (t, n, k), in std, beside the most likely ν and μ.

    From normal equations: for weights that are found to `ALIKE` they are exact enough, and the
    coefficients take no part. ``known`` (t, n, k, p + m + 1) are U, M and r.
    """
    t, n, k, width = known.shape
    m = width - p - 1
    variances = stack.shared + (stack.std**2 / weights)[..., None] * np.eye(k)
    solved = np.linalg.solve(variances, known)
    flat = known.reshape(t, n * k, width)
    normal = flat.swapaxes(1, 2) @ solved.reshape(t, n * k, width)
    of_tow = np.linalg.solve(normal[:, :p, :p] + np.eye(p), normal[:, :p, p:])
    rest = np.sum(normal[:, p:, p:] - normal[:, p:, :p] @ of_tow, axis=0)
    model = np.linalg.solve(rest[:m, :m] + np.eye(m), rest[:m, m])
    without = np.ones((t, 1, width, 1))
    without[:, 0, :p, 0] = of_tow[..., :m] @ model - of_tow[..., m]
    without[:, 0, p:-1, 0] = -model
    own: FloatArray = stack.std / weights * (solved @ without)[..., 0] * stack.present
    return own


def _extrapolated(
    updated: FloatArray, step: FloatArray, before: FloatArray | None
) -> tuple[FloatArray, FloatArray | None]:
    """Weights at the end of steps that fall by one factor (Aitken 1926), after two such; and the
    step that the next is compared with.
    """
    if before is None:
        return updated, step
    square, along = float(np.vdot(before, before)), float(np.vdot(step, before))
    if not 0.0 < along < STEADY * square:
        return updated, step
    beyond = along / (square - along)
    return np.clip(updated + beyond * step, 0.5 * updated, 1.0), None


def reweighted(elimination: NuisanceElimination, huber: float) -> tuple[FloatArray, ...]:
    """Huber weights (n, k) of each tow for the readings' own errors."""
    return tuple(_huber_weights(tow.own, huber) for tow in elimination.tows)


def _huber_weights(own: FloatArray, huber: float) -> FloatArray:
    weights: FloatArray = huber / np.maximum(np.abs(own), huber)
    return weights


def _solved(
    stack: ErrorStack, tows: Sequence[TowErrors], every: FloatArray, huber: float
) -> NuisanceElimination:
    """Elimination with Huber weights ``every`` (t, n, k)."""
    t, n, k, width = stack.columns.shape
    p, m = tows[0].calibration.shape[2], tows[0].model.shape[2]
    q = width - p - m - 1
    diagonal = (stack.std**2 / every)[..., None] * np.eye(k)
    roots = np.asarray(np.linalg.cholesky(diagonal + stack.shared), np.float64)
    inverse = np.asarray(np.linalg.inv(roots), np.float64)
    rows = (inverse @ stack.columns).reshape(t, n * k, width)
    triangles = _eliminated(rows, p)
    rest = triangles[:, p:, p:].reshape(-1, m + q + 1)
    triangle = _eliminated(rest, m)
    of_model, of_coefficients = triangle[:m], triangle[m:, m:]
    padded = np.vstack((of_coefficients, np.zeros((q + 1, q + 1))))
    last = triangular(padded)
    model = solve_triangular(of_model[:, :m], of_model[:, -1])
    tow_parts = _explained(stack, tows, roots, inverse, every, triangles[:, :p], model, huber)
    return NuisanceElimination(
        tows=tow_parts,
        triangle=last[:q, :q],
        right=last[:q, q],
        model_triangle=of_model[:, :-1],
        model=model,
        cost=float(sum(tow_part.cost for tow_part in tow_parts) + 0.5 * model @ model),
    )


def _eliminated(rows: FloatArray, number: int) -> FloatArray:
    """Triangular rows with unit normal priors on the first columns added."""
    prior = np.zeros((*rows.shape[:-2], number, rows.shape[-1]))
    prior[..., :number] = np.eye(number)
    return triangular(np.concatenate((prior, rows), axis=-2))


def triangular(rows: FloatArray) -> FloatArray:
    """Triangular factor R of a QR decomposition of the rows."""
    return np.asarray(np.linalg.qr(rows, mode='r'))


def _explained(
    stack: ErrorStack,
    tows: Sequence[TowErrors],
    roots: FloatArray,
    inverse: FloatArray,
    every: FloatArray,
    triangles: FloatArray,
    model: FloatArray,
    huber: float,
) -> tuple[TowPart, ...]:
    """Find the most likely errors, tow by tow."""
    p, m = triangles.shape[1], len(model)
    right = triangles[..., -1] - triangles[..., p : p + m] @ model
    calibration = np.linalg.solve(triangles[..., :p], right[..., None])[:, None]
    of_tow, of_model = stack.columns[..., :p], stack.columns[..., p : p + m]
    left = stack.residual - (of_tow @ calibration)[..., 0] - of_model @ model
    solved = inverse.swapaxes(2, 3) @ (inverse @ left[..., None])
    inputs = (stack.inputs.swapaxes(2, 3) @ solved)[..., 0]
    own = stack.std / every * solved[..., 0] * stack.present
    size = np.abs(own)
    loss = np.where(size <= huber, 0.5 * size**2, huber * (size - 0.5 * huber))
    calibration = calibration[:, 0, :, 0]
    squares = np.sum(inputs**2, (1, 2)) + np.sum(calibration**2, 1)
    costs = loss.sum((1, 2)) + 0.5 * squares
    return tuple(
        TowPart(
            errors=tow,
            std=stack.std[place, : len(tow.rows)],
            weights=every[place, : len(tow.rows)],
            roots=roots[place, : len(tow.rows)],
            triangle=triangles[place, :, :-1],
            own=own[place, : len(tow.rows)],
            calibration=calibration[place],
            inputs=inputs[place, : len(tow.rows)],
            cost=float(costs[place]),
        )
        for place, tow in enumerate(tows)
    )
