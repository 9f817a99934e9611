# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion between compass angles, clockwise from north, and the axes of ``map``."""

import math

import numpy as np

from trawl_ros.core.arrays import FloatArray


def compass_yaw(compass: float) -> float:
    """Convert an angle clockwise from north to one counter-clockwise from east, -π to π.

    The conversion is its own inverse, apart from full turns.
    """
    return math.remainder(math.pi / 2 - compass, 2 * math.pi)


def course_velocity(speed: float, course: float) -> FloatArray:
    """Convert a speed and a compass course (rad) to a velocity (3,) in ``map``."""
    yaw = compass_yaw(course)
    return speed * np.array([math.cos(yaw), math.sin(yaw), 0.0])


def speed_course(velocity: FloatArray) -> tuple[float, float]:
    """Convert a velocity (3,) in ``map`` to its speed and compass course (rad, 0 to 2π)."""
    east, north = float(velocity[0]), float(velocity[1])
    return math.hypot(east, north), math.atan2(east, north) % (2 * math.pi)
