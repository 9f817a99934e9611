"""Readings of a simulated sensor through the course of a measured haul."""

import numpy as np

from studies.instruments.course import course_of
from studies.instruments.survey import KEPT, Series, SurveyHaul
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.distance import RangeInstrument
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import RangeParameters

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
