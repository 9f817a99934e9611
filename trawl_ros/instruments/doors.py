# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Door sensors: pressure (depth), inclinometers, acoustic spread."""

import math

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.rotations import rotation_matrix
from trawl_ros.instruments.distance import RangeSensor
from trawl_ros.instruments.errors.faults import Faulty
from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.parameters import AngleParameters, DoorParameters, SpreadParameters
from trawl_ros.instruments.pressure import PressureInstrument
from trawl_ros.records.samples import AttitudeSample, RangeSample, Sample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import SIDES, DoorTruth, Truth

Doors = tuple[DoorTruth, DoorTruth]

_OUTWARD = (1.0, -1.0)
"""Direction of each door's outer face along y of the door frame, port first."""


def door_tilt(orientation: FloatArray) -> tuple[float, float]:
    """Return pitch (nose down positive) and roll (top to starboard positive) of a pose, rad.

    ``orientation`` is the quaternion (x, y, z, w) of a frame x forward, y port, z up. Angles are
    relative to gravity and do not depend on the heading.
    """
    # An inclinometer measures the vertical in its own axes.
    up = rotation_matrix(orientation)[2]
    return math.atan2(-up[0], math.hypot(up[1], up[2])), math.atan2(up[1], up[2])


def off_axis(doors: Doors) -> float:
    """Return the larger angle (rad) between a door's inward normal and the line to the other."""
    port, starboard = (door.position for door in doors)
    worst = 0.0
    for door, way, outward in zip(
        doors, (starboard - port, port - starboard), _OUTWARD, strict=True
    ):
        sideways = rotation_matrix(door.orientation)[:, 1]
        cosine = -outward * float(sideways @ way) / float(np.linalg.norm(way))
        worst = max(worst, math.acos(min(max(cosine, -1.0), 1.0)))
    return worst


class DoorAttitude(Instrument[FloatArray, AttitudeSample]):
    """Inclinometer of a door; it observes the door's orientation, a quaternion (4,)."""

    def __init__(self, side: str, parameters: AngleParameters, draws: SeedPlan) -> None:
        errors = {'pitch': parameters.model(), 'roll': parameters.model()}
        super().__init__(f'door/{side}/attitude', parameters.timing(), errors, draws)
        self._side = side

    def _read(self, part: FloatArray, stamp: int) -> AttitudeSample:
        pitch, roll = door_tilt(part)
        return AttitudeSample(
            stamp,
            self._side,
            self._measure('pitch', pitch, stamp),
            self._measure('roll', roll, stamp),
            self._stated_std('pitch'),
        )


class DoorSpread(RangeSensor[Doors]):
    """Acoustic spread sensor from door to door; it observes both doors, port first.

    The travel time follows from the speed of sound at the doors and is converted with the assumed
    speed. There is no sample if a door is outside the other's beam.
    """

    def __init__(
        self, parameters: SpreadParameters, surroundings: Surroundings, draws: SeedPlan
    ) -> None:
        super().__init__('door/spread', 'spread', parameters, draws)
        self._half_angle = math.radians(parameters.beam_half_angle_deg)
        self._assumed = parameters.assumed_sound_speed_m_s
        self._surroundings = surroundings

    def _read(self, part: Doors, stamp: int) -> RangeSample | None:
        port, starboard = (door.position for door in part)
        apart = float(np.linalg.norm(port - starboard))
        if self._assumed is not None:
            depth = -0.5 * float(port[2] + starboard[2])
            apart *= self._assumed / self._surroundings.sound_speed(depth)
        # Measured unseen too, so that the beam does not change the errors of later readings.
        reading = self._measured(apart, stamp)
        unseen = self._half_angle < math.pi and off_axis(part) > self._half_angle
        return None if unseen else reading


class DoorInstruments:
    """Instruments of both doors; ``pressure`` and ``attitude`` in the order of `SIDES`."""

    def __init__(
        self, parameters: DoorParameters, draws: SeedPlan, *, surroundings: Surroundings
    ) -> None:
        self.pressure = tuple(
            PressureInstrument(
                f'door/{side}/pressure',
                side,
                parameters.pressure,
                surroundings.pressure_at,
                draws,
            )
            for side in SIDES
        )
        self.attitude = tuple(DoorAttitude(side, parameters.attitude, draws) for side in SIDES)
        self.spread = DoorSpread(parameters.spread, surroundings, draws)
        self.instruments: tuple[Faulty, ...] = (*self.pressure, *self.attitude, self.spread)

    def observe(self, truth: Truth) -> list[Sample]:
        """Return the samples that are due."""
        samples: list[Sample] = []
        for door, pressure, attitude in zip(truth.doors, self.pressure, self.attitude, strict=True):
            samples += pressure.observe(-float(door.position[2]), truth.stamp)
            samples += attitude.observe(door.orientation, truth.stamp)
        samples += self.spread.observe(truth.doors, truth.stamp)
        return samples
