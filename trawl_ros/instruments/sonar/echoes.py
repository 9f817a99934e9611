# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Echoes in the beams of the trawl sonar: ropes, twine, fish and the seabed.

All echoes are backscattering cross-sections σ in m²; 10 log σ is the target strength. They are
weighted with the beam pattern on both ways.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.instruments.sonar.image import Grid
from trawl_ros.instruments.sonar.schools import inside
from trawl_ros.records.truth import SchoolTruth

HALF_POWER = 1.3915573782515103
"""Argument at which (sin u / u)² is one half."""

SEABED_STEPS = 4
"""Patches of the seabed per beam."""


@dataclass(frozen=True)
class Ping:
    """Ping: direction of the beam and the scatterers in reach.

    ``angle`` (rad) is measured as in the scan. ``position`` (3,) and ``axes`` (3, 3), with columns
    x, y, z, are the pose of frame ``sonar`` in ``map``. ``section`` (k, 3) is that of `NetTruth`;
    ``altitude`` (m) is the height above the seabed, infinite without one.
    """

    angle: float
    position: FloatArray
    axes: FloatArray
    section: FloatArray
    schools: tuple[SchoolTruth, ...] = ()
    altitude: float = np.inf


@dataclass(frozen=True)
class Beam:
    """Beam: full widths (rad) between half-power points, and ``wave_length`` (m).

    ``width`` is in the plane of the sweep, ``thickness`` across it.
    """

    width: float
    thickness: float
    wave_length: float

    def two_way(self, off: FloatArray) -> FloatArray:
        """Return the two-way power gain at angles (rad) off the axis in the plane of the sweep.

        It is that of a line transducer, (sin u / u)⁴, with side lobes of -26.5 dB; zero behind it.
        """
        u = HALF_POWER / np.pi * np.sin(off) / np.sin(0.5 * self.width)
        return np.where(np.abs(off) < np.pi / 2, np.sinc(u) ** 4, 0.0)


@dataclass(frozen=True)
class Strengths:
    """Backscattering strengths of scatterers.

    ``rope`` is the part of the sound on a rope or twine that is scattered in all directions;
    ``fish`` the cross-section of one fish, m²; ``seabed`` that of a square metre of seabed at
    normal incidence.
    """

    rope: float
    fish: float
    seabed: float


def rope_cross_section(
    diameter: FloatArray, distance: FloatArray, beam: Beam, strengths: Strengths
) -> FloatArray:
    """Return the cross-section (m²) of ropes that pass through a beam.

    A rope of diameter d has the length l = distance × thickness in the beam and receives the sound
    of the area d l. Laid and braided ropes are rough, so the part ``rope`` is scattered evenly in
    all directions: σ = rope d l / 4π. A thin rope, k a < 1, scatters less by (k a)³ (high-pass
    model of Johnson, J. Acoust. Soc. Am. 61, 1977).
    """
    radius = np.pi * diameter / beam.wave_length
    shape = radius**3 / (1 + radius**3)
    return strengths.rope * shape * diameter * distance * beam.thickness / (4 * np.pi)


@dataclass(frozen=True)
class Sounding:
    """Conversion of travel time into range.

    ``stretch`` is the assumed speed of sound over the true one; ``pulse`` (m) the length in range
    between the half-power points of the echo of a point.
    """

    stretch: float
    pulse: float


def echoes(
    pings: Sequence[Ping],
    grid: Grid,
    beam: Beam,
    strengths: Strengths,
    sounding: Sounding,
    generator: np.random.Generator,
) -> FloatArray:
    """Return the mean received cross-section of each beam and cell.

    Parameters
    ----------
    pings
        One ping per beam.
    generator
        Generator for the number of fish in a cell; not used without a school.

    Returns
    -------
    array
        Shape (beams, cells), m².
    """
    axis = np.array([ping.angle for ping in pings])
    received = _ropes(pings, axis, grid, beam, strengths, sounding.stretch)
    if any(ping.altitude < grid.max_range for ping in pings):
        received += _seabed(pings, axis, grid, beam, strengths, sounding.stretch)
    if any(ping.schools for ping in pings):
        received += _fish(pings, axis, grid, beam, strengths, sounding.stretch, generator)
    return _as_long_as_a_pulse(received, sounding.pulse / grid.cell)


def _ropes(
    pings: Sequence[Ping],
    axis: FloatArray,
    grid: Grid,
    beam: Beam,
    strengths: Strengths,
    stretch: float,
) -> FloatArray:
    rows = np.repeat(np.arange(len(pings)), [len(ping.section) for ping in pings])
    x, y, diameter = np.concatenate([ping.section for ping in pings]).T
    distance = np.hypot(x, y)
    strength = rope_cross_section(diameter, distance, beam, strengths)
    strength *= beam.two_way(_turned(np.arctan2(y, x) - axis[rows]))
    return _gathered(rows, stretch * distance, strength, grid)


def _seabed(
    pings: Sequence[Ping],
    axis: FloatArray,
    grid: Grid,
    beam: Beam,
    strengths: Strengths,
    stretch: float,
) -> FloatArray:
    """Return the cross-sections of a level seabed in patches, by Lambert's law (cosine squared)."""
    step = grid.angle_increment / SEABED_STEPS
    angle = np.arange(-0.5 * np.pi, 0.5 * np.pi, step)
    down = np.array([-ping.axes[2] for ping in pings])
    altitude = np.array([ping.altitude for ping in pings])
    # Downward component of each direction in the sonar's plane.
    slope = np.outer(down[:, 0], np.cos(angle)) + np.outer(down[:, 1], np.sin(angle))
    row, column = np.nonzero(slope * grid.max_range > stretch * altitude[:, None])
    slope = slope[row, column]
    distance = altitude[row] / slope
    # A width r dφ normal to the ray is r dφ / slope along the seabed.
    area = distance * step * distance * beam.thickness / slope
    strength = strengths.seabed * slope**2 * area * beam.two_way(angle[column] - axis[row])
    return _gathered(row, stretch * distance, strength, grid)


def _fish(
    pings: Sequence[Ping],
    axis: FloatArray,
    grid: Grid,
    beam: Beam,
    strengths: Strengths,
    stretch: float,
    generator: np.random.Generator,
) -> FloatArray:
    """Return the cross-sections of fish, drawn cell by cell, in all beams that receive them."""
    true_cell = grid.cell / stretch
    ranges = grid.ranges / stretch
    volume = true_cell * (ranges * grid.angle_increment) * (ranges * beam.thickness)
    expected = np.zeros((len(pings), grid.cells))
    for row, ping in enumerate(pings):
        way = ping.axes[:, 0] * np.cos(ping.angle) + ping.axes[:, 1] * np.sin(ping.angle)
        for school in ping.schools:
            near, far = inside(school, ping.position, way[None])
            within = (ranges >= near) & (ranges <= far)
            expected[row, within] += school.density * volume[within]
    fish = generator.poisson(expected)
    return strengths.fish * (beam.two_way(_turned(axis[:, None] - axis)) @ fish)


def _turned(angle: FloatArray) -> FloatArray:
    return (angle + np.pi) % (2 * np.pi) - np.pi


def _gathered(rows: IntArray, ranges: FloatArray, strengths: FloatArray, grid: Grid) -> FloatArray:
    """Distribute point targets over cells; the two nearest cells share each target."""
    place = ranges / grid.cell - 0.5
    first = np.floor(place).astype(int)
    share = place - first
    total = np.zeros(grid.beams * grid.cells)
    for column, weight in ((first, 1 - share), (first + 1, share)):
        there = (column >= 0) & (column < grid.cells)
        total += np.bincount(
            rows[there] * grid.cells + column[there],
            (weight * strengths)[there],
            minlength=len(total),
        )
    return total.reshape(grid.beams, grid.cells)


def _as_long_as_a_pulse(received: FloatArray, cells: float) -> FloatArray:
    """Smear each cell over a bell curve of ``cells`` cells between half-power points.

    The peak keeps its height: the echo of a point has its full strength for the whole pulse.
    """
    reach = int(np.ceil(1.5 * cells))
    bell = 0.5 ** ((2 * np.arange(-reach, reach + 1) / cells) ** 2)
    padded = np.pad(received, ((0, 0), (reach, reach)))
    width = received.shape[1]
    filtered: FloatArray = sum(weight * padded[:, k : k + width] for k, weight in enumerate(bell))
    return filtered
