# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tows of steady windows as blocks of one least-squares problem, whitened robustly.

A reading's residual is r = J Δ + M μ + U ν + G δ + ε: the step Δ of the coefficients, the model's
own error μ, calibration ν of the tow, errors δ of the window's inputs and what it lacks of rest,
and the reading's own error ε of variance D; δ, ν, μ are normal with unit variance. Windows are
whitened by V = D/w + G Gᵀ. All tows share Δ and μ. A Huber loss acts, through the weights w, on
each reading's own error D V⁻¹ (r - U ν - M μ) and not on a mixture, so that one bad sensor is
weighed down and its neighbours are not.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_stack import ErrorStack, stacked
from trawl_ros.estimation.fit.error_terms import TowErrors
from trawl_ros.estimation.least_squares.information import Information, Joined, joined, own_values

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
    information : Information
        On coefficients, the model's errors and calibration, about Δ = 0.
    std : (n, k) array
        Of the reading's own error, noise scale included.
    weights : (n, k) array
        Huber weights, 1 for a reading within the limit.
    roots : (n, k, k) array
        Lower Cholesky factors of V.
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
        In the order of their numbers.
    joined : Joined
        Information on coefficients and the model's errors, about Δ = 0; none on the coefficients
        before the data.
    model : (m,) array
        Most likely errors of the model at Δ = 0, in std.
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
        """Information (q, q) of the data on the coefficients alone."""
        every, q = self.joined, len(self.joined.right) - len(self.model)
        whole = Information(every.matrix, every.right, 0.0, 0.0)
        return joined([whole], [every.precision], q)


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
        none = np.zeros(jacobian.shape[2])
        return NuisanceElimination((), Joined(np.diag(none), none, none, 0.0), np.zeros(0))
    stack = stacked(tows, scales, residual, jacobian)
    if weights is None:
        every = _robust_weights(stack, tows, huber)
    else:
        every = np.ones(stack.std.shape)
        for place, weight in enumerate(weights):
            every[place, : len(weight)] = weight
    return _solved(stack, tows, every, huber)


def _robust_weights(stack: ErrorStack, tows: Sequence[TowErrors], huber: float) -> FloatArray:
    """Huber weights (t, n, k) that belong to the readings' own errors with them."""
    m, p = tows[0].model.shape[2], tows[0].calibration.shape[2]
    known = stack.columns[..., -(m + p + 1) :]
    weights, before = np.ones(stack.std.shape), None
    for _ in range(1, ROUNDS):
        updated = _huber_weights(_own_errors(stack, known, m, weights), huber)
        step = updated - weights
        if float(np.max(np.abs(step))) < ALIKE:
            break
        weights, before = _extrapolated(updated, step, before)
    return weights


def _own_errors(stack: ErrorStack, known: FloatArray, m: int, weights: FloatArray) -> FloatArray:
    """The readings' own errors (t, n, k), in std, with the most likely ν and μ.

    The coefficients take no part. ``known`` (t, n, k, m + p + 1) are M, U and r.
    """
    t, n, k, width = known.shape
    variances = stack.shared + (stack.std**2 / weights)[..., None] * np.eye(k)
    solved = np.linalg.solve(variances, known)
    flat = known.reshape(t, n * k, width)
    normal = flat.swapaxes(1, 2) @ solved.reshape(t, n * k, width)
    # Rows of calibration, and columns of the model's errors, behind them the residual.
    across = np.concatenate((normal[:, m:-1, :m], normal[:, m:-1, -1:]), axis=2)
    of_tow = np.linalg.solve(normal[:, m:-1, m:-1] + np.eye(width - 1 - m), across)
    matrix = np.sum(normal[:, :m, :m] - normal[:, :m, m:-1] @ of_tow[..., :m], axis=0)
    right = np.sum(normal[:, :m, -1] - (normal[:, :m, m:-1] @ of_tow[..., m:])[..., 0], axis=0)
    model = np.linalg.solve(matrix + np.eye(m), right)
    without = np.ones((t, 1, width, 1))
    without[:, 0, :m, 0] = -model
    without[:, 0, m:-1, 0] = of_tow[..., :m] @ model - of_tow[..., m]
    own: FloatArray = stack.std / weights * (solved @ without)[..., 0] * stack.present
    return own


def _extrapolated(
    updated: FloatArray, step: FloatArray, before: FloatArray | None
) -> tuple[FloatArray, FloatArray | None]:
    """Weights at the end of steps that fall by one factor (Aitken 1926).

    They are extrapolated after two such steps; given too is the step to compare the next with.
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
    m, p = tows[0].model.shape[2], tows[0].calibration.shape[2]
    q = width - p - m - 1
    diagonal = (stack.std**2 / every)[..., None] * np.eye(k)
    roots = np.asarray(np.linalg.cholesky(diagonal + stack.shared), np.float64)
    inverse = np.asarray(np.linalg.inv(roots), np.float64)
    rows = (inverse @ stack.columns).reshape(t, n * k, width)
    squares = rows.swapaxes(1, 2) @ rows
    determinants = 2.0 * np.log(np.diagonal(roots, axis1=2, axis2=3)).sum((1, 2))
    blocks = [
        Information(square[:-1, :-1], square[:-1, -1], float(square[-1, -1]), float(determinant))
        for square, determinant in zip(squares, determinants, strict=True)
    ]
    precision = np.concatenate((np.zeros(q), np.ones(m + p)))
    found = joined(blocks, [precision] * t, q + m)
    whole = Information(found.matrix, found.right, 0.0, 0.0)
    model = own_values(whole, found.precision, np.zeros(q))
    shared = np.concatenate((np.zeros(q), model))
    calibration = np.array([own_values(block, precision, shared) for block in blocks])
    parts = _explained(stack, inverse, every, model, calibration, huber)
    return NuisanceElimination(
        tuple(
            TowPart(
                tow,
                block,
                stack.std[place, : len(tow.rows)],
                every[place, : len(tow.rows)],
                roots[place, : len(tow.rows)],
                parts.own[place, : len(tow.rows)],
                calibration[place],
                parts.inputs[place, : len(tow.rows)],
                float(parts.costs[place]),
            )
            for place, (tow, block) in enumerate(zip(tows, blocks, strict=True))
        ),
        found,
        model,
    )


@dataclass(frozen=True)
class _Explained:
    """Most likely errors of readings: ``own`` (t, n, k), ``inputs`` (t, n, 4), ``costs`` (t,)."""

    own: FloatArray
    inputs: FloatArray
    costs: FloatArray


def _explained(
    stack: ErrorStack,
    inverse: FloatArray,
    every: FloatArray,
    model: FloatArray,
    calibration: FloatArray,
    huber: float,
) -> _Explained:
    """Find the most likely errors at Δ = 0."""
    m, p = len(model), calibration.shape[1]
    of_model, of_tow = (
        stack.columns[..., -(m + p + 1) : -(p + 1)],
        stack.columns[..., -(p + 1) : -1],
    )
    left = stack.residual - of_model @ model - (of_tow @ calibration[:, None, :, None])[..., 0]
    solved = inverse.swapaxes(2, 3) @ (inverse @ left[..., None])
    inputs = (stack.inputs.swapaxes(2, 3) @ solved)[..., 0]
    own = stack.std / every * solved[..., 0] * stack.present
    size = np.abs(own)
    loss = np.where(size <= huber, 0.5 * size**2, huber * (size - 0.5 * huber))
    squares = np.sum(inputs**2, (1, 2)) + np.sum(calibration**2, 1)
    return _Explained(own, inputs, loss.sum((1, 2)) + 0.5 * squares)
