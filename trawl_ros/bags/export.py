# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""CSV export of bags: one file per topic, for spreadsheets and data frames."""

import csv
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TextIO

from trawl_ros.bags.flattening import (
    FlatColumn,
    FlatLayout,
    as_seconds,
    as_text,
    field_unit,
    singles,
    varies,
)
from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.files import new_folder, written_folder
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.time import SECOND
from trawl_ros.records.topics import NAMESPACE, absolute, find_topic

ARRAY_LIMIT = 128
"""Default for the largest array that is spread over columns, elements."""

DICTIONARY = 'columns.csv'
"""File that describes the columns of the other files."""

LOG_COLUMNS = ('log_time_s', 'log_time_ns')

_FORMULA = ('=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠')  # wide ones
_NUMBER = re.compile(r'[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|inf|nan)', re.IGNORECASE)


@dataclass(frozen=True)
class ExportedTopic:
    """Exported topic: its file (None if none), rows, and the fields left out, with reasons."""

    topic: str
    file: Path | None
    rows: int
    left_out: Mapping[str, str]


@dataclass(frozen=True)
class Exported:
    """Result of an export, and the problems of the bag."""

    topics: tuple[ExportedTopic, ...]
    problems: tuple[str, ...]


def export_bag(
    path: str | Path,
    folder: str | Path,
    *,
    topics: Collection[str] = (),
    namespace: str = NAMESPACE,
    array_limit: int = ARRAY_LIMIT,
    on_progress: OnProgress = ignore,
) -> Exported:
    """Write the messages of a bag as CSV files into a new folder.

    Parameters
    ----------
    path
        A bag's folder, or one file of it; may be damaged.
    folder
        Folder to be made. Beside one file per topic it gets `DICTIONARY`, which says topic, type
        and unit of each column.
    topics
        Names of those wanted, relative or in full; by default all.
    namespace
        Of the project's topics in this bag.
    array_limit
        Longer arrays do not go into columns.
    on_progress
        Called after each row, with the recorded time (s) that is done.

    Returns
    -------
    Exported
        File and number of rows by topic, the fields left out, and problems of the bag.

    Raises
    ------
    BagError
        If there is no bag, no such topic, nothing that can be written, or the folder exists or
        cannot be written.

    Examples
    --------
    >>> import trawl_ros
    >>> bag = trawl_ros.tow('tow.yaml', 'exported')
    >>> done = trawl_ros.export_bag(bag.path, 'tables', topics=['door/spread'])
    >>> [(table.file.name, table.rows) for table in done.topics]
    [('trawl.door.spread.csv', 2)]
    """
    folder = new_folder(Path(folder), BagError)
    bag = Bag(path, namespace=namespace, lenient=True)
    wanted = _wanted(bag, topics, namespace)
    layouts = _layouts(bag, wanted, array_limit)
    if not any(table.columns for table in layouts.values()):
        reasons = [
            f'{field} of {topic} {reason}'
            for topic, table in layouts.items()
            for field, reason in table.layout.left_out.items()
        ]
        known = '; '.join([*bag.problems, *reasons]) or 'no message'
        raise BagError(f'{bag.path}: gives no table rows ({known}), expected at least one message')
    with written_folder(folder, BagError) as draft:
        draft.mkdir()
        tables = _write(bag, draft, layouts, on_progress)
        done = tuple(
            replace(table, file=table.file and folder / table.file.name) for table in tables
        )
        _write_dictionary(bag, draft, layouts, namespace)
    return Exported(done, tuple(bag.problems))


@dataclass(frozen=True)
class _Table:
    """Table of a topic's file: its layout, columns, and those of 32 bits."""

    file_name: str
    layout: FlatLayout
    columns: tuple[FlatColumn, ...]
    singles: frozenset[str]

    def cells(self, log_time: int, message: Any) -> list[str]:
        return [
            as_seconds(log_time),
            str(log_time),
            *(
                as_text(column.value(message), single=column.path in self.singles)
                for column in self.columns
            ),
        ]


def _wanted(bag: Bag, names: Collection[str], namespace: str) -> list[str]:
    if not names:
        return sorted(bag.topics)
    wanted = {absolute(name, namespace) for name in names}
    if missing := sorted(wanted - bag.topics.keys()):
        raise BagError(
            f'{bag.path}: no topic {", ".join(missing)}; expected some of '
            f'{", ".join(sorted(bag.topics))}'
        )
    return sorted(wanted)


def _layouts(bag: Bag, wanted: list[str], array_limit: int) -> dict[str, _Table]:
    """Return the columns of each topic; for types of varying size all messages are read."""
    layouts: dict[str, FlatLayout] = {}
    known: dict[str, tuple[bool, frozenset[str]]] = {}
    for topic in wanted:
        try:
            store = bag.types_of(topic)
        except BagError as reason:
            bag.problems.append(f'{bag.path}: {reason}; its messages are left out')
            continue
        name = bag.topics[topic]
        known[topic] = varies(store, name), singles(store, name)
    for message in bag.as_stored():
        topic = message.topic
        if topic not in known or (topic in layouts and not known[topic][0]):
            continue
        try:
            decoded = bag.decode(message)
        except MessageError:
            continue
        layouts.setdefault(topic, FlatLayout(array_limit)).learn(decoded)
    names = _file_names(layouts)
    return {
        topic: _Table(names[topic], layout, tuple(layout.finish()), known[topic][1])
        for topic, layout in sorted(layouts.items())
    }


def _file_names(topics: Collection[str]) -> dict[str, str]:
    """Return file names for the topics: safe as paths, and unique."""
    names: dict[str, str] = {}
    for topic in sorted(topics):
        base = re.sub(r'[^A-Za-z0-9_]+', '.', topic).strip('.') or 'topic'
        name, number = f'{base}.csv', 2
        while name in (*names.values(), DICTIONARY):
            name, number = f'{base}.{number}.csv', number + 1
        names[topic] = name
    return names


def _write(
    bag: Bag, folder: Path, tables: Mapping[str, _Table], on_progress: OnProgress
) -> Iterator[ExportedTopic]:
    rows = dict.fromkeys(tables, 0)
    written = {topic: table for topic, table in tables.items() if table.columns}
    with ExitStack() as stack:
        writers = {}
        for topic, table in written.items():
            stream = stack.enter_context(
                (folder / table.file_name).open('x', encoding='utf-8', newline='')
            )
            writers[topic] = CsvOutput(stream)
            writers[topic].row([*LOG_COLUMNS, *(column.name for column in table.columns)])
        start: int | None = None
        if writers:
            for received in bag.messages(writers):
                cells = written[received.topic].cells(received.log_time, received.message)
                writers[received.topic].row(cells)
                rows[received.topic] += 1
                start = received.log_time if start is None else start
                done_s = (received.log_time - start) / SECOND
                on_progress(WorkProgress('exporting', done_s, None, 's'))
    for topic, table in tables.items():
        file = folder / table.file_name if topic in written else None
        yield ExportedTopic(topic, file, rows[topic], dict(table.layout.left_out))


def _write_dictionary(bag: Bag, folder: Path, tables: Mapping[str, _Table], namespace: str) -> None:
    with (folder / DICTIONARY).open('x', encoding='utf-8', newline='') as stream:
        writer = CsvOutput(stream)
        writer.row(['file', 'column', 'unit', 'topic', 'type'])
        for topic, table in tables.items():
            if not table.columns:
                continue
            type_name = bag.topics[topic]
            known = find_topic(topic, namespace)
            contract = known.name if known else ''
            for column, unit in zip(LOG_COLUMNS, ('s', 'ns'), strict=True):
                writer.row([table.file_name, column, unit, topic, type_name])
            for entry in table.columns:
                unit = field_unit(contract, type_name, entry.path)
                writer.row([table.file_name, entry.name, unit, topic, type_name])


class CsvOutput:
    """CSV writer of rows: comma, lines that end with LF.

    Parameters
    ----------
    stream
        Opened with ``newline=''``.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        # Before Python 3.13 a CR in a cell is quoted only where it is part of the line's end.
        self._writer = csv.writer(self, lineterminator='\r\n')

    def row(self, cells: Iterable[str]) -> None:
        """Write one row; text that a spreadsheet would read as a formula is made harmless."""
        self._writer.writerow([_harmless(cell) for cell in cells])

    def write(self, line: str) -> None:
        """Write a line from the module `csv`."""
        self._stream.write(f'{line[:-2]}\n')


def _harmless(cell: str) -> str:
    """Put an apostrophe before text that begins like a formula; numbers stay as they are."""
    if cell.startswith(_FORMULA) and not _NUMBER.fullmatch(cell):
        return f"'{cell}"
    return cell
