# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Slowest mode of the gear: its decay time and its shape in the observables.

After a change of warp length or speed, doors and net sink or rise for minutes, while tension and
spread settle soon. The rest of this motion in a window is one amplitude times one shape.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP
from trawl_ros.model.observables import observe
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.modes import LinearisedMotion
from trawl_ros.solver.rest_linearisation import rest_linearisation

SOUGHT_MODES = 4
"""Number of modes sought, with the eigenvalues nearest to 0."""

NET, PORT, STARBOARD = map(
    OBSERVABLES.index, ('net_depth', 'port_door_depth', 'starboard_door_depth')
)
MAX_DOOR_ASYMMETRY = 0.2
"""Largest difference of the doors' depths per depth of the net in a motion that warp length and
speed cause."""


@dataclass(frozen=True)
class SlowMode:
    """Slow mode: decay time (s) to 1/e and shape in the observables per metre of net depth.

    Both are 0 for a gear without a mode that moves the net.
    """

    decay_s: float
    shape: FloatArray


def slow_mode(model: GearModel, found: Equilibrium) -> SlowMode:
    """Find the slowest symmetric motion of M ẍ + C ẋ + K x = 0 by shift-invert."""
    at = model, found.state, found.tow
    known = rest_linearisation(*at)
    motion = LinearisedMotion(
        model.pattern, mass(*at), known.motion.damping, known.motion.stiffness
    )
    rates, shapes = motion.nearest(0.0, SOUGHT_MODES, tolerance=1e-4, factor=known.factor)
    best = SlowMode(0.0, np.zeros(len(OBSERVABLES)))
    for rate, vector in zip(rates, shapes.T, strict=True):
        if abs(rate.imag) > 1e-6 * abs(rate) or rate.real >= 0.0:
            continue
        along = found.state.moved(1j * STEP * vector.real)
        shape = observe(model, along, found.tow).array().imag / STEP
        lopsided = abs(shape[PORT] - shape[STARBOARD]) > MAX_DOOR_ASYMMETRY * abs(shape[NET])
        if not lopsided and shape[NET] != 0.0 and -1.0 / rate.real > best.decay_s:
            best = SlowMode(float(-1.0 / rate.real), shape / shape[NET])
    return best
