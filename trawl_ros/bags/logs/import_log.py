# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Import of foreign logs as bags, by a mapping from columns or sentences to topics.

The whole log is read before anything is written, so that an error in its last line does not leave
half a bag.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Literal

import numpy as np

from trawl_ros.bags.logs.clock import ClockReader
from trawl_ros.bags.logs.layout import (
    BadRow,
    LogRow,
    hemisphere_sign,
    parse_degrees,
    parse_number,
    read_rows,
)
from trawl_ros.bags.logs.mapping import ColumnMapping, LogMapping, TopicMapping, load_mapping
from trawl_ros.bags.logs.probe_files import read_probe_rows
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError, LogError
from trawl_ros.core.files import new_folder, written_folder
from trawl_ros.core.limits import LOG_READINGS
from trawl_ros.core.stamps import LOG_APART_NS, judge_stamps
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.fields import sample_of_fields
from trawl_ros.records.possible import impossible, impossible_fields
from trawl_ros.records.samples import Sample
from trawl_ros.records.topics import absolute
from trawl_ros.sentences.log import SentenceLogReader, listed

NO_READING = 'no reading, or none that is new'


@dataclass(frozen=True)
class Imported:
    """Result of an import.

    ``rows`` (lines of sentences) were read, ``counts`` are messages by full topic name,
    ``left_out`` says how many rows gave none, by reason. ``notes`` are sentences on its
    clocks, and on what it lacks. ``of_sentences`` is true for a log of sentences.
    """

    rows: int
    counts: Mapping[str, int]
    left_out: Mapping[str, int]
    notes: tuple[str, ...] = ()
    of_sentences: bool = False


def import_log(
    log_path: str | Path,
    mapping_path: str | Path,
    bag_path: str | Path,
    *,
    leave_out: bool = False,
) -> Imported:
    r"""Turn a log into a bag.

    Parameters
    ----------
    log_path
        The log: a table (CSV and its relatives), or sentences of NMEA 0183 and of fishing gear.
    mapping_path
        Says which column or sentence is what; see `LogMapping` and `SentenceMapping`.
    bag_path
        Folder to be made.
    leave_out
        True if rows that cannot be understood are left out and counted; by default the first
        of them is an error. Damaged sentences always are left out: serial lines lose bytes. Of
        them only a recorder's time that cannot be understood is an error.

    Returns
    -------
    Imported
        A row gives one message per topic for which it has a reading, stamped with its time. An
        empty cell or one with NaN gives none; a winch message with some of its readings has NaN
        for the others.

    Raises
    ------
    LogError
        If log or mapping are missing or wrong, or nothing in the log says the time; names file,
        line and column.
    BagError
        If the bag exists or cannot be written.

    Examples
    --------
    >>> from pathlib import Path
    >>> import trawl_ros
    >>> _ = Path('log.csv').write_text('s,depth\n0,61.5\n1,61.7\n')
    >>> _ = Path('log.yaml').write_text('''
    ... clock: {columns: [s], format: elapsed seconds, start: '2026-08-01 12:00:00'}
    ... water: {density_kg_m3: 1025.0}
    ... topics: {door/port/pressure: {fields: {depth: {column: depth, unit: m}}}}
    ... ''')
    >>> done = trawl_ros.import_log('log.csv', 'log.yaml', 'from_log')
    >>> done.rows, dict(done.counts)
    (2, {'/trawl/door/port/pressure': 2})
    """
    path = Path(log_path)
    mapping = load_mapping(mapping_path)
    reader: _TableReader | SentenceLogReader
    if isinstance(mapping, LogMapping):
        reader = _TableReader(path, mapping, leave_out)
    else:
        reader = SentenceLogReader(path, mapping.options(leave_out=leave_out))
    return _write_samples(path, reader, bag_path)


class _TableReader:
    """Single pass through a table, with counts of rows and of rejected rows, and notes."""

    def __init__(self, path: Path, mapping: LogMapping, leave_out: bool) -> None:
        self.rows = 0
        self.left: Counter[str] = Counter()
        self.notes: list[str] = []
        self._path = path
        self._mapping = mapping
        self._leave_out = leave_out
        self._decimal: Literal['.', ','] = mapping.layout.decimal
        self._missing = set(mapping.missing)
        self._missing_numbers = {
            number for text in mapping.missing if (number := _number(text)) is not None
        }
        self._clocks = [(clock, ClockReader(clock, self._decimal)) for clock in mapping.clocks()]
        self._last: dict[str, dict[str, float]] = {}
        self._absent: set[str] | None = None

    def samples(self) -> Iterable[Sample]:
        keys = [column for clock in self._mapping.clocks() for column in clock.columns]
        keys += self._mapping.only
        for row in self._rows_of(keys):
            self.rows += 1
            try:
                if isinstance(row, BadRow):
                    raise row
                yield from self._row(row)
            except BadRow as bad:
                if not self._leave_out:
                    raise
                self.left[bad.reason] += 1

    def _rows_of(self, keys: list[str]) -> Iterable[LogRow | BadRow]:
        layout, needed = self._mapping.layout, self._mapping.needed()
        if layout.format == 'table':
            return read_rows(self._path, layout, needed, keys)
        rows, notes = read_probe_rows(self._path, layout.format)
        self.notes += notes
        for row in (one for one in rows if isinstance(one, LogRow)):
            if absent := [name for name in needed if name not in row.cells]:
                raise LogError(
                    f'{self._path}: no column {absent[0]!r} (wanted by {needed[absent[0]]}); '
                    f'columns are {", ".join(row.cells)}'
                )
            break
        return rows

    def _look_for_absent(self, row: LogRow) -> set[str]:
        """Find the optional topics for which the log lacks a column."""
        found = set()
        # The rows of a long table differ in what they have.
        topics = self._mapping.topics if self._mapping.layout.long is None else {}
        for topic, entry in topics.items():
            absent = [column for column in entry.columns if column not in row.cells]
            if entry.optional and absent:
                self.notes.append(f'{topic} is left out: no column {" or ".join(absent)}')
                found.add(topic)
        return found

    def _row(self, row: LogRow) -> list[Sample]:
        for column, texts in self._mapping.only.items():
            if row.text(column) not in texts:
                self.left[f'column {column!r} is not {" or ".join(texts)}'] += 1
                return []
        if self._absent is None:
            self._absent = self._look_for_absent(row)
        stamps = [self._stamp(row, number) for number in range(len(self._clocks))]
        samples = []
        own = 0
        for topic, entry in self._mapping.topics.items():
            own += entry.clock is not None
            if topic in self._absent:
                continue
            stamp = stamps[own] if entry.clock else stamps[0]
            readings = self._readings(row, entry)
            if entry.changes_only and readings == self._last.get(topic):
                continue
            water = self._mapping.water
            stated = entry.si(topic, water)
            if stamp is not None and (
                sample := sample_of_fields(topic, stamp, readings, stated, water)
            ):
                self._refuse_impossible(row, topic, entry, sample, readings)
                self._last[topic] = readings
                samples.append(sample)
        if not samples:
            self.left[NO_READING] += 1
        return samples

    def _refuse_impossible(
        self,
        row: LogRow,
        topic: str,
        entry: TopicMapping,
        sample: Sample,
        readings: dict[str, float],
    ) -> None:
        if why := impossible(sample) or impossible_fields(readings):
            columns = ' and '.join(repr(source.column) for source in entry.fields.values())
            raise BadRow(
                f'{row.path}: line {row.line}, column {columns}: found a {why} for {topic}',
                f'column {columns}: {why}',
            )

    def _stamp(self, row: LogRow, number: int) -> int | None:
        clock, reader = self._clocks[number]
        text = ' '.join(row.text(column) for column in clock.columns)
        # A topic that has a clock of its own may have no reading here, and then has no time.
        if number and text.strip().lower() in self._missing:
            return None
        try:
            return reader.read(text)
        except ValueError as expected:
            named = ' and '.join(repr(column) for column in clock.columns)
            raise BadRow(
                f'{row.path}: line {row.line}, column {named}: found {text!r}, expected {expected}',
                f'column {named}: expected {expected}',
            ) from None

    def _readings(self, row: LogRow, entry: TopicMapping) -> dict[str, float]:
        """Return the fields of one topic in SI units; NaN if the row has none."""
        return {field: self._reading(row, source) for field, source in entry.fields.items()}

    def _reading(self, row: LogRow, source: ColumnMapping) -> float:
        text = row.text(source.column)
        if text.lower() in self._missing:
            return math.nan
        parse = parse_degrees if source.unit == 'deg_min' else parse_number
        try:
            number = parse(text, self._decimal)
        except ValueError as expected:
            raise row.bad(source.column, f'{expected} ({source.unit})') from None
        if number in self._missing_numbers or number in source.missing:
            return math.nan
        if source.hemisphere:
            try:
                number *= hemisphere_sign(row.text(source.hemisphere))
            except ValueError as expected:
                raise row.bad(source.hemisphere, str(expected)) from None
        return source.si(number)


def _write_samples(
    path: Path, reader: _TableReader | SentenceLogReader, bag_path: str | Path
) -> Imported:
    """Write the samples of a log as a bag, in time order."""
    new_folder(Path(bag_path), BagError)
    ordered = list(islice(reader.samples(), LOG_READINGS.value + 1))
    if len(ordered) > LOG_READINGS.value:
        raise LogError(f'{path}: more than {LOG_READINGS}; expected a log in several files')
    judged = judge_stamps(
        np.array([sample.stamp for sample in ordered], dtype=np.int64), apart_ns=LOG_APART_NS
    )
    ordered = [one for one, false in zip(ordered, judged.false, strict=True) if not false]
    ordered.sort(key=lambda sample: sample.stamp)
    if not ordered:
        left_out = {**reader.left, **judged.reasons}
        why = f' ({listed(left_out)})' if left_out else ''
        raise LogError(
            f'{path}: {reader.rows} rows without any reading{why}; expected at least one'
        )
    counts: Counter[str] = Counter()
    with (
        written_folder(Path(bag_path), BagError) as draft,
        BagWriter(draft, custom_data={'log': path.name}) as bag,
    ):
        for sample in ordered:
            topic, message = sample_message(sample)
            bag.write(absolute(topic), message.__msgtype__, serialize(message), sample.stamp)
            counts[absolute(topic)] += 1
    notes = (*reader.notes, *judged.sentences())
    return Imported(reader.rows, counts, reader.left, notes, isinstance(reader, SentenceLogReader))


def _number(text: str) -> float | None:
    try:
        return parse_number(text.replace(',', '.'))
    except ValueError:
        return None
