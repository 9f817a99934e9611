# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sweep of the trawl sonar: pings made while the gear moves, combined into an image."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import ByteArray, FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.sonar.absorption import absorption
from trawl_ros.instruments.sonar.detection import clear_echoes
from trawl_ros.instruments.sonar.echoes import Ping, Sounding, echoes
from trawl_ros.instruments.sonar.image import BRIGHTEST, Grid
from trawl_ros.instruments.sonar.records import SweepRecord
from trawl_ros.instruments.sonar.screen import heard, interfering, speckled
from trawl_ros.records.surroundings import Surroundings


@dataclass(frozen=True)
class Sweep:
    """Complete sweep.

    ``stamp`` (ns) is that of its first ping; ``image`` is (beams, cells), uint8; ``pings`` has one
    ping per row, from the first row on.
    """

    stamp: int
    image: ByteArray
    grid: Grid
    pings: tuple[Ping, ...]

    def points(self) -> FloatArray:
        """Return the clear echoes in ``map`` with their brightness, (n, 4).

        Their positions follow from the nominal angle of the row and the pose at its ping.
        """
        rows, columns = clear_echoes(self.image, self.grid)
        made = rows < len(self.pings)
        rows, columns = rows[made], columns[made]
        angles, away = self.grid.angles[rows], self.grid.ranges[columns]
        axes = np.array([ping.axes for ping in self.pings])[rows]
        start = np.array([ping.position for ping in self.pings])[rows]
        down, port = away * np.cos(angles), away * np.sin(angles)
        places = start + down[:, None] * axes[:, :, 0] + port[:, None] * axes[:, :, 1]
        return np.column_stack([places, self.image[rows, columns]])


@dataclass(frozen=True)
class SweepGenerators:
    """Random generators of an image: for fish, speckle and dead pings."""

    fish: np.random.Generator
    speckle: np.random.Generator
    dead: np.random.Generator


def image_of(
    pings: Sequence[Ping],
    stamp: int,
    record: SweepRecord,
    interval_s: float,
    gain: float,
    surroundings: Surroundings,
    luck: SweepGenerators,
) -> ByteArray:
    """Compute the image of a sweep.

    Parameters
    ----------
    pings
        Pings, one per beam from the first on; rows without a ping stay black.
    stamp
        Stamp of the first ping, ns.
    record
        Parameters of the sonar.
    interval_s
        Time from ping to ping, s.
    gain
        Excess gain of the receiver, dB; NaN if it is dead.
    surroundings
        Water around the sonar.
    luck
        Generators of random numbers.

    Returns
    -------
    array
        Shape (beams, cells), uint8.
    """
    grid, receiver = record.grid(), record.receiver()
    # Everything is drawn even if it has no effect: a fault changes no image after its end.
    dead = luck.dead.random(grid.beams) < record.dead_ping_share
    depth = max(0.0, -float(pings[0].position[2]))
    speed = surroundings.sound_speed(depth)
    sounding = Sounding(
        stretch=record.assumed_sound_speed_m_s / speed,
        pulse=0.5 * record.assumed_sound_speed_m_s * record.pulse_ms / 1e3,
    )
    met = echoes(pings, grid, record.beam(speed), record.strengths(), sounding, luck.fish)
    loss = absorption(
        1e3 * record.frequency_khz,
        surroundings.temperature(depth),
        surroundings.salinity,
        depth,
    )
    mean = heard(met, grid, receiver, loss, sounding.stretch)
    other = record.other_sonar()
    if other is not None:
        times = stamp / SECOND + interval_s * np.arange(grid.beams, dtype=float)
        mean += interfering(times, grid, receiver, other, record.assumed_sound_speed_m_s)
    level = speckled(mean, luck.speckle)
    image = np.zeros((grid.beams, grid.cells), dtype=np.uint8)
    if np.isfinite(gain):
        image[:] = receiver.brightness(level, gain)
        # The outgoing pulse saturates the receiver.
        image[:, grid.ranges < grid.min_range] = BRIGHTEST
    image[dead] = 0
    image[len(pings) :] = 0
    return image
