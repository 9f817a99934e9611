# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sea around ship and gear: heave, seabed and schools of fish."""

from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.records.truth import SchoolTruth, SeabedTruth, single
from trawl_ros.simulation.heave import Heave
from trawl_ros.simulation.seabed import Seabed


@dataclass(frozen=True)
class School:
    """School of fish in uniform motion.

    ``position`` (3,) is that of its centre at the start of the trial (m, ``map``), ``velocity``
    (3,) is over ground (m/s); ``size`` and ``density`` are those of `SchoolTruth`.
    """

    position: FloatArray
    size: FloatArray
    density: float
    velocity: FloatArray

    def at(self, time: float) -> SchoolTruth:
        """Return the truth of the school at a time (s since the start of the trial)."""
        position = self.position + self.velocity * time
        return SchoolTruth(single(position), single(self.size), float(np.float32(self.density)))


@dataclass(frozen=True)
class Sea:
    """Heave, seabed and schools; by default calm, bottomless and empty.

    Density and current are those of the gear's `trawl_ros.model.water.Water`.
    """

    heave: Heave = field(default_factory=Heave)
    seabed: Seabed = field(default_factory=Seabed)
    schools: tuple[School, ...] = ()

    def schools_at(self, time: float) -> tuple[SchoolTruth, ...]:
        """Return all schools at a time (s since the start of the trial)."""
        return tuple(school.at(time) for school in self.schools)

    def seabed_under(self, ship: FloatArray, headrope: FloatArray) -> SeabedTruth:
        """Return the depths of the seabed under two positions (3,) in ``map``."""
        under_ship, under_headrope = self.seabed.depth_at(np.stack([ship, headrope]))
        return SeabedTruth(float(under_ship), float(under_headrope))
