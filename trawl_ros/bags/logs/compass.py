"""Conversion of compass angles, clockwise from north, into the axes of ``map``."""

import math

import numpy as np

from trawl_ros.core.arrays import FloatArray


def compass_yaw(compass: float) -> float:
    """Convert an angle clockwise from north into one counter-clockwise from east, -π to π."""
    return math.remainder(math.pi / 2 - compass, 2 * math.pi)


def course_velocity(speed: float, course: float) -> FloatArray:
    """Convert a speed and a compass course (rad) into a velocity (3,) in ``map``."""
    yaw = compass_yaw(course)
    return speed * np.array([math.cos(yaw), math.sin(yaw), 0.0])
