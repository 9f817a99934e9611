# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Starts of a fit for boards that have no steady state at the start of the prior."""

from collections.abc import Iterator, Mapping
from itertools import islice

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.first_guess import FIRST_LEAN
from trawl_ros.solver.trimming.standing_boards import CoefficientRange, standing_coefficients

MOST_STARTS = 8
"""Number of starts, the stiffest first, of which nearly each has a steady state."""


def standing_starts(
    model: GearModel, prior: ParameterVector, means: Mapping[str, float]
) -> Iterator[FloatArray]:
    """Yield parameters (q,) with which the boards of a gear stand as means show them.

    Parameters
    ----------
    model
        The gear; none come of one without boards.
    prior
        Of the parameters.
    means
        Means by channel, those of inputs and attitudes among them, SI.
    """
    if model.paired:
        return
    own = prior.slice_of('coefficients')
    pitch = _mean(means, 'port_pitch', 'starboard_pitch', 1.0, 0.0)
    roll = _mean(means, 'port_roll', 'starboard_roll', -1.0, FIRST_LEAN)
    tilt = float(np.copysign(np.arccos(np.cos(pitch) * np.cos(roll)), roll))
    place = 0.5 * (means['port_length'] + means['starboard_length']), means['speed']
    known = CoefficientRange(prior.start[own], prior.std[own], prior.low[own], prior.high[own])
    found = standing_coefficients(model, known, place, inclination=tilt, pitch=pitch)
    for values in islice(found, MOST_STARTS):
        start = np.array(prior.start)
        start[own] = values
        yield start


def _mean(
    means: Mapping[str, float], port: str, starboard: str, mirrored: float, otherwise: float
) -> float:
    """Mean angle (rad) of both boards as that of the port one; ``otherwise`` without sensors."""
    seen = [means[port]] if port in means else []
    seen += [mirrored * means[starboard]] if starboard in means else []
    return float(np.mean(seen)) if seen else otherwise
