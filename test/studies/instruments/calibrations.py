"""Calibrations of winch counters and spread sensors beside true lengths."""

import csv
import math
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from studies.instruments.survey import MOST_ROWS
from trawl_ros.core.errors import TrawlError

FATHOM = 1.8288


@dataclass(frozen=True)
class CalibrationTable:
    """Table of readings beside truth: file, column of the truth, column → name of each sensor,
    and the unit and the step of its readings (m).
    """

    file: str
    truth: str
    sensors: tuple[tuple[str, str], ...]
    unit: float
    step: float


TABLES = (
    CalibrationTable(
        'nwx_wire_vs_counter.csv',
        'wire_out_fm',
        (('winch_stbd_fm', 'starboard counter'), ('winch_port_fm', 'port counter')),
        FATHOM,
        FATHOM,
    ),
    CalibrationTable(
        'dock_spread_sensor_calibration.csv',
        'distance_m',
        (('obs_wing_m', 'spread on the dock'),),
        1.0,
        0.1,
    ),
)


@dataclass(frozen=True)
class Calibration:
    """Calibration by the line of least squares.

    Attributes
    ----------
    sensor, number
        Its name, and how many readings there are.
    scale_error, offset
        Part by which readings are too large, and what is added to them (m).
    scatter, rounding
        Standard deviations (m) about the line, and of what rounding makes of it.
    """

    sensor: str
    number: int
    scale_error: float
    offset: float
    scatter: float
    rounding: float

    @property
    def bias(self) -> float:
        """Standard deviation (m) of what is left without rounding."""
        return math.sqrt(max(0.0, self.scatter**2 - self.rounding**2))


def read_calibrations(folder: Path) -> list[Calibration]:
    """Read the tables of `TABLES` from a folder and fit a line to each sensor's readings.

    Raises
    ------
    TrawlError
        If there are no such tables.
    """
    return [
        _fitted(table, column, sensor, folder / table.file)
        for table in TABLES
        for column, sensor in table.sensors
    ]


def _fitted(table: CalibrationTable, column: str, sensor: str, path: Path) -> Calibration:
    try:
        with path.open(newline='', encoding='utf-8') as file:
            rows = [
                (float(row[table.truth]), float(row[column]))
                for row in islice(csv.DictReader(file), MOST_ROWS)
                if row[column]
            ]
    except (OSError, ValueError, KeyError, TypeError) as reason:
        listed = f'{table.truth}, {column}'
        raise TrawlError(f'{path}: cannot be read, expected columns {listed} ({reason})') from None
    truth, reading = table.unit * np.array(rows).reshape(-1, 2).T
    if len(np.unique(truth)) < 3:
        raise TrawlError(f'{path}: found {len(truth)} rows, expected 3 different lengths at least')
    slope, offset = np.polyfit(truth, reading, 1)
    left = reading - offset - slope * truth
    return Calibration(
        sensor,
        len(truth),
        float(slope) - 1.0,
        float(offset),
        float(np.sqrt(left @ left / (len(left) - 2))),
        table.step / math.sqrt(12.0),
    )
