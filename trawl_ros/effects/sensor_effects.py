"""Sensor effects on samples: readings with the errors of a gear file's effects.

The truth does not change. Counters and log show the inputs for which the effects return the true
inputs; sensors show the observables with the effects applied.
"""

from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Readings, Situation
from trawl_ros.effects.effect_set import EffectSet
from trawl_ros.model.water import Water
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import (
    AttitudeSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)

FIXED_POINT_ITERATIONS = 20
"""Iterations for the indicated inputs; each leaves a fifth of the error or less."""

HOUR_NS = 3600 * 1_000_000_000
DEPTHS = {
    'port': 'port_door_depth',
    'starboard': 'starboard_door_depth',
    'sonar': 'net_depth',
}
RANGES = {'spread': 'door_spread', 'opening_height': 'vertical_opening'}
OTHER = {'port': 'starboard', 'starboard': 'port'}
USUAL = np.array([500.0, 500.0, 2.0])
"""Warp lengths (m) and speed (m/s) where an instrument does not know the others'."""


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
        at = Situation((500.0, 500.0, 2.0), hours=(sample.stamp - self._first) / HOUR_NS)
        match sample:
            case WinchSample():
                lengths = self._instrument(np.array([*sample.lengths, USUAL[2]]), at)[:2]
                tensions = {
                    'port_tension': sample.tensions[0],
                    'starboard_tension': sample.tensions[1],
                }
                seen = self._sensors(tensions, at)
                return replace(
                    sample,
                    lengths=(float(lengths[0]), float(lengths[1])),
                    tensions=(seen['port_tension'], seen['starboard_tension']),
                )
            case VelocitySample(over='water'):
                ahead = self._instrument(np.array([*USUAL[:2], sample.velocity[0]]), at)[2]
                velocity = np.array([ahead, *sample.velocity[1:]])
                return replace(sample, velocity=velocity)
            case PressureSample() if sample.place in DEPTHS:
                name = DEPTHS[sample.place]
                depth = self._sensors({name: self._water.depth(sample.pressure)}, at)[name]
                return replace(sample, pressure=self._water.pressure(depth))
            case RangeSample() if sample.what in RANGES:
                name = RANGES[sample.what]
                distance = self._sensors({name: sample.distance}, at)[name]
                return replace(sample, distance=distance)
            case AttitudeSample():
                names = (f'{sample.side}_pitch', f'{sample.side}_roll')
                true = dict(zip(names, (sample.pitch, sample.roll), strict=True))
                pitch, roll = (self._sensors(true, at)[name] for name in names)
                return replace(sample, pitch=pitch, roll=roll)
            case _:
                return sample

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
