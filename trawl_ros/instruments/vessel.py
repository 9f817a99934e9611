# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sensors of the ship: speed log, GPS, compass; with echo sounder and fish sonar."""

import math

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.geodesy import Datum, to_latitude_longitude
from trawl_ros.instruments.echo_sounder import EchoSounder
from trawl_ros.instruments.errors.faults import Faulty
from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.fish_sonar import FishSonar
from trawl_ros.instruments.parameters import (
    AngleParameters,
    LengthParameters,
    VelocityParameters,
    VesselParameters,
)
from trawl_ros.records.samples import FixSample, HeadingSample, Sample, VelocitySample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import Truth

Moving = tuple[FloatArray, float]
"""Velocity (3,) in m/s and rate of turn in rad/s."""


class _Velocity(Instrument[Moving, VelocitySample]):
    """Velocity sensor of two horizontal components; the vertical one is reported as 0."""

    def __init__(self, over: str, parameters: VelocityParameters, draws: SeedPlan) -> None:
        speed = parameters.velocity.model()
        errors = {'x': speed, 'y': speed, 'yaw_rate': parameters.yaw_rate.model()}
        super().__init__(f'vessel/velocity_{over}', parameters.timing(), errors, draws)
        self._over = over

    def _read(self, part: Moving, stamp: int) -> VelocitySample:
        velocity, yaw_rate = part
        measured = np.array(
            [
                self._measure('x', float(velocity[0]), stamp),
                self._measure('y', float(velocity[1]), stamp),
                0.0,
            ]
        )
        turn = self._measure('yaw_rate', yaw_rate, stamp)
        stated = self._stated_std('x'), self._stated_std('yaw_rate')
        return VelocitySample(stamp, self._over, measured, turn, stated)


class SpeedLog(_Velocity):
    """Two-axis speed log with a rate-of-turn indicator; it observes velocity through the water."""

    def __init__(self, parameters: VelocityParameters, draws: SeedPlan) -> None:
        super().__init__('water', parameters, draws)


class GpsVelocity(_Velocity):
    """GPS velocity over ground with the rate of turn; it observes `Moving` in ``map``."""

    def __init__(self, parameters: VelocityParameters, draws: SeedPlan) -> None:
        super().__init__('ground', parameters, draws)


class GpsFix(Instrument[FloatArray, FixSample]):
    """GPS position on Earth; it observes the ship's position (3,) in ``map``."""

    def __init__(self, parameters: LengthParameters, datum: Datum, draws: SeedPlan) -> None:
        errors = {'east': parameters.model(), 'north': parameters.model()}
        super().__init__('vessel/fix', parameters.timing(), errors, draws)
        self._datum = datum

    def _read(self, part: FloatArray, stamp: int) -> FixSample:
        measured = np.array(
            [
                self._measure('east', float(part[0]), stamp),
                self._measure('north', float(part[1]), stamp),
                float(part[2]),
            ]
        )
        latitude, longitude = to_latitude_longitude(measured, self._datum)
        return FixSample(stamp, latitude, longitude, self._stated_std('east'))


class Heading(Instrument[float, HeadingSample]):
    """Compass; it observes the heading as ENU yaw (rad) and reports it within ±π."""

    def __init__(self, parameters: AngleParameters, draws: SeedPlan) -> None:
        super().__init__(
            'vessel/heading', parameters.timing(), {'heading': parameters.model()}, draws
        )

    def _read(self, part: float, stamp: int) -> HeadingSample:
        measured = self._measure('heading', part, stamp)
        return HeadingSample(
            stamp, math.remainder(measured, 2 * math.pi), self._stated_std('heading')
        )


class VesselInstruments:
    """Instruments of the ship except those of the winches."""

    def __init__(
        self, parameters: VesselParameters, draws: SeedPlan, *, surroundings: Surroundings
    ) -> None:
        datum = Datum(parameters.datum_lat_deg, parameters.datum_lon_deg)
        self.velocity_water = SpeedLog(parameters.velocity_water, draws)
        self.velocity_ground = GpsVelocity(parameters.velocity_ground, draws)
        self.fix = GpsFix(parameters.fix, datum, draws)
        self.heading = Heading(parameters.heading, draws)
        draught = parameters.draught_m
        self.echo_sounder = EchoSounder(parameters.echo_sounder, draught, surroundings, draws)
        self.fish_sonar = FishSonar(parameters.fish_sonar, draught, surroundings, draws)
        self.instruments: tuple[Faulty, ...] = (
            self.velocity_water,
            self.velocity_ground,
            self.fix,
            self.heading,
            *self.echo_sounder.instruments,
            self.fish_sonar,
        )

    def observe(self, truth: Truth) -> list[Sample]:
        """Return the samples that are due."""
        vessel, stamp = truth.vessel, truth.stamp
        samples: list[Sample] = []
        samples += self.velocity_water.observe((vessel.velocity_water, vessel.yaw_rate), stamp)
        samples += self.velocity_ground.observe((vessel.velocity_ground, vessel.yaw_rate), stamp)
        samples += self.fix.observe(vessel.position, stamp)
        samples += self.heading.observe(vessel.heading, stamp)
        samples += self.echo_sounder.observe(truth)
        samples += self.fish_sonar.observe((vessel, truth.schools), stamp)
        return samples
