# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rotation matrices of rotation vectors, and back, compiled."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.compiled import compiled, promote_dtypes


def rotation(vector: FloatArray) -> FloatArray:
    """Return the rotation matrix of a rotation vector (Rodrigues), (..., 3) -> (..., 3, 3)."""
    (flat,) = promote_dtypes(vector.reshape(-1, 3))
    matrices = np.empty((len(flat), 3, 3), flat.dtype)
    _fill_rotations(flat, matrices)
    return matrices.reshape(*vector.shape, 3)


@compiled
def _fill_rotations(vectors: FloatArray, matrices: FloatArray) -> None:
    for n in range(len(vectors)):
        a, b, c = vectors[n, 0], vectors[n, 1], vectors[n, 2]
        square = a * a + b * b + c * c
        real = square.real
        # sin θ / θ and (1 - cos θ) / θ²; their series where θ² is small.
        if real < 1e-8:
            sine = 1 - square / 6 + square**2 / 120
            versine = 0.5 - square / 24
        else:
            size = np.sqrt(real)
            at_sine, at_versine = np.sin(size) / size, (1 - np.cos(size)) / real
            # The imaginary part is a complex step: its first-order term is exact to rounding.
            imaginary = 0.5 * (square - real) / real
            sine = at_sine + (1 - real * at_versine - at_sine) * imaginary
            versine = at_versine + (at_sine - 2 * at_versine) * imaginary
        for i in range(3):
            for j in range(3):
                matrices[n, i, j] = versine * vectors[n, i] * vectors[n, j]
            matrices[n, i, i] += 1 - versine * square
        matrices[n, 2, 1] += sine * a
        matrices[n, 1, 2] -= sine * a
        matrices[n, 0, 2] += sine * b
        matrices[n, 2, 0] -= sine * b
        matrices[n, 1, 0] += sine * c
        matrices[n, 0, 1] -= sine * c


def about_axis(axis: int, radians: float) -> FloatArray:
    """Return the rotation matrix about a coordinate axis (0, 1, 2)."""
    vector = np.zeros(3)
    vector[axis] = radians
    return rotation(vector)


def rotation_vector(matrices: FloatArray) -> FloatArray:
    """Return the rotation vectors of real rotation matrices, (..., 3, 3) -> (..., 3).

    It is the inverse of `rotation` for angles of less than π.
    """
    (flat,) = promote_dtypes(matrices.reshape(-1, 3, 3))
    vectors = np.empty((len(flat), 3))
    _fill_vectors(flat, vectors)
    return vectors.reshape(matrices.shape[:-1])


@compiled
def _fill_vectors(matrices: FloatArray, vectors: FloatArray) -> None:
    for n in range(len(matrices)):
        turn = matrices[n]
        # Unit quaternion (x, y, z, w) from its largest component, without cancellation
        # (Shepperd 1978).
        trace = turn[0, 0] + turn[1, 1] + turn[2, 2]
        best, most = 3, trace
        for i in range(3):
            if turn[i, i] > most:
                best, most = i, turn[i, i]
        if best == 3:
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                vectors[n, i] = turn[k, j] - turn[j, k]
            w = 1.0 + trace
        else:
            i, j, k = best, (best + 1) % 3, (best + 2) % 3
            vectors[n, i] = 1.0 + 2.0 * turn[i, i] - trace
            vectors[n, j] = turn[j, i] + turn[i, j]
            vectors[n, k] = turn[k, i] + turn[i, k]
            w = turn[k, j] - turn[j, k]
            if w < 0.0:
                w = -w
                vectors[n] *= -1.0
        size = np.sqrt(vectors[n, 0] ** 2 + vectors[n, 1] ** 2 + vectors[n, 2] ** 2)
        vectors[n] *= 2.0 * np.arctan2(size, w) / size if size > 1e-12 * w else 2.0 / w
