"""Sensor effects on samples: readings with the errors of a gear file's effects.

Truth stays unchanged: counters and log show the numbers at which the effects return the true
inputs, and sensors show the observables with the effects applied.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Readings, Situation
from trawl_ros.effects.effect_set import EffectSet
from trawl_ros.model.water import Water
from trawl_ros.records.channels import INPUTS, channel_values, with_channel_values
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import Sample

ROUNDS = 20
"""Of fixed points; each round leaves a fifth of what is missing, or less."""

HOUR_NS = 3600 * 1_000_000_000
OTHER = {'port': 'starboard', 'starboard': 'port'}
USUAL = (500.0, 500.0, 2.0)
"""Warp lengths (m) and speed (m/s) where an instrument does not know the others'."""


def _other_side(name: str) -> str:
    side, _, quantity = name.partition('_')
    return f'{OTHER[side]}_{quantity}' if side in OTHER else name


class SensorEffects:
    """Converter of error-free samples into those of a gear with effects.

    Parameters
    ----------
    effect_set
        The effects; without any, samples pass unchanged.
    water
        Turns pressure into depth and back.
    """

    def __init__(self, effect_set: EffectSet, water: Water) -> None:
        self._effect_set = effect_set
        self._water = water
        self._first: int | None = None
        self._last: Readings = {}

    def __call__(self, sample: Sample) -> Sample:
        """Return the sample with the effects applied."""
        if not self._effect_set:
            return sample
        if self._first is None or sample.stamp < self._first:
            self._first = sample.stamp
        at = Situation(USUAL, hours=(sample.stamp - self._first) / HOUR_NS)
        true = channel_values(sample, self._water.depth)
        shown: Readings = {}
        if not true.keys().isdisjoint(INPUTS):
            inputs = [true.get(*usual) for usual in zip(INPUTS, USUAL, strict=True)]
            shown = dict(
                zip(INPUTS, map(float, self._instrument(np.array(inputs), at)), strict=True)
            )
        if known := {name: true[name] for name in true if name in OBSERVABLES}:
            shown |= self._sensors(known, at)
        changed = {name: value for name, value in shown.items() if name in true}
        return with_channel_values(sample, changed, self._water.pressure)

    def _sensors(self, known: Readings, at: Situation) -> Readings:
        """Readings of sensors; each depends on its own observable, and on that of the other side as
        it was last, or is the same there before that is known.
        """
        self._last.update(known)
        both = {_other_side(name): value for name, value in known.items()}
        true = {**dict.fromkeys(OBSERVABLES, 0.0), **both, **self._last}
        return self._effect_set.apply_to_sensors(true, at)

    def _instrument(self, true: FloatArray, at: Situation) -> FloatArray:
        """Indicated inputs at which the gear is towed with ``true``, by fixed-point iteration."""
        shown = true
        for _ in range(ROUNDS):
            shown = shown + true - self._effect_set.apply_to_inputs(shown, at)
        return shown
