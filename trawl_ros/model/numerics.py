# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Mathematics shared by the physics; all of it works with the complex step.

The complex step differentiates a function to rounding: f'(x) = Im f(x + i h) / h (Squire and
Trapp 1998). Every operation must be analytic; numpy's ``abs``, ``norm`` and ``arctan2`` are not.
"""

from typing import cast

import numpy as np

from trawl_ros.core.arrays import FloatArray

STEP = 1e-30
"""Imaginary step h; no difference is taken, so it causes no cancellation."""

ROOT_FLOOR = 1e-18
"""Added to a sum of squares (m² or m²/s²) below a root, which has no derivative at zero."""


def stepped(values: FloatArray, direction: FloatArray) -> FloatArray:
    """Return values with an imaginary step along a direction; typed as real for the physics."""
    return cast(FloatArray, values + 1j * STEP * direction)


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the scalar product along the last axis, without conjugation."""
    product: FloatArray = np.einsum('...i,...i->...', a, b)
    return product


def length(a: FloatArray, floor: float = 0.0) -> FloatArray:
    """Return the Euclidean length along the last axis.

    A positive ``floor`` keeps the derivative finite at zero.
    """
    return np.sqrt(dot(a, a) + floor * floor)


def outer(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the dyadic product along the last axis, shape (..., 3, 3)."""
    return a[..., :, None] * b[..., None, :]


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the vector product along the last axis, five times as fast as numpy on few vectors."""
    product = np.empty(np.broadcast_shapes(a.shape, b.shape), np.result_type(a, b))
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    product[..., 0] = ay * bz - az * by
    product[..., 1] = az * bx - ax * bz
    product[..., 2] = ax * by - ay * bx
    return product


def skew(a: FloatArray) -> FloatArray:
    """Return the matrix S(a) with S(a) b = a × b, shape (..., 3, 3)."""
    matrix = np.zeros((*a.shape, 3), a.dtype)
    matrix[..., 2, 1] = a[..., 0]
    matrix[..., 0, 2] = a[..., 1]
    matrix[..., 1, 0] = a[..., 2]
    return matrix - transpose(matrix)


def transpose(matrix: FloatArray) -> FloatArray:
    """Return the transpose of the last two axes."""
    return np.swapaxes(matrix, -1, -2)
