# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ground truth: record of the simulation at one instant, which every instrument observes.

All positions are in ``map`` (ENU, z = 0 at the mean surface, m), all angles in radians,
all stamps in integer nanoseconds. Door frames are x forward, y port, z up on both sides.
Quaternions are ``(x, y, z, w)``.
"""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from trawl_ros.core.arrays import FloatArray
from trawl_ros.records.observables import Observables

SIDES = ('port', 'starboard')


def single(values: ArrayLike) -> FloatArray:
    """Round values to 32-bit floats, the precision of point clouds.

    Values published as a point cloud are rounded at once, so that instruments in the graph and in
    one process see identical values.
    """
    return np.asarray(values, dtype=np.float32).astype(float)


@dataclass(frozen=True)
class DoorTruth:
    """Truth of an otter board as a rigid body.

    ``velocity`` (m/s), ``angular_velocity`` (rad/s), ``force`` (N) and ``moment`` (N m, about
    the centre of gravity) are given in the door frame; ``attack``, ``slip`` and
    ``inclination`` are α, β, δ of eq. 1, 2 and 38 (rad).
    """

    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    angular_velocity: FloatArray
    attack: float
    slip: float
    inclination: float
    force: FloatArray
    moment: FloatArray


@dataclass(frozen=True)
class WinchTruth:
    """Truth of a winch: warp length (m), pay-out speed (m/s, out positive), block tension (N)."""

    length: float
    speed: float
    tension: float


@dataclass(frozen=True)
class NetTruth:
    """Truth of the net's mouth.

    ``mouth`` holds N points of the headrope from port to starboard, then N of the footrope
    back, shape (2 N, 3); openings and ``headrope_depth`` are in m, depth positive down.
    ``sonar_position`` and ``sonar_orientation`` are the pose of frame ``sonar`` (x down,
    y port, z forward) in ``map``. ``section``, shape (k, 3), is where ropes and twine pass
    through the sonar's plane: x and y in its frame and the diameter, m.
    """

    mouth: FloatArray
    horizontal_opening: float
    vertical_opening: float
    headrope_depth: float
    sonar_position: FloatArray
    sonar_orientation: FloatArray
    section: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))

    @property
    def section_width(self) -> float:
        """Width of the mouth in the sonar's plane, m; NaN where nothing passes through it."""
        return float(np.ptp(self.section[:, 1])) if len(self.section) else float('nan')

    @property
    def section_height(self) -> float:
        """Depth of the lowest rope in the sonar's plane below the sonar, m; NaN if none."""
        return float(self.section[:, 0].max()) if len(self.section) else float('nan')


@dataclass(frozen=True)
class VesselTruth:
    """Truth of the ship: position midway between the blocks, heading (ENU yaw), yaw rate (rad/s).

    ``velocity_ground`` is in ``map``, ``velocity_water`` relative to the water at the
    surface in frame ``vessel`` (x forward, y port, z up), m/s.
    """

    position: FloatArray
    heading: float
    yaw_rate: float
    velocity_ground: FloatArray
    velocity_water: FloatArray


@dataclass(frozen=True)
class SchoolTruth:
    """Truth of a school of fish: an ellipsoid with axes along those of ``map``.

    ``position`` (3,) of its middle and ``size`` (3,), its extent along each axis, in m;
    ``density`` in fish per m³.
    """

    position: FloatArray
    size: FloatArray
    density: float


@dataclass(frozen=True)
class SeabedTruth:
    """Truth of the seabed: depth below the mean surface, m; infinite if there is none."""

    under_ship: float = math.inf
    under_headrope: float = math.inf


@dataclass(frozen=True)
class Truth:
    """Truth at one instant. ``doors`` and ``winches`` are in the order of `SIDES`.

    Attributes
    ----------
    stamp
        ns.
    doors, winches
        Poses, flow angles and loads of the boards; lengths, speeds and tensions of the warps.
    net
        Mouth (2 N, 3), openings and depth of the headrope, m.
    vessel
        Position, heading and velocities of the ship.
    schools, seabed
        Fish, and depths of the bottom (m).
    observables
        Quantities that the estimator compares with readings; None where they are not known.

    Examples
    --------
    >>> import trawl_ros
    >>> truth = next(trawl_ros.simulate('tow.yaml'))
    >>> truth.winches[0].length, truth.doors[0].position.shape
    (300.0, (3,))
    """

    stamp: int
    doors: tuple[DoorTruth, DoorTruth]
    winches: tuple[WinchTruth, WinchTruth]
    net: NetTruth
    vessel: VesselTruth
    schools: tuple[SchoolTruth, ...] = ()
    seabed: SeabedTruth = SeabedTruth()
    observables: Observables | None = None


class Polyline(NamedTuple):
    """Polyline of a rope or a row of netting: points (n, 3) in ``map``, tension (N)."""

    name: str
    points: FloatArray
    tension: float


@dataclass(frozen=True)
class GearPicture:
    """Picture of the gear at ``stamp``, with the schools of fish around it."""

    stamp: int
    lines: tuple[Polyline, ...]
    doors: tuple[DoorTruth, DoorTruth]
    door_size: tuple[float, float]
    schools: tuple[SchoolTruth, ...] = ()
