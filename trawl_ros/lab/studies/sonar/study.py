"""Study of the trawl sonar: accuracy of the openings read off its image."""

import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.gear.load import load_gear
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import SonarParameters, load_instruments
from trawl_ros.instruments.trawl_sonar import SonarInstruments
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.samples import RangeSample, Sample, SonarImageSample, SonarScanSample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import NetTruth, SchoolTruth, SeabedTruth, Truth
from trawl_ros.scenario.sea import build_surroundings
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation

TRUTH_HZ = 4.0
HAUL_S = 260.0
APART = 10_000 * SECOND
"""Between the stamps of one haul and the next, ns."""

ENDLESS = 40_000.0
"""Length (m) of a school that the net does not leave."""


@dataclass(frozen=True)
class Fish:
    """School that passes the sonar's plane: an ellipse ``down`` (m) below the headrope's
    centre and ``port`` of it, ``width`` by ``height``, of ``density`` fish per m³.
    """

    down: float
    port: float
    width: float
    height: float
    density: float


@dataclass(frozen=True)
class SonarCase:
    """Case: one state of the tow.

    ``warp`` (m) and ``speed`` (m/s), and those it is hauled to, if it is; fish; how far below the
    headrope the seabed is (m); whether the sonar is told the speed of sound there is.
    """

    name: str
    warp: float
    speed: float
    hauled_to: tuple[float, float] | None = None
    fish: Fish | None = None
    seabed: float = math.inf
    told_sound_speed: bool = False


STATES = (
    SonarCase('200 m, 1.9 m/s', 200.0, 1.9),
    SonarCase('200 m, 2.6 m/s', 200.0, 2.6),
    SonarCase('300 m, 2.1 m/s', 300.0, 2.1),
    SonarCase('500 m, 2.1 m/s', 500.0, 2.1),
    SonarCase('900 m, 1.8 m/s', 900.0, 1.8),
    SonarCase('900 m, 2.3 m/s', 900.0, 2.3),
    SonarCase('hauled from 400 to 300 m', 400.0, 2.3, hauled_to=(300.0, 2.1)),
)
"""Cases of nothing but the gear."""

COMPANY = (
    SonarCase('500 m, a few fish between the ropes', 500.0, 2.1, fish=Fish(45, 0, 30, 30, 0.3)),
    SonarCase('500 m, dense fish between the ropes', 500.0, 2.1, fish=Fish(50, 3, 30, 25, 3.0)),
    SonarCase('500 m, fish from there to below the net', 500.0, 2.1, fish=Fish(88, 0, 60, 50, 0.1)),
    SonarCase('500 m, fish all around the net', 500.0, 2.1, fish=Fish(55, 0, 200, 140, 0.1)),
    SonarCase('500 m, seabed 15 m below the footrope', 500.0, 2.1, seabed=109.0),
)
"""Cases with fish or the seabed in view."""

TOLD = SonarCase('500 m, speed of sound set right', 500.0, 2.1, told_sound_speed=True)

CASES = (*STATES, TOLD, *COMPANY)

SHOWN = STATES[3], COMPANY[1], COMPANY[4]
"""Cases that the picture of the report shows: the net, dense fish, the seabed."""


@dataclass(frozen=True)
class SonarMeasurement:
    """Result of a case.

    ``height`` and ``width`` (n,) are readings in m, NaN where none was possible, and
    ``true_height``, ``true_width`` (n,) the truth in the middle of each sweep. The last image
    with its scan and truth is kept for a picture.
    """

    case: SonarCase
    height: FloatArray
    width: FloatArray
    true_height: FloatArray
    true_width: FloatArray
    image: SonarImageSample
    scan: SonarScanSample
    net: NetTruth


@dataclass(frozen=True)
class Figures:
    """Figures of errors (m): mean, standard deviation, largest; ``read`` and ``unread`` count."""

    bias: float
    scatter: float
    worst: float
    read: int
    unread: int


def figures(readings: FloatArray, truth: FloatArray) -> Figures:
    """Return the figures of readings (n,) against truth (n,), m."""
    errors = (readings - truth)[np.isfinite(readings)]
    unread = len(readings) - len(errors)
    if len(errors) == 0:
        return Figures(math.nan, math.nan, math.nan, 0, unread)
    worst = float(np.abs(errors).max())
    return Figures(float(errors.mean()), float(errors.std()), worst, len(errors), unread)


class SonarStudy:
    """Study of the cases with one gear and one set of instruments.

    Parameters
    ----------
    sweeps
        Number per case.
    gear, instruments
        Files or names.
    seed
        Of all noise.
    """

    def __init__(
        self,
        sweeps: int,
        *,
        gear: str = 'kaifuha',
        instruments: str = 'default',
        seed: int = 0,
        model: GearModel | None = None,
    ) -> None:
        self._sweeps = sweeps
        self._model = build_model(load_gear(gear)) if model is None else model
        self._surroundings: Surroundings = build_surroundings(load_gear(gear))
        self._parameters: SonarParameters = load_instruments(instruments).sonar
        self._seed = seed
        self._steady: dict[tuple[float, float], Truth] = {}

    def measure(self, case: SonarCase) -> SonarMeasurement:
        """Tow a case, and compare readings with truth."""
        heights: dict[int, float] = {}
        widths: dict[int, float] = {}
        nets: dict[int, NetTruth] = {}
        images: list[Sample] = []
        runs = self._hauls(case) if case.hauled_to else [self._tow(case)]
        # Other noise in each case, so that equal figures are no accident of equal draws.
        seed = self._seed + zlib.crc32(case.name.encode())
        shift = 0
        for number, run in enumerate(runs):
            sonar = self._sonar(case, seed + number)
            for truth in run:
                nets[shift + truth.stamp] = truth.net
                for sample in sonar.observe(truth):
                    if isinstance(sample, RangeSample) and sample.what == 'opening_height':
                        heights[shift + sample.stamp] = sample.distance
                    elif isinstance(sample, RangeSample) and sample.what == 'opening_width':
                        widths[shift + sample.stamp] = sample.distance
                    elif isinstance(sample, SonarImageSample | SonarScanSample):
                        images = [*images[-1:], sample]
            shift += APART
        half = round(0.5 * SECOND / self._parameters.sweep.rate_hz)
        stamps = sorted(heights)[: self._sweeps]
        seen = [nets[stamp + half] for stamp in stamps]
        image, scan = images
        assert isinstance(image, SonarImageSample)
        assert isinstance(scan, SonarScanSample)
        return SonarMeasurement(
            case,
            np.array([heights[stamp] for stamp in stamps]),
            np.array([widths[stamp] for stamp in stamps]),
            np.array([net.section_height for net in seen]),
            np.array([net.section_width for net in seen]),
            image,
            scan,
            seen[-1],
        )

    def _sonar(self, case: SonarCase, seed: int) -> SonarInstruments:
        parameters = self._parameters
        if case.told_sound_speed:
            depth = self._at_rest(case).net.headrope_depth
            corrections = {'assumed_sound_speed_m_s': self._surroundings.sound_speed(depth)}
            sweep = parameters.sweep.model_copy(update=corrections)
            parameters = parameters.model_copy(update={'sweep': sweep})
        return SonarInstruments(parameters, SeedPlan(seed), surroundings=self._surroundings)

    def _at_rest(self, case: SonarCase) -> Truth:
        key = case.warp, case.speed
        if key not in self._steady:
            command = Command(case.warp, case.warp, case.speed)
            self._steady[key] = Simulation(self._model, command).truth()
        return self._steady[key]

    def _tow(self, case: SonarCase) -> Iterator[Truth]:
        """Steady tow: the net keeps its shape and goes ahead."""
        start = self._at_rest(case)
        count = 1 + math.ceil(self._sweeps / self._parameters.sweep.rate_hz * TRUTH_HZ)
        for k in range(count):
            way = np.array([case.speed * k / TRUTH_HZ, 0.0, 0.0])
            net = replace(start.net, sonar_position=start.net.sonar_position + way)
            stamp = round(k / TRUTH_HZ * SECOND)
            yield self._with_sea(case, replace(start, stamp=stamp, net=net))

    def _hauls(self, case: SonarCase) -> Iterator[Iterator[Truth]]:
        """Repeat the same haul, for other noise each time."""
        assert case.hauled_to is not None
        warp, speed = case.hauled_to
        simulation = Simulation(
            self._model, Command(case.warp, case.warp, case.speed), period=1.0 / TRUTH_HZ
        )
        simulation.command = Command(warp, warp, speed)
        truths = [simulation.truth()]
        rate = self._parameters.sweep.rate_hz
        per_haul = min(math.floor(HAUL_S * rate), self._sweeps)
        for _ in range(math.ceil(per_haul / rate * TRUTH_HZ)):
            simulation.advance()
            truths.append(simulation.truth())
        for _ in range(math.ceil(self._sweeps / per_haul)):
            yield iter(truths)

    def _with_sea(self, case: SonarCase, truth: Truth) -> Truth:
        depth = truth.net.headrope_depth
        seabed = SeabedTruth(math.inf, depth + case.seabed)
        if case.fish is None:
            return replace(truth, seabed=seabed)
        fish, (x, y, z) = case.fish, truth.net.sonar_position
        school = SchoolTruth(
            np.array([x, y + fish.port, z - fish.down]),
            np.array([ENDLESS, fish.width, fish.height]),
            fish.density,
        )
        return replace(truth, seabed=seabed, schools=(school,))
