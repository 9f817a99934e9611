# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records for drawing: series over time, the gear at an instant, a sweep of the sonar."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.records.samples import SonarImageSample, SonarScanSample

SCHOOLS = 'schools'
"""Name of the strands of fish schools."""


Kind = Literal['truth', 'measured', 'wanted', 'model']
"""Origin of a quantity: the simulation, an instrument, a command, or a state of the model."""


@dataclass(frozen=True)
class Quantities:
    """Values of quantities by the names of `TowHistory`."""

    stamp: int
    kind: Kind
    values: Mapping[str, float]


@dataclass(frozen=True)
class Series:
    """Series of a quantity: times (n,) in s since the tow's start, rising, and values (n,), SI."""

    times: FloatArray
    values: FloatArray

    def at(self, time: float) -> float:
        """Value at a time (s), by linear interpolation; NaN outside and without any."""
        known = np.isfinite(self.values)
        if not known.any():
            return float('nan')
        times, values = self.times[known], self.values[known]
        return float(np.interp(time, times, values, left=np.nan, right=np.nan))

    def near(self, time: float, most: float) -> float:
        """Value of the reading nearest to a time (s), at most ``most`` away; else NaN."""
        known = np.isfinite(self.values)
        away = np.abs(self.times[known] - time)
        if not len(away) or away.min() > most:
            return float('nan')
        return float(self.values[known][np.argmin(away)])


@dataclass(frozen=True)
class TowHistory:
    """Series of a tow.

    Attributes
    ----------
    name : str
        Of the tow in titles.
    start : int
        Stamp of time 0, ns.
    duration_s : float
        Until the last stamp, s.
    truth, measured : dict of Series
        By quantity: ``port_length``, ``starboard_length``, ``…_tension``, ``…_door_depth``,
        ``…_pitch``, ``…_roll``, ``door_spread``, ``net_depth``, ``opening_height``,
        ``opening_width``, ``speed_water``, ``drift_water`` (to port), ``speed_ground``,
        ``ground_east``, ``ground_north``, ``heading`` (ENU, continuous), ``east``, ``north``.
        What is not in the bag is not here.
    log_lag : int
        By how much (ns) messages are logged later than they are stamped, in the middle.
    problems : tuple of str
        A sentence for each thing found wrong.
    """

    name: str
    start: int
    duration_s: float
    truth: Mapping[str, Series]
    measured: Mapping[str, Series]
    log_lag: int
    problems: tuple[str, ...]

    def stamp(self, time: float) -> int:
        """Stamp (ns) of a time (s)."""
        return self.start + round(time * SECOND)

    def time(self, stamp: int) -> float:
        """Time (s) of a stamp (ns)."""
        return (stamp - self.start) / SECOND

    def best(self, name: str) -> Series | None:
        """Truth of a quantity if the bag holds it, else its readings."""
        return self.truth.get(name) or self.measured.get(name)


@dataclass(frozen=True)
class Strand:
    """Strand of the gear: pieces (n, 2, 3) of lines, m, each with its colour (n, 3)."""

    name: str
    pieces: FloatArray
    colours: FloatArray


@dataclass(frozen=True)
class GearShape:
    """Shape of the gear at ``time`` (s), in the ship's axes: astern, to port, up from the blocks.

    ``source`` says in words where it comes from; ``by_tension`` whether colours are tensions.
    """

    time: float
    strands: tuple[Strand, ...]
    source: str
    by_tension: bool


@dataclass(frozen=True)
class SonarPicture:
    """Sonar sweep at ``time`` (s) with its readings and the truth.

    ``height`` and ``width`` are the readings (m, NaN without). ``mouth`` (n, 2) is truth in the
    plane of frame ``sonar`` (x down, y port), m: where ropes and twine pass through it, or
    corners of the mouth; ``closed`` says that they are corners, to be joined.
    """

    time: float
    image: SonarImageSample
    scan: SonarScanSample
    height: float
    width: float
    mouth: FloatArray
    closed: bool
