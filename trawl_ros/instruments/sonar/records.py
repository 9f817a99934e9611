# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the trawl sonar in a file, without its timing."""

from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.instruments.errors.records import (
    AngleErrors,
    LevelErrors,
    NotNegative,
    Share,
    SoundSpeed,
    both_or_neither,
)
from trawl_ros.instruments.sonar.echoes import Beam, Strengths
from trawl_ros.instruments.sonar.image import Grid
from trawl_ros.instruments.sonar.screen import Interference, Receiver, power

Level = Annotated[float, Field(ge=-300, le=300)]
Positive = Annotated[float, Field(gt=0)]
BeamAngle = Annotated[float, Field(gt=0, le=60)]

LEAST_SOUND_SPEED_M_S = 1440.0
"""Least speed of sound in salt water that is not frozen."""


class InterferenceRecord(Record):
    """Interference by another sonar: a pulse of ``pulse_ms`` every ``period_s``.

    ``level_db`` (dB re 1 µPa) is its level at the receiver.
    """

    period_s: Annotated[float, Field(ge=0.01, le=100)]
    pulse_ms: Positive
    level_db: Level


class SweepRecord(Record):
    """Trawl sonar: sector of a sweep, levels and noise of sound, brightness of the screen.

    ``beams`` pings sweep over ``sector_deg``, from starboard to port through straight down. The
    image has ``cells`` columns up to ``max_range_m``, and no echoes nearer than ``min_range_m``.
    Beams are ``beam_width_deg`` wide in the plane of the sweep and ``beam_thickness_deg`` across
    it, both between half-power points.

    ``source_level_db`` is re 1 µPa m, ``noise_level_db`` re 1 µPa in the band of the receiver.
    Travel times are converted with ``assumed_sound_speed_m_s``; the time-varied gain compensates
    ``assumed_absorption_db_km``. The image is black at a target strength of ``black_db`` and white
    at ``white_db``. Ropes and twine scatter the part ``rope_reflectivity`` of the sound;
    ``fish_target_strength_db`` is that of one fish, ``seabed_strength_db`` that of a square metre
    of seabed at normal incidence.

    Errors are the ``gain`` of the whole sweep, the ``angle`` of the beams to port, a share
    ``dead_ping_share`` of pings without echoes, a screen that hangs ``freezes_per_hour`` times for
    ``freeze_s`` on average, and ``interference``.
    """

    beams: Annotated[int, Field(ge=8, le=720)]
    cells: Annotated[int, Field(ge=50, le=2000)]
    sector_deg: Annotated[float, Field(gt=0, le=360)]
    min_range_m: Positive
    max_range_m: Annotated[float, Field(gt=0, le=500)]
    beam_width_deg: BeamAngle
    beam_thickness_deg: BeamAngle
    frequency_khz: Annotated[float, Field(ge=20, le=1000)]
    pulse_ms: Annotated[float, Field(gt=0, le=10)]
    source_level_db: Level
    noise_level_db: Level
    assumed_sound_speed_m_s: SoundSpeed
    assumed_absorption_db_km: NotNegative
    black_db: Level
    white_db: Level
    rope_reflectivity: Share
    fish_target_strength_db: Level
    seabed_strength_db: Level
    gain: LevelErrors = LevelErrors()
    angle: AngleErrors = AngleErrors()
    dead_ping_share: Share = 0.0
    freezes_per_hour: NotNegative = 0.0
    freeze_s: NotNegative = 0.0
    interference: InterferenceRecord | None = None

    @model_validator(mode='after')
    def _in_order(self) -> 'SweepRecord':
        for low, high in (('min_range_m', 'max_range_m'), ('black_db', 'white_db')):
            least, most = getattr(self, low), getattr(self, high)
            if least >= most:
                raise ValueError(
                    f'{high}: found {most:g}, expected more than {low}, which is {least:g}'
                )
        both_or_neither(freezes_per_hour=self.freezes_per_hour, freeze_s=self.freeze_s)
        return self

    @property
    def listening_s(self) -> float:
        """Shortest listening time of a ping, s."""
        return 2 * self.max_range_m / LEAST_SOUND_SPEED_M_S

    def grid(self) -> Grid:
        """Return the grid of the images."""
        sector = np.radians(self.sector_deg)
        # The first and last beam of a full circle must not coincide.
        steps = self.beams if self.sector_deg == 360 else self.beams - 1
        return Grid(
            beams=self.beams,
            cells=self.cells,
            angle_min=-0.5 * sector,
            angle_increment=sector / steps,
            min_range=self.min_range_m,
            max_range=self.max_range_m,
            span=self.white_db - self.black_db,
        )

    def beam(self, sound_speed: float) -> Beam:
        """Return the beam at a speed of sound (m/s)."""
        width, thickness = np.radians([self.beam_width_deg, self.beam_thickness_deg])
        return Beam(float(width), float(thickness), sound_speed / (1e3 * self.frequency_khz))

    def strengths(self) -> Strengths:
        """Return the backscattering strengths."""
        fish, seabed = power(np.array([self.fish_target_strength_db, self.seabed_strength_db]))
        return Strengths(self.rope_reflectivity, float(fish), float(seabed))

    def receiver(self) -> Receiver:
        """Return the receiver."""
        return Receiver(
            self.source_level_db,
            self.noise_level_db,
            self.assumed_absorption_db_km / 1e3,
            self.black_db,
            self.white_db,
        )

    def other_sonar(self) -> Interference | None:
        """Return the interference by another sonar, if there is one."""
        other = self.interference
        if other is None:
            return None
        return Interference(other.period_s, other.pulse_ms / 1e3, other.level_db)
