# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sensor effects on samples: readings with the errors of a gear file's effects.

The truth does not change. Counters and log show the inputs for which the effects return the true
inputs; sensors show the observables with the effects applied.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.effects.base.effect import Readings, Situation
from trawl_ros.effects.effect_set import EffectSet
from trawl_ros.model.water import Water
from trawl_ros.records.channels import INPUTS, channel_values, with_channel_values
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import Sample

FIXED_POINT_ITERATIONS = 20
"""Iterations for the indicated inputs; each leaves a fifth of the error or less."""

HOUR_NS = 3600 * SECOND
OTHER = {'port': 'starboard', 'starboard': 'port'}
USUAL_INPUTS = (500.0, 500.0, 2.0)
"""Warp lengths (m) and speed (m/s) in place of those that an instrument does not measure."""


def _other_side(name: str) -> str:
    side, _, quantity = name.partition('_')
    return f'{OTHER[side]}_{quantity}' if side in OTHER else name


class SensorEffects:
    """Converter of error-free samples into those of a gear with effects.

    Parameters
    ----------
    effect_set
        Effects of the gear; if there are none, samples pass unchanged.
    water
        Density profile that converts pressure into depth and back.

    Attributes
    ----------
    water : Water
        That density profile.
    """

    def __init__(self, effect_set: EffectSet, water: Water) -> None:
        self._effect_set = effect_set
        self.water = water
        self._first: int | None = None
        self._last: Readings = {}

    def __call__(self, sample: Sample) -> Sample:
        """Return the sample with the effects applied."""
        if not self._effect_set:
            return sample
        if self._first is None or sample.stamp < self._first:
            self._first = sample.stamp
        at = Situation(USUAL_INPUTS, hours=(sample.stamp - self._first) / HOUR_NS)
        true = channel_values(sample, self.water.depth)
        shown: Readings = {}
        if not true.keys().isdisjoint(INPUTS):
            inputs = [true.get(*usual) for usual in zip(INPUTS, USUAL_INPUTS, strict=True)]
            shown = dict(
                zip(INPUTS, map(float, self._instrument(np.array(inputs), at)), strict=True)
            )
        if known := {name: true[name] for name in true if name in OBSERVABLES}:
            shown |= self._sensors(known, at)
        changed = {name: value for name, value in shown.items() if name in true}
        return with_channel_values(sample, changed, self.water.pressure)

    def _sensors(self, known: Readings, at: Situation) -> Readings:
        """Return the readings of sensors.

        Each depends on its own observable and on the last one of the other side; before that is
        known, both sides are taken to be the same.
        """
        self._last.update(known)
        both = {_other_side(name): value for name, value in known.items()}
        true = {**dict.fromkeys(OBSERVABLES, 0.0), **both, **self._last}
        return self._effect_set.apply_to_sensors(true, at)

    def _instrument(self, true: FloatArray, at: Situation) -> FloatArray:
        """Return the indicated inputs whose true inputs are ``true``, by fixed-point iteration."""
        shown = true
        for _ in range(FIXED_POINT_ITERATIONS):
            shown = shown + true - self._effect_set.apply_to_inputs(shown, at)
        return shown
