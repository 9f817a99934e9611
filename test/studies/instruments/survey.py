"""Readings of net sensors through the hauls of a survey, as they were recorded."""

import csv
import gzip
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.core.errors import TrawlError

FILE = 'survey_net_pings_202202_vessel94.csv.gz'
COLUMNS = ('HAUL', 't', 'CABINET_SENSOR_FLAG', 'VALUE', 'DATUM_CODE')
SPREAD, HEIGHT = 12, 23
"""Flags of the sensors: distance between the wing tips, height of the headrope."""

KEPT = 0
"""Datum code of readings that the survey's editors kept."""

MOST_ROWS = 1_000_000
FEWEST = 200
"""Readings of a haul, at least; with fewer its statistics say little."""


@dataclass(frozen=True)
class Series:
    """Readings of one sensor in one haul, in the order of time.

    Attributes
    ----------
    time
        Unix time (n,), whole seconds.
    value
        Readings (n,), m.
    code
        Datum codes (n,) of the survey's editors.
    """

    time: FloatArray
    value: FloatArray
    code: IntArray

    def kept(self) -> 'Series':
        """Return the readings that the editors kept."""
        kept = self.code == KEPT
        return Series(self.time[kept], self.value[kept], self.code[kept])


@dataclass(frozen=True)
class SurveyHaul:
    """Haul of the survey: its number and what one sensor sent."""

    number: int
    series: Series


def read_survey(path: Path) -> dict[int, list[SurveyHaul]]:
    """Read the readings of a survey.

    Parameters
    ----------
    path
        CSV, packed by gzip, with the columns of `COLUMNS`.

    Returns
    -------
    dict
        Flag of the sensor → hauls with at least `FEWEST` readings, in the order of their numbers.

    Raises
    ------
    TrawlError
        If the file is no such table.
    """
    try:
        with gzip.open(path, 'rt', newline='', encoding='utf-8') as file:
            rows = [
                [float(row[name]) for name in COLUMNS]
                for row in islice(csv.DictReader(file), MOST_ROWS + 1)
            ]
    except (OSError, EOFError, ValueError, KeyError, TypeError) as reason:
        listed = ', '.join(COLUMNS)
        raise TrawlError(f'{path}: cannot be read, expected columns {listed} ({reason})') from None
    if not 0 < len(rows) <= MOST_ROWS or not np.isfinite(rows).all():
        raise TrawlError(
            f'{path}: found {len(rows)} rows, expected 1 to {MOST_ROWS} of finite numbers'
        )
    haul, time, flag, value, code = np.array(rows).T
    hauls: dict[int, list[SurveyHaul]] = {}
    for sensor in (SPREAD, HEIGHT):
        hauls[sensor] = []
        for number in np.unique(haul[flag == sensor]):
            of = np.flatnonzero((haul == number) & (flag == sensor))
            if len(of) < FEWEST:
                continue
            of = of[np.argsort(time[of], kind='stable')]
            series = Series(time[of], value[of], code[of].astype(np.int64))
            hauls[sensor].append(SurveyHaul(int(number), series))
    return hauls
