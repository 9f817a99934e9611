# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Receiver and screen: from echoes to an 8-bit image with noise and speckle."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import ByteArray, FloatArray
from trawl_ros.instruments.sonar.image import BRIGHTEST, Grid


def power(level: FloatArray | float) -> FloatArray:
    """Convert dB into a ratio of powers."""
    return 10 ** (np.asarray(level) / 10)


@dataclass(frozen=True)
class Receiver:
    """Receiver: conversion of an echo into brightness.

    ``source_level`` is in dB re 1 µPa m, ``noise_level`` in dB re 1 µPa in the receiver's band,
    ``absorption`` the one that the time-varied gain compensates, dB/m. The image is black at a
    target strength of ``black`` and white at ``white``, dB re 1 m².
    """

    source_level: float
    noise_level: float
    absorption: float
    black: float
    white: float

    def gain(self, ranges: FloatArray) -> FloatArray:
        """Return the time-varied gain (dB) at ranges (m): 40 log r + 2 α r, for point targets."""
        return 40 * np.log10(ranges) + 2 * self.absorption * ranges

    def unwanted(self, level: float, ranges: FloatArray) -> FloatArray:
        """Return the apparent cross-section (m²) of noise of a level (dB re 1 µPa) at ranges."""
        return power(level - self.source_level + self.gain(ranges))

    def brightness(self, strength: FloatArray, gain: float) -> ByteArray:
        """Return the image (uint8) of cross-sections (m²) with an excess ``gain`` (dB)."""
        level = 10 * np.log10(np.maximum(strength, np.finfo(float).tiny)) + gain
        share = (level - self.black) / (self.white - self.black)
        return np.clip(np.round(BRIGHTEST * share), 0, BRIGHTEST).astype(np.uint8)


@dataclass(frozen=True)
class Interference:
    """Interference: a pulse of ``length`` s every ``period`` s, at ``level`` dB re 1 µPa."""

    period: float
    length: float
    level: float


def heard(
    echoes: FloatArray, grid: Grid, receiver: Receiver, true_absorption: float, stretch: float
) -> FloatArray:
    """Return the mean received cross-sections (m²) with noise.

    By the sonar equation the received level is source level - 40 log r - 2 α r + target strength;
    the time-varied gain is added. It compensates spreading except for the ``stretch`` of ranges
    (assumed speed of sound over the true one), and the absorption that the receiver assumes.

    Parameters
    ----------
    echoes
        Shape (beams, cells), m², from `trawl_ros.instruments.sonar.echoes`.
    true_absorption
        Absorption in the water, dB/m.
    """
    ranges = grid.ranges
    true = ranges / stretch
    lost = 40 * np.log10(true) + 2 * true_absorption * true
    kept = power(receiver.gain(ranges) - lost)
    return echoes * kept + receiver.unwanted(receiver.noise_level, ranges)


def interfering(
    times: FloatArray, grid: Grid, receiver: Receiver, other: Interference, assumed_speed: float
) -> FloatArray:
    """Return the apparent cross-sections (beams, cells) of another sonar's pulses, m².

    Its pulses come at multiples of its period, independent of the ``times`` (beams,) of the pings
    (s). In the image they form a dotted spiral.
    """
    arrival = 2 * grid.ranges / assumed_speed
    into_period = (times[:, None] + arrival) % other.period
    # A pulse shorter than a cell still lights one.
    on = into_period < max(other.length, 2 * grid.cell / assumed_speed)
    return np.where(on, receiver.unwanted(other.level, grid.ranges), 0.0)


def speckled(mean: FloatArray, generator: np.random.Generator) -> FloatArray:
    """Return powers with speckle, exponentially distributed (Rayleigh in amplitude)."""
    return mean * generator.standard_exponential(mean.shape)
