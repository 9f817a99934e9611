"""Receiver and screen: from echoes to an image with levels, noise, speckle and 8 bits."""

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

    ``source_level`` dB re 1 µPa m; ``noise_level`` dB re 1 µPa in the receiver's band;
    ``absorption`` dB/m that the time-varied gain makes good; the image is black at a target
    strength of ``black`` and white at ``white``, dB re 1 m².
    """

    source_level: float
    noise_level: float
    absorption: float
    black: float
    white: float

    def gain(self, ranges: FloatArray) -> FloatArray:
        """Time-varied gain (dB) at ranges (m), 40 log r + 2 α r: a point stays as bright."""
        return 40 * np.log10(ranges) + 2 * self.absorption * ranges

    def unwanted(self, level: float, ranges: FloatArray) -> FloatArray:
        """Apparent cross-section (m²) of sound of a level (dB re 1 µPa) at ranges (m)."""
        return power(level - self.source_level + self.gain(ranges))

    def brightness(self, strength: FloatArray, gain: float) -> ByteArray:
        """Image (uint8) of cross-sections (m²), with an excess ``gain`` (dB)."""
        level = 10 * np.log10(np.maximum(strength, np.finfo(float).tiny)) + gain
        share = (level - self.black) / (self.white - self.black)
        return np.clip(np.round(BRIGHTEST * share), 0, BRIGHTEST).astype(np.uint8)


@dataclass(frozen=True)
class Interference:
    """Interference: a pulse of ``length`` s every ``period`` s, of ``level`` dB re 1 µPa here."""

    period: float
    length: float
    level: float


def heard(
    echoes: FloatArray, grid: Grid, receiver: Receiver, true_absorption: float, stretch: float
) -> FloatArray:
    """Received cross-sections (m²), mean with noise.

    The sonar equation: source level - 40 log r - 2 α r + target strength is received, and
    time-varied gain is put on top. It makes spreading good but for the ``stretch`` of ranges
    (assumed speed of sound over the true one), and absorption as far as the receiver knows it.

    Parameters
    ----------
    echoes
        Shape (beams, cells), m², from `trawl_ros.instruments.sonar.echoes`.
    true_absorption
        Of the water, dB/m.
    """
    ranges = grid.ranges
    true = ranges / stretch
    lost = 40 * np.log10(true) + 2 * true_absorption * true
    kept = power(receiver.gain(ranges) - lost)
    return echoes * kept + receiver.unwanted(receiver.noise_level, ranges)


def interfering(
    times: FloatArray, grid: Grid, receiver: Receiver, other: Interference, assumed_speed: float
) -> FloatArray:
    """Apparent cross-sections (beams, cells) of another sonar's pulses, m².

    Its pulses come at whole multiples of its period, whatever the ``times`` (beams,) of the
    pings (s): they wander through the image as a dotted spiral.
    """
    arrival = 2 * grid.ranges / assumed_speed
    into_period = (times[:, None] + arrival) % other.period
    # A pulse shorter than a cell still lights one.
    on = into_period < max(other.length, 2 * grid.cell / assumed_speed)
    return np.where(on, receiver.unwanted(other.level, grid.ranges), 0.0)


def speckled(mean: FloatArray, generator: np.random.Generator) -> FloatArray:
    """Speckle: power of many waves with random phases, Rayleigh in amplitude, here squared."""
    return mean * generator.standard_exponential(mean.shape)
