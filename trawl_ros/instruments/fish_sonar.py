# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fish sonar of the ship: sweeps of a sector ahead and the schools in it."""

import math

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.instruments.errors.instrument import Instrument, SeedPlan
from trawl_ros.instruments.errors.random_processes import generator
from trawl_ros.instruments.parameters import FishSonarParameters
from trawl_ros.instruments.sonar.absorption import absorption
from trawl_ros.instruments.sonar.schools import fish_in
from trawl_ros.records.samples import SchoolsSample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import SchoolTruth, VesselTruth

Around = tuple[VesselTruth, tuple[SchoolTruth, ...]]
"""Ship, and the schools around her."""


class FishSonar(Instrument[Around, SchoolsSample]):
    """Fish sonar; it observes ship and schools, `Around`, and reports a sample per sweep.

    A school can be detected if its centre is within range and sector and a part of it is in the
    tilted beam. Detection is random for each school and sweep. Its probability depends on the echo
    level L (`echo_level`): 1 / (1 + exp((L₅₀ − L) / fading)), one half at the level L₅₀. Schools
    are reported without identity, in the order of their ranges.

    Parameters
    ----------
    parameters
        Parameters from the instrument file.
    draught
        Depth of the sonar below the towing blocks, m.
    surroundings
        Water, with its absorption and speed of sound.
    draws
        Seed and changes of state.
    """

    def __init__(
        self,
        parameters: FishSonarParameters,
        draught: float,
        surroundings: Surroundings,
        draws: SeedPlan,
    ) -> None:
        errors = {
            'range': parameters.range.model(),
            'bearing': parameters.bearing.model(),
            'tilt': parameters.tilt.model(),
        }
        self._seed = draws.seed
        self._parameters = parameters
        self._surroundings = surroundings
        self._draught = draught
        super().__init__('vessel/fish_sonar', parameters.timing(), errors, draws)

    def echo_level(self, school: SchoolTruth, distance: float, depth: float) -> float:
        """Return the echo level of a school for a source of 0 dB, dB.

        TS + 10 log N − 40 log r − 2 α r: all N fish have the target strength TS. Sound spreads
        spherically and is absorbed on both ways.
        """
        record, water = self._parameters, self._surroundings
        loss = absorption(
            1e3 * record.frequency_khz, water.temperature(depth), water.salinity, depth
        )
        strength = record.fish_target_strength_db + 10 * math.log10(fish_in(school))
        return strength - 40 * math.log10(max(distance, 1.0)) - 2 * loss * distance

    def _restart(self) -> None:
        self._luck = generator(self._seed, f'{self.name}/detection')

    def _read(self, part: Around, stamp: int) -> SchoolsSample:
        vessel, schools = part
        rows = [self._seen(vessel, school, stamp) for school in schools]
        seen = np.array([row for row in rows if row is not None]).reshape(-1, 3)
        # A lost quantity leaves no position.
        seen = seen[np.isfinite(seen).all(1)]
        return SchoolsSample(stamp, seen[np.argsort(np.linalg.norm(seen, axis=1))])

    def _seen(self, vessel: VesselTruth, school: SchoolTruth, stamp: int) -> FloatArray | None:
        """Return the measured position of a school in frame ``vessel``; None if not detected."""
        record = self._parameters
        sonar = np.array([0.0, 0.0, -self._draught])
        east, north, up = school.position - vessel.position
        cosine, sine = math.cos(vessel.heading), math.sin(vessel.heading)
        x, y = cosine * east + sine * north, cosine * north - sine * east
        z = float(up) + self._draught
        level, distance = math.hypot(x, y), math.hypot(x, y, z)
        bearing, tilt = math.atan2(y, x), math.atan2(-z, level)
        depth = self._draught - float(vessel.position[2])
        stretch = record.assumed_sound_speed_m_s / self._surroundings.mean_sound_speed(
            depth, depth - z
        )
        # Drawn for undetected schools too, so that one school does not change another's errors.
        shown_range = self._measure('range', stretch * distance, stamp)
        shown_bearing = self._measure('bearing', bearing, stamp)
        shown_tilt = self._measure('tilt', tilt, stamp)
        lucky = self._luck.random()
        half_size = math.atan2(0.5 * float(school.size[2]), level)
        half_beam = math.radians(0.5 * record.beam_width_deg)
        if (
            not record.min_range_m <= distance <= record.max_range_m
            or abs(bearing) > math.radians(0.5 * record.sector_deg)
            or abs(tilt - math.radians(record.beam_tilt_deg)) > half_beam + half_size
        ):
            return None
        excess = self.echo_level(school, distance, depth) - record.half_seen_db
        # Logistic function, in a form that does not overflow.
        if lucky > 0.5 * (1.0 + math.tanh(0.5 * excess / record.fading_db)):
            return None
        ahead = shown_range * math.cos(shown_tilt)
        place: FloatArray = sonar + np.array(
            [
                ahead * math.cos(shown_bearing),
                ahead * math.sin(shown_bearing),
                -shown_range * math.sin(shown_tilt),
            ]
        )
        return place
