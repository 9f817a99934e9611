# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Echo sounder under the keel: depth of the seabed, and of fish above it."""

import math
from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.instruments.distance import RangeSensor
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import EchoSounderParameters, RangeParameters
from trawl_ros.instruments.sonar.schools import inside
from trawl_ros.records.samples import RangeSample, Sample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import SchoolTruth, Truth

RINGS, RAYS_PER_RING = 4, 12
"""Rings of rays that sample the beam, and rays on each."""


@dataclass(frozen=True)
class Below:
    """Surroundings of the keel: its position ``keel`` (3,) in ``map``, seabed and schools of fish.

    ``seabed`` is the depth below the mean surface, m.
    """

    keel: FloatArray
    seabed: float
    schools: tuple[SchoolTruth, ...]

    @property
    def clearance(self) -> float:
        """Clearance of the keel over the seabed, m."""
        return self.seabed + float(self.keel[2])


def cone(half_angle: float) -> FloatArray:
    """Return unit vectors (n, 3) that fill a downward cone, evenly spaced in angle."""
    tilts = np.repeat(np.arange(1, RINGS + 1) / RINGS * half_angle, RAYS_PER_RING)
    around = np.tile(np.arange(RAYS_PER_RING) / RAYS_PER_RING * 2 * math.pi, RINGS)
    rays = np.column_stack(
        [np.sin(tilts) * np.cos(around), np.sin(tilts) * np.sin(around), -np.cos(tilts)]
    )
    return np.concatenate([[[0.0, 0.0, -1.0]], rays])


class _Sounding(RangeSensor[Below]):
    """Sounding: a distance down from the keel by the travel time of sound.

    The travel time is converted with the assumed speed of sound.
    """

    def __init__(
        self,
        what: str,
        parameters: RangeParameters,
        assumed_sound_speed: float,
        surroundings: Surroundings,
        draws: SeedPlan,
    ) -> None:
        super().__init__(f'vessel/echo_sounder/{what}', what, parameters, draws)
        self._assumed = assumed_sound_speed
        self._surroundings = surroundings

    @abstractmethod
    def _distance(self, part: Below) -> float:
        """Return the true distance, m; infinite if there is nothing."""

    def _read(self, part: Below, stamp: int) -> RangeSample:
        distance = self._distance(part)
        if math.isfinite(distance):
            keel = -float(part.keel[2])
            mean = self._surroundings.mean_sound_speed(keel, keel + distance)
            distance *= self._assumed / mean
        return self._measured(distance, stamp)


class DepthSounding(_Sounding):
    """Sounding of the seabed, straight down from the keel."""

    def _distance(self, part: Below) -> float:
        return part.clearance


class SchoolSounding(_Sounding):
    """Sounding of the nearest fish in the beam, above the seabed.

    ``half_angle`` is half of the beam's width, rad.
    """

    def __init__(
        self,
        what: str,
        parameters: RangeParameters,
        assumed_sound_speed: float,
        surroundings: Surroundings,
        draws: SeedPlan,
        *,
        half_angle: float,
    ) -> None:
        super().__init__(what, parameters, assumed_sound_speed, surroundings, draws)
        self._rays = cone(half_angle)

    def _distance(self, part: Below) -> float:
        nearest = math.inf
        for school in part.schools:
            near, far = inside(school, part.keel, self._rays)
            ahead = np.isfinite(far) & (far > 0.0)
            if ahead.any():
                nearest = min(nearest, max(0.0, float(near[ahead].min())))
        return nearest if nearest < part.clearance else math.inf


class EchoSounder:
    """Echo sounder with both soundings; ``draught`` is that of the keel, m."""

    def __init__(
        self,
        parameters: EchoSounderParameters,
        draught: float,
        surroundings: Surroundings,
        draws: SeedPlan,
    ) -> None:
        assumed = parameters.assumed_sound_speed_m_s
        self.depth = DepthSounding('depth', parameters.depth, assumed, surroundings, draws)
        self.school = SchoolSounding(
            'school',
            parameters.school,
            assumed,
            surroundings,
            draws,
            half_angle=math.radians(0.5 * parameters.beam_width_deg),
        )
        self.instruments = (self.depth, self.school)
        self._keel = np.array([0.0, 0.0, -draught])

    def observe(self, truth: Truth) -> list[Sample]:
        """Return the samples that are due."""
        keel = truth.vessel.position + self._keel
        below = Below(keel, truth.seabed.under_ship, truth.schools)
        return [*self.depth.observe(below, truth.stamp), *self.school.observe(below, truth.stamp)]
