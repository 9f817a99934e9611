# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records to be shown: each at a stamp (ns), in SI units, positions in ``map``."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from trawl_ros.core.arrays import FloatArray
from trawl_ros.plots.records import Quantities, Strand
from trawl_ros.records.samples import SonarImageSample, SonarScanSample
from trawl_ros.records.truth import SchoolTruth


@dataclass(frozen=True)
class ShipPose:
    """Pose of the ship: position (3,) midway between the towing blocks, heading (ENU yaw, rad)."""

    stamp: int
    position: FloatArray
    heading: float


@dataclass(frozen=True)
class Fix:
    """Position fix (3,)."""

    stamp: int
    position: FloatArray


@dataclass(frozen=True)
class Plate:
    """Plate of a door: position (3,), quaternion (x, y, z, w), sizes (3,) along its axes."""

    name: str
    position: FloatArray
    orientation: FloatArray
    size: FloatArray


@dataclass(frozen=True)
class Gear:
    """Gear in space, and the source of its shape in words."""

    stamp: int
    strands: tuple[Strand, ...]
    plates: tuple[Plate, ...]
    source: str


@dataclass(frozen=True)
class Schools:
    """All schools of fish."""

    stamp: int
    schools: tuple[SchoolTruth, ...]


@dataclass(frozen=True)
class SeenSchools:
    """Places (n, 3) in ``map`` at which the fish sonar detects schools."""

    stamp: int
    positions: FloatArray


@dataclass(frozen=True)
class Sweep:
    """Sweep of the trawl sonar, with the angles of its beams."""

    stamp: int
    image: SonarImageSample
    scan: SonarScanSample


@dataclass(frozen=True)
class Section:
    """Truth in the sonar's plane (n, 2), x down and y port: where ropes and twine pass through."""

    stamp: int
    points: FloatArray


@dataclass(frozen=True)
class Echoes:
    """Echoes of a sweep (n, 4): position in ``map`` and intensity, 0 to 255."""

    stamp: int
    points: FloatArray


@dataclass(frozen=True)
class Interval:
    """Estimate of a coefficient with its 95 % interval, and whether it is determined."""

    value: float
    low: float
    high: float
    determined: bool


@dataclass(frozen=True)
class Coefficients:
    """Estimates of the board coefficients by name, number of windows, and a sentence on them."""

    stamp: int
    windows: int
    intervals: Mapping[str, Interval]
    message: str


@dataclass(frozen=True)
class Innovations:
    """Innovations of a window by channel, over their standard deviations."""

    stamp: int
    deviations: Mapping[str, float]


Level = Literal['INFO', 'WARN', 'ERROR']


@dataclass(frozen=True)
class Note:
    """Note of a finding, estimator or controller, in words."""

    stamp: int
    source: str
    level: Level
    text: str


Shown = (
    Quantities
    | ShipPose
    | Fix
    | Gear
    | Schools
    | SeenSchools
    | Sweep
    | Section
    | Echoes
    | Coefficients
    | Innovations
    | Note
)
