"""Silences of net sensors against the length of wire, in a sea experiment with stepped lengths."""

import csv
import gzip
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from scipy.stats import spearmanr

from studies.instruments.statistics import SILENCE_S
from studies.instruments.survey import MOST_ROWS
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError

TREATMENTS = 'scope_steps_2023_treatments.csv'
READINGS: Mapping[str, str] = {
    'spread': 'scope_steps_2023_width_pings.csv.gz',
    'height': 'scope_steps_2023_height_pings.csv.gz',
}
FEWEST = 5
"""Readings of a stretch, at least."""


@dataclass(frozen=True)
class Stretch:
    """Stretch with one length of wire: its length (m) and duration (s), readings of one sensor,
    and the time (s) within silences of more than 10 s.
    """

    wire_m: float
    duration_s: float
    readings: int
    silent_s: float


def read_steps(folder: Path) -> dict[str, list[Stretch]]:
    """Read a sea experiment: sensor → stretches with one length of wire.

    Parameters
    ----------
    folder
        With the file `TREATMENTS` (HAUL_ID, start, end, WIRE_OUT) and those of `READINGS` (t,
        HAUL_ID), packed by gzip. Treatments without begin or end are left out.

    Raises
    ------
    TrawlError
        If there are no such tables.
    """
    try:
        with (folder / TREATMENTS).open(newline='', encoding='utf-8') as file:
            treatments = [
                (row['HAUL_ID'], float(row['start']), float(row['end']), float(row['WIRE_OUT']))
                for row in islice(csv.DictReader(file), MOST_ROWS)
                if row['start'] and row['end']
            ]
        stamps = {sensor: _stamps(folder / name) for sensor, name in READINGS.items()}
    except (OSError, EOFError, ValueError, KeyError, TypeError) as reason:
        names = ', '.join((TREATMENTS, *READINGS.values()))
        raise TrawlError(f'{folder}: cannot be read, expected {names} ({reason})') from None
    return {sensor: list(_stretches(treatments, by_haul)) for sensor, by_haul in stamps.items()}


def growth(stretches: Sequence[Stretch]) -> tuple[float, float]:
    """Return Spearman's rank correlation of wire and share of silence, and its p-value."""
    found = spearmanr(
        [one.wire_m for one in stretches], [one.silent_s / one.duration_s for one in stretches]
    )
    return float(found.statistic), float(found.pvalue)


def _stamps(path: Path) -> dict[str, FloatArray]:
    with gzip.open(path, 'rt', newline='', encoding='utf-8') as file:
        rows = [
            (row['HAUL_ID'], float(row['t'])) for row in islice(csv.DictReader(file), MOST_ROWS)
        ]
    return {
        haul: np.unique([time for of, time in rows if of == haul])
        for haul in {haul for haul, _ in rows}
    }


def _stretches(
    treatments: list[tuple[str, float, float, float]], by_haul: Mapping[str, FloatArray]
) -> Iterable[Stretch]:
    for haul, begin, end, wire in treatments:
        time = by_haul.get(haul, np.zeros(0))
        time = time[(time >= begin) & (time <= end)]
        if len(time) < FEWEST:
            continue
        gaps = np.diff(np.concatenate(([begin], time, [end])))
        yield Stretch(wire, end - begin, len(time), float(gaps[gaps > SILENCE_S].sum()))
