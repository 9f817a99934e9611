"""What instruments report: one record per kind of reading, stamped when it was sampled.

Stamps are integer nanoseconds; units are SI; a ``std`` is the sensor's *stated* noise.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class WinchSample:
    """Counter (m), pay-out speed (m/s) and load cell (N) of both winches, port first."""

    stamp: int
    lengths: tuple[float, float]
    speeds: tuple[float, float]
    tensions: tuple[float, float]


@dataclass(frozen=True)
class PressureSample:
    """Absolute pressure (Pa); ``place`` is 'port', 'starboard' (the doors) or 'sonar'."""

    stamp: int
    place: str
    pressure: float
    std: float


@dataclass(frozen=True)
class AttitudeSample:
    """A door's inclinometer: pitch (nose down positive) and roll (top to starboard), rad."""

    stamp: int
    side: str
    pitch: float
    roll: float
    std: float


@dataclass(frozen=True)
class RangeSample:
    """A distance in m; ``what`` is 'spread', 'opening_height' or 'opening_width'."""

    stamp: int
    what: str
    distance: float
    std: float
    min_range: float
    max_range: float


@dataclass(frozen=True)
class VelocitySample:
    """A velocity (3,) in m/s: ``over`` 'water' in frame vessel, ``over`` 'ground' in map."""

    stamp: int
    over: str
    velocity: np.ndarray
    yaw_rate: float


@dataclass(frozen=True)
class HeadingSample:
    """Heading as ENU yaw, rad."""

    stamp: int
    heading: float
    std: float


@dataclass(frozen=True)
class FixSample:
    """Position: latitude and longitude in degrees (WGS 84), std in m."""

    stamp: int
    latitude: float
    longitude: float
    std: float


Sample = (
    WinchSample
    | PressureSample
    | AttitudeSample
    | RangeSample
    | VelocitySample
    | HeadingSample
    | FixSample
)
