# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trawl sonar on the headrope: its image, readings from the image, and sensors in its housing."""

import math

from trawl_ros.core.arrays import ByteArray
from trawl_ros.core.rotations import rotation_matrix
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.distance import RangeInstrument, RangeSensor
from trawl_ros.instruments.errors.instrument import STAMP_TOLERANCE_NS, Instrument, SeedPlan
from trawl_ros.instruments.errors.random_processes import BurstModel, Bursts, generator
from trawl_ros.instruments.parameters import (
    BottomParameters,
    OpeningParameters,
    SonarParameters,
    SweepParameters,
)
from trawl_ros.instruments.pressure import PressureInstrument
from trawl_ros.instruments.sonar.detection import first_echoes
from trawl_ros.instruments.sonar.echoes import Ping
from trawl_ros.instruments.sonar.reading import read_openings
from trawl_ros.instruments.sonar.sweep import Sweep, SweepGenerators, image_of
from trawl_ros.records.samples import (
    RangeSample,
    Sample,
    SonarImageSample,
    SonarPointsSample,
    SonarScanSample,
)
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import Truth


class TrawlSonar(Instrument[Truth, Sweep]):
    """Scanning sonar; it observes net, schools and seabed and reports complete sweeps.

    The beams ping one after the other during the sweep. Each receives the echoes of what is in the
    sonar's plane at its own time. A sweep ends when the next one begins; rows without a ping stay
    black.

    Its quantities are ``gain``, the excess gain in dB, and ``angle``, the error of the beams'
    direction to port. If either is frozen the screen hangs and shows the last image.

    Parameters
    ----------
    parameters
        Parameters from the instrument file.
    surroundings
        Water, with its speed of sound and absorption.
    draws
        Seed and changes of state.
    """

    def __init__(
        self, parameters: SweepParameters, surroundings: Surroundings, draws: SeedPlan
    ) -> None:
        errors = {'gain': parameters.gain.model(), 'angle': parameters.angle.model()}
        super().__init__('sonar/image', parameters.timing(), errors, draws)
        self._parameters = parameters
        self._surroundings = surroundings
        self._seed = draws.seed
        self._grid = parameters.grid()
        self.sweep_s = 1.0 / parameters.rate_hz
        self._restart()

    def observe(self, part: Truth, stamp: int) -> list[Sweep]:
        """Observe the truth; pings since the last call receive echoes from the present truth."""
        self._ping(part, stamp)
        sweeps = super().observe(part, stamp)
        self._ping(part, stamp)
        return sweeps

    def _restart(self) -> None:
        luck = (
            generator(self._seed, f'{self.name}/{kind}') for kind in ('fish', 'speckle', 'dead')
        )
        self._luck = SweepGenerators(*luck)
        record = self._parameters
        freezes = BurstModel(record.freezes_per_hour, record.freeze_s)
        self._hangs = Bursts(freezes, generator(self._seed, f'{self.name}/freezes'))
        self._pings: list[Ping] = []
        self._begin: int | None = None
        self._gain = self._off = 0.0
        self._shown: ByteArray | None = None

    def _read(self, part: Truth, stamp: int) -> Sweep | None:
        sweep = self._complete()
        self._begin, self._pings = stamp, []
        self._gain = self._measure('gain', 0.0, stamp)
        self._off = self._measure('angle', 0.0, stamp)
        return sweep

    def _ping(self, part: Truth, stamp: int) -> None:
        if self._begin is None:
            return
        interval = self.sweep_s / self._grid.beams
        due = 1 + math.floor((stamp + STAMP_TOLERANCE_NS - self._begin) / SECOND / interval)
        for row in range(len(self._pings), min(due, self._grid.beams)):
            angle = float(self._grid.angles[row]) + self._off
            self._pings.append(_ping(part, angle if math.isfinite(angle) else 0.0))

    def _complete(self) -> Sweep | None:
        """Return the sweep of the pings made so far."""
        if self._begin is None or not self._pings:
            return None
        image = image_of(
            self._pings,
            self._begin,
            self._parameters,
            self.sweep_s / self._grid.beams,
            # Without a known angle the echoes cannot be placed in the image.
            self._gain if math.isfinite(self._off) else math.nan,
            self._surroundings,
            self._luck,
        )
        # The random process comes first: it must advance whether or not there are faults.
        hangs = self._hangs.on(self._begin) or self._is_frozen()
        if hangs and self._shown is not None:
            image = self._shown
        self._shown = image
        return Sweep(self._begin, image, self._grid, tuple(self._pings))

    def _is_frozen(self) -> bool:
        channels = self._channels.values()
        return any(fault.kind == 'frozen' for channel in channels for fault in channel.faults)


def _ping(truth: Truth, angle: float) -> Ping:
    net = truth.net
    altitude = truth.seabed.under_headrope - net.headrope_depth
    return Ping(
        angle=angle,
        position=net.sonar_position,
        axes=rotation_matrix(net.sonar_orientation),
        section=net.section,
        schools=truth.schools,
        altitude=altitude if altitude > 0 else math.inf,
    )


class SonarOpening(RangeSensor[tuple[int, float] | None]):
    """Opening of the net as read from an image.

    It observes the stamp (ns) of the image and the opening (m), NaN if it cannot be read, or None
    if there is no new image. ``what`` is 'opening_height' or 'opening_width'.
    """

    def __init__(self, what: str, parameters: OpeningParameters, draws: SeedPlan) -> None:
        super().__init__(f'sonar/{what}', what, parameters, draws)

    def _read(self, part: tuple[int, float] | None, stamp: int) -> RangeSample | None:
        if part is None:
            return None
        seen, opening = part
        return self._measured(opening, seen)


class SonarBottom(RangeInstrument):
    """Sounder that points down from the headrope and observes its altitude (m)."""

    def __init__(
        self, parameters: BottomParameters, surroundings: Surroundings, draws: SeedPlan
    ) -> None:
        super().__init__('sonar/bottom', 'bottom', parameters, draws)
        self._assumed = parameters.assumed_sound_speed_m_s
        self._surroundings = surroundings

    def look(self, truth: Truth) -> list[RangeSample]:
        """Observe the truth with the speed of sound of the water."""
        depth, seabed = truth.net.headrope_depth, truth.seabed.under_headrope
        below = seabed - depth
        if math.isfinite(below):
            below *= self._assumed / self._surroundings.mean_sound_speed(depth, seabed)
        return self.observe(below, truth.stamp)


class SonarInstruments:
    """Instruments of the trawl sonar."""

    def __init__(
        self, parameters: SonarParameters, draws: SeedPlan, *, surroundings: Surroundings
    ) -> None:
        self.pressure = PressureInstrument(
            'sonar/pressure', 'sonar', parameters.pressure, surroundings.pressure_at, draws
        )
        self.sonar = TrawlSonar(parameters.sweep, surroundings, draws)
        self.height = SonarOpening('opening_height', parameters.opening_height, draws)
        self.width = SonarOpening('opening_width', parameters.opening_width, draws)
        self.bottom = SonarBottom(parameters.bottom, surroundings, draws)
        self.instruments = (self.pressure, self.sonar, self.height, self.width, self.bottom)

    def observe(self, truth: Truth) -> list[Sample]:
        """Return the samples that are due."""
        stamp = truth.stamp
        samples: list[Sample] = []
        samples += self.pressure.observe(truth.net.headrope_depth, stamp)
        samples += self.bottom.look(truth)
        height = width = None
        for sweep in self.sonar.observe(truth, stamp):
            samples += self._pictures(sweep)
            openings = read_openings(sweep.image, sweep.grid)
            height, width = (sweep.stamp, openings.height), (sweep.stamp, openings.width)
        samples += self.height.observe(height, stamp)
        samples += self.width.observe(width, stamp)
        return samples

    def _pictures(self, sweep: Sweep) -> list[Sample]:
        grid = sweep.grid
        ranges, intensities = first_echoes(sweep.image, grid)
        return [
            SonarImageSample(sweep.stamp, sweep.image),
            SonarScanSample(
                sweep.stamp,
                ranges,
                intensities,
                grid.angle_min,
                grid.angle_increment,
                grid.min_range,
                grid.max_range,
                self.sonar.sweep_s,
            ),
            SonarPointsSample(sweep.stamp, sweep.points()),
        ]
