# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion of quaternions (x, y, z, w) and roll, pitch, yaw (x forward, y port, z up).

The order is Rz(yaw) Ry(pitch) Rx(roll): with y to port a positive pitch puts the nose down,
and a positive roll leans the top to starboard.
"""

import math
from collections.abc import Sequence

import numpy as np

from trawl_ros.core.arrays import FloatArray

UNIT_TOLERANCE = 1e-3
"""Largest deviation of a quaternion's length from 1 for an orientation."""


def to_quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Turn angles (rad) into a unit quaternion (x, y, z, w)."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def to_angles(quaternion: Sequence[float]) -> tuple[float, float, float]:
    """Turn a unit quaternion (x, y, z, w) into (roll, pitch, yaw), rad.

    A quaternion with NaN gives NaN: the reading is missing.

    Raises
    ------
    ValueError
        If the quaternion is not of unit length.
    """
    x, y, z, w = (float(part) for part in quaternion)
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if math.isnan(norm):
        return math.nan, math.nan, math.nan
    if abs(norm - 1.0) > UNIT_TOLERANCE:
        raise ValueError(f'orientation ({x:g}, {y:g}, {z:g}, {w:g}) is not a unit quaternion')
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return roll, pitch, yaw


def about_z(angle: float) -> FloatArray:
    """Return the matrix (3, 3) from components in a yawed frame to those in the fixed frame."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation_matrix(quaternion: FloatArray) -> FloatArray:
    """Return the matrix (3, 3) of a unit quaternion (x, y, z, w)."""
    x, y, z, w = np.asarray(quaternion, dtype=float) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
