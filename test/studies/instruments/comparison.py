"""Statistics of simulated sensors compared with those of measured ones."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studies.instruments.guards import GateCounts, HaulDisagreement, gate
from studies.instruments.statistics import (
    HEIGHT_LIMITS,
    SPREAD_LIMITS,
    STATISTICS,
    Limits,
    course_of,
    noise_at,
    statistics,
)
from studies.instruments.survey import (
    HEIGHT,
    KEPT,
    SPREAD,
    Series,
    SurveyHaul,
    read_survey,
)
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.progress import OnProgress, ignore, step_counter
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.distance import RangeInstrument
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import InstrumentParameters, RangeParameters

TRUTH_S = 0.2
SHOWN_DECIMALS = 1
"""Decimals (of m) that the survey's recorder shows."""


def simulated(haul: SurveyHaul, parameters: RangeParameters, seed: int) -> Series:
    """Run a sensor through the course of a haul.

    The recorder is that of the survey: whole seconds, tenths of a metre, and of two readings
    within one second the first is kept.

    Parameters
    ----------
    haul
        Its course and its length are taken.
    parameters
        Of the sensor.
    seed
        Shared by all hauls; each draws from its own numbers.
    """
    time, value = course_of(haul.series.kept())
    sensor = RangeInstrument(f'haul {haul.number}', 'distance', parameters, SeedPlan(seed))
    since = np.arange(0.0, time[-1] - time[0], TRUTH_S)
    truth = np.interp(since, time - time[0], value)
    samples = [
        sample
        for at, distance in zip(since, truth, strict=True)
        for sample in sensor.observe(float(distance), round(float(at) * SECOND))
    ]
    seconds = np.array([sample.stamp // SECOND for sample in samples])
    readings = np.array([sample.distance for sample in samples])
    heard = np.isfinite(readings)
    seconds, first = np.unique(seconds[heard], return_index=True)
    codes = np.full(len(seconds), KEPT, dtype=np.int64)
    shown = np.round(readings[heard][first], SHOWN_DECIMALS)
    return Series(time[0] + seconds.astype(float), shown, codes)


@dataclass(frozen=True)
class Sensor:
    """Measured sensor: its name and flag in the survey, limits of its residuals, and the channel
    of the estimation whose gates it goes through.
    """

    name: str
    flag: int
    limits: Limits
    channel: str

    def parameters(self, ship: InstrumentParameters) -> RangeParameters:
        """Return the parameters of the simulated sensor beside it."""
        return ship.door.spread if self.flag == SPREAD else ship.sonar.bottom


SENSORS = (
    Sensor('spread', SPREAD, SPREAD_LIMITS, 'door_spread'),
    Sensor('height', HEIGHT, HEIGHT_LIMITS, 'vertical_opening'),
)


def percentiles(values: FloatArray) -> tuple[float, float, float]:
    """Return the 5th, 50th and 95th percentile of the values (n,) that there are."""
    there = values[np.isfinite(values)]
    low, middle, high = np.percentile(there, [5.0, 50.0, 95.0]) if len(there) else [np.nan] * 3
    return float(low), float(middle), float(high)


@dataclass(frozen=True)
class Comparison:
    """Comparison of a sensor over some hauls.

    Attributes
    ----------
    measured, simulated
        Statistics (n_hauls,) by their keys of `STATISTICS`.
    """

    measured: Mapping[str, FloatArray]
    simulated: Mapping[str, FloatArray]

    def band(self, key: str) -> tuple[float, float]:
        """Return the middle 90 % of the measured hauls."""
        low, _, high = percentiles(self.measured[key])
        return low, high

    def median(self, key: str) -> float:
        """Return the median of the simulated hauls."""
        return percentiles(self.simulated[key])[1]

    def inside(self, key: str) -> float:
        """Return the share of the simulated hauls that lie in the band."""
        low, high = self.band(key)
        values = self.simulated[key]
        values = values[np.isfinite(values)]
        return float(np.mean((values >= low) & (values <= high))) if len(values) else np.nan


@dataclass(frozen=True)
class SensorFindings:
    """Findings on one sensor: comparisons over the hauls of odd numbers, which judge, and of even
    ones, which values were chosen by; gates over all hauls, and reasons of windows without a
    mean; disagreements of gates and editors, haul by haul; noise of measured and simulated
    readings per class of distance; a measured haul and the simulated one beside it.
    """

    sensor: Sensor
    judged: Comparison
    fitted: Comparison
    gates: GateCounts
    reasons: Mapping[str, int]
    disagreements: Sequence[HaulDisagreement]
    noise: tuple[Sequence[tuple[float, int]], Sequence[tuple[float, int]]]
    pair: tuple[Series, Series]


def compare_sensors(
    file: Path, ship: InstrumentParameters, seed: int, on_progress: OnProgress = ignore
) -> list[SensorFindings]:
    """Compare both sensors with those of a survey, as `read_survey` takes its file.

    Parameters of the simulated sensors are those of ``ship``; ``seed`` is that of their readings.

    Raises
    ------
    TrawlError
        If the file cannot be read.
    """
    survey = read_survey(file)
    done = step_counter('hauls', sum(len(hauls) for hauls in survey.values()), on_progress)
    found = []
    for sensor in SENSORS:
        hauls = survey[sensor.flag]
        parameters = sensor.parameters(ship)
        stated = parameters.model().stated_std
        readings: dict[int, tuple[Series, Series]] = {}
        gates, reasons = GateCounts(), Counter[str]()
        disagreements = []
        for haul in hauls:
            readings[haul.number] = haul.series.kept(), simulated(haul, parameters, seed)
            gated = gate(haul.series, sensor.channel, stated)
            gates += gated.counts
            reasons.update(gated.reasons)
            disagreements.append(
                HaulDisagreement(haul.number, len(haul.series.time), gated.differing)
            )
            done()
        odd = [readings[haul.number] for haul in hauls if haul.number % 2]
        even = [readings[haul.number] for haul in hauls if not haul.number % 2]
        measured, made = (noise_at(side) for side in zip(*readings.values(), strict=True))
        pair = readings[_typical(hauls)]
        judged, fitted = _compared(odd, sensor.limits), _compared(even, sensor.limits)
        found.append(
            SensorFindings(
                sensor, judged, fitted, gates, reasons, disagreements, (measured, made), pair
            )
        )
    return found


def _compared(readings: Sequence[tuple[Series, Series]], limits: Limits) -> Comparison:
    sides = [[statistics(side, limits) for side in sides] for sides in zip(*readings, strict=True)]
    measured, made = (
        {key: np.array([haul[key] for haul in side]) for key in STATISTICS} for side in sides
    )
    return Comparison(measured, made)


def _typical(hauls: Sequence[SurveyHaul]) -> int:
    """Number of the haul with the median number of readings, for the picture."""
    by_length = sorted(hauls, key=lambda haul: len(haul.series.time))
    return by_length[len(by_length) // 2].number
