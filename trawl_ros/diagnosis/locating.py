# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Localisation of a misfit: channels, and the variables that their residuals follow."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.inference.marginal import MIN_INFORMATION
from trawl_ros.diagnosis.inference.patterns import SHAPES, ResidualPattern
from trawl_ros.diagnosis.inference.screen import Screen

SIGNIFICANT_Z = 3.0
"""Standard deviations from which a pattern is significant."""

DIRECTIONS = {
    'throughout': ('too large throughout', 'too small throughout'),
    'course': ('too large on eastward courses', 'too large on westward courses'),
}


@dataclass(frozen=True)
class Where:
    """Residuals of a channel that follow a variable.

    ``z`` is their size in standard deviations of the errors; ``region`` describes it in words.
    """

    channel: str
    variable: str
    region: str
    z: float


def located(test: Screen) -> tuple[Where, ...]:
    """All patterns, the most significant first."""
    places = []
    for place, pattern in enumerate(test.patterns, test.number):
        information = float(test.marginal.information[place, place])
        if information <= MIN_INFORMATION:
            continue
        z = float(test.marginal.score[place]) / float(np.sqrt(information))
        places.append(Where(pattern.channel, pattern.shape, _region(test, pattern, z), z))
    return tuple(sorted(places, key=lambda where: -abs(where.z)))


def significant_patterns(test: Screen) -> tuple[Where, ...]:
    """Significant patterns."""
    return tuple(where for where in located(test) if abs(where.z) >= SIGNIFICANT_Z)


def map_of(test: Screen) -> tuple[list[str], list[str], FloatArray]:
    """Channels, variables and z (channels, variables), NaN where a pattern is unobservable."""
    z_of = {(where.channel, where.variable): where.z for where in located(test)}
    channels = list(dict.fromkeys(pattern.channel for pattern in test.patterns))
    variables = [name for name in SHAPES if any(p.shape == name for p in test.patterns)]
    z = [[z_of.get((channel, name), np.nan) for name in variables] for channel in channels]
    return channels, variables, np.array(z)


def _region(test: Screen, pattern: ResidualPattern, z: float) -> str:
    words = DIRECTIONS.get(pattern.shape)
    if words is not None:
        return words[0] if z > 0.0 else words[1]
    name = pattern.shape
    return f'{"grows" if z > 0.0 else "falls"} with {name}'
