"""CSV logs of others become bags, by a mapping from columns to topics.

Everything is read before anything is written: a log with a mistake in its last line leaves no
half a bag.
"""

import csv
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np

from trawl_ros.bags.log_mapping import (
    UNIX_SECONDS,
    Clock,
    LogMapping,
    TopicMapping,
    Water,
    load_mapping,
)
from trawl_ros.bags.units import UNITS
from trawl_ros.bags.writer import BagWriter
from trawl_ros.errors import LogError
from trawl_ros.instruments.samples import (
    AttitudeSample,
    FixSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.messages.topics import absolute
from trawl_ros.simulation.truth import SIDES

_WINCH_READINGS = ('length', 'speed', 'tension')
_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
_MICROSECOND = timedelta(microseconds=1)
_LATEST = 2**31 * 1_000_000_000
"""ns; stamps of messages count seconds in 32 bits."""


@dataclass(frozen=True)
class Imported:
    """What an import made of a log: rows read, and messages by full topic name."""

    rows: int
    counts: Mapping[str, int]


def import_log(csv_path: str | Path, mapping_path: str | Path, bag_path: str | Path) -> Imported:
    """Turn a CSV log into a bag.

    Parameters
    ----------
    csv_path
        The log, in UTF-8, with one line of column names.
    mapping_path
        Says which column is what; see `LogMapping`.
    bag_path
        Folder to be made.

    Returns
    -------
    Imported
        A row gives one message per topic for which it has a reading, stamped with its time. An
        empty cell or one with NaN gives none; a winch message with some of its readings has NaN
        for the others.

    Raises
    ------
    LogError
        If log or mapping are missing or wrong; names file, line and column.
    BagError
        If the bag exists or cannot be written.
    """
    path = Path(csv_path)
    mapping = load_mapping(mapping_path)
    rows = [(_stamp(row, mapping.clock), row) for row in _rows(path, mapping)]
    samples = [
        sample
        for stamp, row in rows
        for topic, entry in mapping.topics.items()
        if (sample := _sample(topic, stamp, _readings(row, entry, mapping), entry, mapping.water))
    ]
    if not samples:
        raise LogError(f'{path}: {len(rows)} rows without any reading; expected at least one')
    counts: Counter[str] = Counter()
    with BagWriter(bag_path, custom_data={'log': path.name}) as bag:
        for sample in samples:
            topic, message = sample_message(sample)
            bag.write(absolute(topic), message.__msgtype__, serialize(message), sample.stamp)
            counts[absolute(topic)] += 1
    return Imported(len(rows), counts)


@dataclass(frozen=True)
class _Row:
    path: Path
    line: int
    cells: Mapping[str, str]

    def error(self, column: str, expected: str) -> LogError:
        found = self.cells[column]
        return LogError(
            f'{self.path}: line {self.line}, column {column!r}: found {found!r}, '
            f'expected {expected}'
        )


def _rows(path: Path, mapping: LogMapping) -> Iterator[_Row]:
    needed = dict.fromkeys(mapping.clock.columns, 'clock')
    for topic, entry in mapping.topics.items():
        needed |= {field.column: f'topics.{topic}' for field in entry.fields.values()}
    try:
        with path.open(encoding='utf-8-sig', newline='') as stream:
            reader = csv.reader(stream, strict=True)
            names = [name.strip() for name in next(reader, [])]
            if not names:
                raise LogError(f'{path}: the file is empty; expected a line of column names')
            for column, where in needed.items():
                if names.count(column) != 1:
                    found = 'more than one' if column in names else 'no'
                    raise LogError(
                        f'{path}: {found} column {column!r} (wanted by {where}); '
                        f'columns are {", ".join(names)}'
                    )
            for cells in reader:
                if not any(cell.strip() for cell in cells):
                    continue
                if len(cells) != len(names):
                    raise LogError(
                        f'{path}: line {reader.line_num} has {len(cells)} cells; '
                        f'expected {len(names)} as in the first line'
                    )
                texts = (cell.strip() for cell in cells)
                yield _Row(path, reader.line_num, dict(zip(names, texts, strict=True)))
    except FileNotFoundError:
        raise LogError(f'{path}: no such file') from None
    except OSError as reason:
        raise LogError(f'{path}: cannot be read ({reason.strerror})') from reason
    except (UnicodeDecodeError, csv.Error) as reason:
        raise LogError(f'{path}: not CSV in UTF-8 ({reason})') from reason


def _stamp(row: _Row, clock: Clock) -> int:
    text = ' '.join(row.cells[column] for column in clock.columns)
    shift = timedelta(hours=clock.utc_offset_h)
    try:
        if clock.format == UNIX_SECONDS:
            offset = Decimal(clock.utc_offset_h) * 3600
            stamp = int((Decimal(text) - offset) * 1_000_000_000)
        else:
            time = datetime.strptime(text, clock.format)
            zoned = time if time.tzinfo else time.replace(tzinfo=timezone(shift))
            stamp = (zoned - _EPOCH) // _MICROSECOND * 1000
    except (ValueError, OverflowError, InvalidOperation):
        named = ' and '.join(repr(column) for column in clock.columns)
        raise LogError(
            f'{row.path}: line {row.line}, column {named}: found {text!r}, '
            f'expected a time as {clock.format}'
        ) from None
    if not 0 <= stamp < _LATEST:
        raise LogError(f'{row.path}: line {row.line}: time {text!r}, expected 1970 to 2038')
    return stamp


def _readings(row: _Row, entry: TopicMapping, mapping: LogMapping) -> dict[str, float]:
    """Give the fields of one topic in SI units; NaN where the row has none."""
    found = {}
    for field, source in entry.fields.items():
        text = row.cells[source.column]
        if text.lower() in mapping.missing:
            found[field] = math.nan
            continue
        try:
            number = float(text)
        except ValueError:
            raise row.error(source.column, f'a number ({source.unit})') from None
        if not math.isfinite(number) or '_' in text:
            raise row.error(source.column, f'a finite number ({source.unit})')
        found[field] = source.si(number)
    return found


def _sample(
    topic: str,
    stamp: int,
    readings: dict[str, float],
    entry: TopicMapping,
    water: Water | None,
) -> Sample | None:
    """Put together the sample of a topic; None if there is no reading for it."""
    missing = [math.isnan(value) for value in readings.values()]
    std = 0.0 if entry.std is None else entry.std.si()
    if all(missing) if topic == 'winch/joint_states' else any(missing):
        return None
    match topic.split('/'):
        case ['winch', _]:
            return WinchSample(stamp, *(_pair(readings, what) for what in _WINCH_READINGS))
        case [*_, place, 'pressure']:
            if water and entry.std and UNITS[entry.std.unit][0] == 'length':
                std = water.depth_to_difference(std)
            if water and 'depth' in readings:
                return PressureSample(stamp, place, water.pressure(readings['depth']), std)
            return PressureSample(stamp, place, readings['pressure'], std)
        case ['door', side, 'attitude']:
            return AttitudeSample(stamp, side, readings['pitch'], readings['roll'], std)
        case ['vessel', what]:
            return _vessel_sample(what, stamp, readings, std)
    limits = [limit.si() for limit in (entry.min_range, entry.max_range) if limit]
    return RangeSample(stamp, topic.split('/')[1], readings['distance'], std, *limits)


def _vessel_sample(what: str, stamp: int, readings: dict[str, float], std: float) -> Sample:
    match what:
        case 'velocity_water':
            velocity = np.array([readings['forward'], 0.0, 0.0])
            return VelocitySample(stamp, 'water', velocity, math.nan)
        case 'velocity_ground':
            yaw = _yaw(readings['compass_course'])
            velocity = readings['speed'] * np.array([math.cos(yaw), math.sin(yaw), 0.0])
            return VelocitySample(stamp, 'ground', velocity, math.nan)
        case 'heading':
            return HeadingSample(stamp, _yaw(readings['compass_heading']), std)
    latitude, longitude = (math.degrees(readings[field]) for field in ('latitude', 'longitude'))
    return FixSample(stamp, latitude, longitude, std)


def _pair(readings: dict[str, float], what: str) -> tuple[float, float]:
    port, starboard = (readings.get(f'{side}_{what}', math.nan) for side in SIDES)
    return port, starboard


def _yaw(compass: float) -> float:
    """Turn an angle clockwise from north into one counter-clockwise from east, -π to π."""
    return math.remainder(math.pi / 2 - compass, 2 * math.pi)
