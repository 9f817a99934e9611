# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files of net-sensor receivers that are no plain tables: Notus, eSonar, NetMind, Scanmar SCD.

Each reader gives rows with one column per sensor, as a table has. A cell is empty where no reading
is new: these receivers repeat a reading until the next one arrives. A sensor that was asked and
gave nothing has `NO_ANSWER`.
"""

import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from trawl_ros.bags.logs.layout import BadRow, LogRow, ProbeFormat
from trawl_ros.core.errors import LogError
from trawl_ros.core.foreign import read_whole, reading
from trawl_ros.core.limits import LOG_READINGS, PROBE_BYTES

NO_ANSWER = '---'
"""Cell of a sensor that gave no reading, or an error code."""

TIME = 'time'
"""Column of the time, as 2026-08-01 10:38:51 in the clock of the file."""

MEDIAN_READINGS = 5
"""Readings on either side from whose median a jump is measured."""

MIN_JUMP_M = 1.5
"""Smallest jump of a slant range that can be a false pulse, m."""

MAX_SUM_RATIO, MAX_SUM_M = 0.3, 0.5
"""Largest sum of the jumps of range and data for which they count as opposite: a ratio of the jump,
and m."""

SCANMAR_NO_READING = 998.0
"""Value that Scanmar writes without a reading."""

_STAMP = '%Y-%m-%d %H:%M:%S'


@dataclass
class _Rows:
    """Rows of a file while it is read, with its columns in their order.

    ``lengths`` are placements whose data are in metres.
    """

    path: Path
    columns: dict[str, None] = field(default_factory=dict)
    lengths: set[str] = field(default_factory=set)
    found: list[tuple[int, dict[str, str]] | BadRow] = field(default_factory=list)

    def add(self, line: int, when: datetime, cells: Mapping[str, str]) -> None:
        if len(self.found) > LOG_READINGS.value:
            raise LogError(f'{self.path}: more than {LOG_READINGS}; expected several files')
        self.columns.update(dict.fromkeys(cells))
        self.found.append((line, {TIME: when.strftime(_STAMP), **cells}))

    def bad(self, line: int, expected: str) -> None:
        self.found.append(
            BadRow(f'{self.path}: line {line}: expected {expected}', f'line: expected {expected}')
        )


def read_probe_rows(path: Path, form: ProbeFormat) -> tuple[list[LogRow | BadRow], list[str]]:
    """Read a file of net sensors, and say what was left out of it.

    Parameters
    ----------
    path
        The file.
    form
        Its format.

    Returns
    -------
    rows, notes
        Rows in the order of the file, each with all columns, and sentences.

    Raises
    ------
    LogError
        If the file is missing or of another format; names file, line and reason.
    """
    with reading(path, LogError):
        text = read_whole(path, PROBE_BYTES, LogError, 'a file of one day')
        lines = text.decode('latin-1').replace('\0', '').splitlines()
        refuse_without_clock(path, lines)
        if (sniffed := format_of(lines)) != form:
            raise LogError(
                f'{path}: line 1: found a file of {sniffed or "no known net sensor"}, expected '
                f'{form}'
            )
        rows = _Rows(path)
        _READERS[form](lines, rows)
    notes: list[str] = []
    if form == 'notus' and (jumps := _blank_false_pulses(rows)):
        told = ', '.join(f'{count} of {name}' for name, count in jumps.items())
        notes.append(f'left out, because range and data jump by opposite amounts: {told}')
    blank = dict.fromkeys(rows.columns, '')
    return [
        one if isinstance(one, BadRow) else LogRow(path, one[0], {**blank, **one[1]})
        for one in rows.found
    ], notes


def format_of(lines: list[str]) -> ProbeFormat | None:
    """Recognise a format by the first lines of a file; None for a plain table."""
    head = '\n'.join(lines[:8])
    if head.startswith('[NOTUS TEXTFILE'):
        return 'notus'
    if 'CPU Date and Time,GPS Date' in head:
        return 'esonar'
    if head.startswith('FileName:') and 'Latitude' in head:
        return 'netmind'
    return 'scanmar_scd' if head.startswith('"Filename:') and '"DI1"' in head else None


def refuse_without_clock(path: Path, lines: list[str]) -> None:
    """Refuse the old text files of Scanmar, which have a date and no time of day.

    Raises
    ------
    LogError
        If it is such a file.
    """
    if lines and re.match(r'\d{8} \d{3} ', lines[0]):
        raise LogError(
            f'{path}: line 1: found a Scanmar file with a date and no time of day, expected a log '
            'with a clock'
        )


def _notus(lines: list[str], rows: _Rows) -> None:
    """Read blocks of polls; the date is that of the tow, and goes on at midnight."""
    day, place, last = None, '', None
    for number, line in enumerate(lines, 1):
        key, _, text = line.partition(':')
        if key == 'Tow Date':
            day = _time(text.strip(), '%d-%b-%Y %H:%M:%S')
        elif key == 'Placement':
            place, last = text.strip(), None
        elif line.startswith('Code,') and 'Data(m)' in line:
            rows.lengths.add(place)
        elif re.match(r'[A-Z]\d\d[A-Z],', line):
            cells = line.split(',')
            clock = _time(cells[1], '%H:%M:%S') if len(cells) >= 4 else None
            if day is None or not place or clock is None:
                rows.bad(number, 'code, hh:mm:ss, range, data below Tow Date and Placement')
                continue
            when = datetime.combine(last or day, clock.time())
            if last and when < last - timedelta(hours=12):
                when += timedelta(days=1)
            last = when
            rows.add(number, when, {f'{place} range': cells[2], f'{place} data': cells[3]})


def _esonar(lines: list[str], rows: _Rows) -> None:
    """Read a line per second; a reading is new where CPU time, sensor or signal differ."""
    start = next(n for n, line in enumerate(lines) if line.startswith('CPU Date and Time'))
    names, before = lines[start].split(','), ('', '', '')
    for number, line in enumerate(lines[start + 1 :], start + 2):
        one = dict(zip(names, line.split(','), strict=False))
        when = _time(f'{one.get("GPS Date")} {one.get("GPS Time")}', '%d-%b-%Y %H%M%S')
        if len(one) < len(names) or when is None:
            rows.bad(number, f'{len(names)} cells with GPS date and time')
            continue
        cells = {}
        if one['Validity'] == 'A':
            cells = {n: one[n].strip() for n in ('Latitude', 'Longitude', 'Speed', 'Heading')}
        sensor = one['Transducer Name']
        now = one['CPU Date and Time'], sensor, one['Signal Strength']
        if sensor and now != before:
            valid = one['Error Code'] == 'D' and float(one['Sensor Value'] or 0.0) != 0.0
            cells[sensor] = one['Sensor Value'] if valid else NO_ANSWER
        before = now
        rows.add(number, when, cells)


def _netmind(lines: list[str], rows: _Rows) -> None:
    """Read columns of one second each; a star marks a new reading, or else a change does."""
    start = next(n for n, line in enumerate(lines) if 'Latitude' in line and 'Date' in line)
    names = lines[start].split()[5:]
    marked = any('*' in line for line in lines[start + 1 :])
    before: list[str] = []
    for number, line in enumerate(lines[start + 1 :], start + 2):
        parts = re.sub(r'\s+\*', '*', line).split()
        if not parts:
            continue
        when = _time(' '.join(parts[:2]), '%y%m%d %H%M%S')
        if when is None or len(parts) != 9 + len(names):
            rows.bad(number, f'date, time, position, speed and {len(names)} readings')
            continue
        values = parts[9:]
        cells = {'Latitude': ' '.join(parts[2:5]), 'Longitude': ' '.join(parts[5:8])}
        cells |= {'Speed': parts[8]}
        for place, (name, value) in enumerate(zip(names, values, strict=True)):
            new = value.endswith('*') if marked else not before or value != before[place]
            cells[name] = value.rstrip('*') if new else ''
        before = values
        rows.add(number, when, cells)


def _scanmar_scd(lines: list[str], rows: _Rows) -> None:
    """Read quoted pieces; a question mark as status means that there is no sensor."""
    value = r'\s*(-?[\d.]+)'
    row = re.compile(
        r'"(\d{4}-\d\d-\d\d)""(\d\d:\d\d:\d\d)""([NS][\d:.]+)""([EW][\d:.]+)"'
        rf'{value}{value}{value}{value}"(.)"{value}{value}{value}"(.)"{value}{value}"(.)"'
        rf'{value}"(.)"{value}{value}"(.)"'
    )
    body = [(n, line) for n, line in enumerate(lines, 1) if re.match(r'"\d{4}-', line)]
    for number, line in body:
        match = row.match(line)
        when = _time(f'{match[1]} {match[2]}', _STAMP) if match else None
        if match is None or when is None:
            rows.bad(number, 'quoted date, time and position, and the columns of SCD')
            continue
        cells = {'Latitude': match[3].replace(':', ' '), 'Longitude': match[4].replace(':', ' ')}
        # Name of a sensor, and the groups of `row` with its reading and its status.
        for name, at, status in (
            ('DI1', 7, 9), ('CL1', 10, 13), ('TO1', 14, 16), ('CS1', 17, 18), ('TM1', 19, 21)
        ):  # fmt: skip
            read = NO_ANSWER if float(match[at]) == SCANMAR_NO_READING else match[at]
            cells[name] = '' if match[status] == '?' else read
        rows.add(number, when, cells)


_READERS: Mapping[ProbeFormat, Callable[[list[str], _Rows], None]] = {
    'notus': _notus, 'esonar': _esonar, 'netmind': _netmind, 'scanmar_scd': _scanmar_scd,
}  # fmt: skip


def _time(text: str, form: str) -> datetime | None:
    try:
        return datetime.strptime(text, form)
    except ValueError:
        return None


def _blank_false_pulses(rows: _Rows) -> Counter[str]:
    """Blank ranges and data that jump by opposite amounts, and count them by transponder.

    A receiver that takes a false pulse for the first of two reads a range that is too long by what
    the data, the time between the pulses, is too short.
    """
    found: Counter[str] = Counter()
    for place in sorted(rows.lengths):
        names = f'{place} range', f'{place} data'
        cells = [
            one[1]
            for one in rows.found
            if not isinstance(one, BadRow) and all(_is_number(one[1].get(n, '')) for n in names)
        ]
        values = np.array([[float(own[name]) for name in names] for own in cells])
        for at, own in enumerate(cells):
            near = values[max(0, at - MEDIAN_READINGS) : at + MEDIAN_READINGS + 1]
            jump, opposite = values[at] - np.median(near, axis=0)
            largest_sum = MAX_SUM_RATIO * abs(jump) + MAX_SUM_M
            if abs(jump) > MIN_JUMP_M and abs(jump + opposite) < largest_sum:
                own.update(dict.fromkeys(names, ''))
                found[place] += 1
    return found


def _is_number(text: str) -> bool:
    return bool(re.fullmatch(r'-?[\d.]+', text))
