# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hidden effect of a trial: physics or an error of an instrument, of a size and a random shape.

Hidden effects are written apart from the catalogue that looks for them. They act through the
general hooks of the model: water, properties of ropes, forces on nodes, the law of the boards, and
what instruments show.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Situation
from trawl_ros.model.gear_model import GearModel

Readings = dict[str, float]


def ahead(at: Situation) -> FloatArray:
    """Unit vector (2,), east and north, of the heading."""
    return np.array([np.cos(at.heading), np.sin(at.heading)])


def _towed(size: float, inputs: FloatArray, at: Situation) -> FloatArray:
    return inputs


def _gear(size: float, model: GearModel, at: Situation) -> GearModel:
    return model


def _shown(size: float, readings: Readings, at: Situation) -> Readings:
    return readings


@dataclass(frozen=True)
class Hidden:
    """Hidden effect with a shape; a size of 0 is none.

    Attributes
    ----------
    name
        Name of the effect of the catalogue that should be named, or of something not in it.
    unit, probe
        Of the size, and one by which it is seen how much it shows.
    most
        Largest size that is possible, to both sides; 0 where a side is none.
    whole
        True if it is there as a whole or not at all, whatever its size.
    towed, gear, shown
        True inputs of the gear beside those the instruments show; the gear with the effect;
        what sensors show.
    """

    name: str
    unit: str
    probe: float
    most: tuple[float, float]
    towed: Callable[[float, FloatArray, Situation], FloatArray] = _towed
    gear: Callable[[float, GearModel, Situation], GearModel] = _gear
    shown: Callable[[float, Readings, Situation], Readings] = _shown
    whole: bool = False

    @property
    def signs(self) -> tuple[float, ...]:
        """Possible signs of its size."""
        return tuple(sign for sign, most in zip((-1.0, 1.0), self.most, strict=True) if most > 0.0)
