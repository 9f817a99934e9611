# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Layout of loggers' tables: separators, lines above the names, long tables, and numbers."""

import codecs
import csv
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import TextIOWrapper
from itertools import islice
from pathlib import Path
from typing import Annotated, Literal, TextIO

from pydantic import Field, model_validator

from trawl_ros.core.errors import LogError
from trawl_ros.core.foreign import one_line, open_file, reading
from trawl_ros.core.limits import LOG_NULS
from trawl_ros.core.schema import Record

MAX_LINE = 1_000_000
"""Longest line, characters; a longer one is not part of a table."""

OF_THE_ROW = ('clock', 'only')
"""Keys whose columns are ordinary columns in a long table too."""

ProbeFormat = Literal['notus', 'esonar', 'netmind', 'scanmar_scd']
"""Formats of receivers of net sensors that are no plain tables."""

BLANKS = 'blanks'
_NAMED = {'tab': '\t'}
_DEGREES = re.compile(r'[°º˚d\'′’"″m\s:]+')
_NEGATIVE, _POSITIVE = ('S', 'W'), ('N', 'E')


class Long(Record):
    """Long table with one reading per row: columns of its quantity and its value."""

    name: str
    value: str


class LogLayout(Record):
    """Layout of a log file.

    ``format`` is that of a receiver of net sensors, to which the other keys do not apply, or a
    plain table. ``separator`` is one character, ``tab``, or ``blanks`` for any number of blanks.
    ``skip_lines`` are above the line of column names, ``skip_after_names`` (such as a line of
    units) below it.
    ``names`` are the column names of a file without such a line. If several columns have one name,
    the log is refused, or the ``first`` is used. Lines that begin with ``comment`` are ignored.
    """

    format: ProbeFormat | Literal['table'] = 'table'
    encoding: str = 'utf-8'
    separator: str = ','
    decimal: Literal['.', ','] = '.'
    quote: Annotated[str, Field(min_length=1, max_length=1)] = '"'
    skip_lines: Annotated[int, Field(ge=0)] = 0
    skip_after_names: Annotated[int, Field(ge=0)] = 0
    names: tuple[str, ...] | None = None
    repeated: Literal['refused', 'first'] = 'refused'
    comment: Annotated[str, Field(min_length=1)] | None = None
    long: Long | None = None

    @model_validator(mode='after')
    def _makes_sense(self) -> 'LogLayout':
        try:
            codecs.lookup(self.encoding)
        except LookupError:
            raise ValueError(
                f'encoding: found {self.encoding!r}, expected one such as utf-8, cp1252, utf-16'
            ) from None
        if self.separator not in (*_NAMED, BLANKS) and len(self.separator) != 1:
            raise ValueError(
                f'separator: found {self.separator!r}, expected one character, tab or {BLANKS}'
            )
        if self.separator == self.decimal:
            raise ValueError(f'separator: found {self.decimal!r}, which is the decimal sign too')
        return self


class BadRow(LogError):
    """Row that cannot be used; ``reason`` says why, without its line."""

    def __init__(self, message: str, reason: str) -> None:
        super().__init__(message)
        self.reason = reason


@dataclass(frozen=True)
class LogRow:
    """Row of a log: its file, line, and cells by column name."""

    path: Path
    line: int
    cells: Mapping[str, str]

    def text(self, column: str) -> str:
        """Return a cell; columns without a row of a long table are empty."""
        return self.cells.get(column, '')

    def bad(self, column: str, expected: str) -> BadRow:
        """Return the error for a wrong cell."""
        return BadRow(
            f'{self.path}: line {self.line}, column {column!r}: found {self.text(column)!r}, '
            f'expected {expected}',
            f'column {column!r}: expected {expected}',
        )


def read_rows(
    path: Path, layout: LogLayout, needed: Mapping[str, str], keys: Sequence[str]
) -> Iterator[LogRow | BadRow]:
    """Read a log row by row; empty lines are ignored.

    Parameters
    ----------
    path
        The log.
    layout
        Layout of the table in its file.
    needed
        Columns that must be there, each with what wants it.
    keys
        Columns that are the same for all rows of one instant, in a long table.

    Yields
    ------
    Row or BadRow
        The latter for a row with too few or too many cells.

    Raises
    ------
    LogError
        If there is no file, it is not such a table, or a column is not there exactly once as the
        layout wants it.
    """
    # A mark at the beginning, as Windows programs put there, is no part of the first name.
    encoding = 'utf-8-sig' if layout.encoding.lower() in ('utf-8', 'utf8') else layout.encoding
    with reading(path, LogError), open_file(path, LogError) as content:
        try:
            if content.read(2) in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
                encoding = 'utf-16'
            content.seek(0)
            stream = TextIOWrapper(content, encoding, newline='')
            rows = _wide(path, layout, needed, _Lines(path, stream, layout))
            yield from (
                rows if layout.long is None else _joined(path, layout.long, rows, needed, keys)
            )
        except (UnicodeError, csv.Error) as reason:
            raise LogError(
                f'{path}: not CSV in {layout.encoding.upper()} ({reason}); expected what layout '
                'says'
            ) from reason


class _Lines:
    """Lines of a log, bounded in length, without comments, with their numbers."""

    def __init__(self, path: Path, stream: TextIO, layout: LogLayout) -> None:
        self.number = 0
        self._path = path
        self._stream = stream
        self._comment = layout.comment
        for _ in range(layout.skip_lines):
            if not self._next():
                break

    def __iter__(self) -> '_Lines':
        return self

    def __next__(self) -> str:
        while line := self._next():
            if self._comment is None or not line.lstrip().startswith(self._comment):
                return line
        raise StopIteration

    def _next(self) -> str:
        line = '\0'
        # A loss of power leaves blocks of NULs.
        for _ in range(LOG_NULS.value // MAX_LINE):
            if not line or line.strip('\0'):
                break
            line = self._stream.readline(MAX_LINE)
        else:
            raise LogError(f'{self._path}: more than {LOG_NULS} of NULs; expected a table')
        line = line.replace('\0', '')
        self.number += bool(line)
        if len(line) == MAX_LINE:
            raise LogError(
                f'{self._path}: line {self.number} has {MAX_LINE} characters or more; expected a '
                'table'
            )
        return line


def _wide(
    path: Path, layout: LogLayout, needed: Mapping[str, str], lines: _Lines
) -> Iterator[LogRow | BadRow]:
    table = _cells(lines, layout)
    names = [name.strip() for name in layout.names or next(table, [])]
    if not names:
        raise LogError(f'{path}: the file is empty; expected a line of column names')
    wanted = dict(needed)
    if layout.long is not None:
        wanted = {column: where for column, where in needed.items() if where in OF_THE_ROW}
        wanted |= dict.fromkeys((layout.long.name, layout.long.value), 'layout.long')
    for column, where in wanted.items():
        if names.count(column) != 1 and not (column in names and layout.repeated == 'first'):
            found = 'more than one' if column in names else 'no'
            raise LogError(
                f'{path}: {found} column {column!r} (wanted by {where}); '
                f'columns are {one_line(", ".join(names), 500)}'
            )
    for _ in islice(table, layout.skip_after_names):
        pass
    for cells in table:
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(names):
            yield BadRow(
                f'{path}: line {lines.number} has {len(cells)} cells; '
                f'expected {len(names)} as in the first line',
                'another number of cells than columns',
            )
            continue
        texts = [cell.strip() for cell in cells]
        # The first of one name comes last, and stays.
        named = dict(zip(reversed(names), reversed(texts), strict=True))
        yield LogRow(path, lines.number, named)


def _cells(lines: _Lines, layout: LogLayout) -> Iterator[list[str]]:
    if layout.separator == BLANKS:
        return (line.split() for line in lines)
    separator = _NAMED.get(layout.separator, layout.separator)
    return csv.reader(lines, strict=True, delimiter=separator, quotechar=layout.quote)


def _joined(
    path: Path,
    long: Long,
    rows: Iterator[LogRow | BadRow],
    needed: Mapping[str, str],
    keys: Sequence[str],
) -> Iterator[LogRow | BadRow]:
    """Join the consecutive readings of one instant into one row."""
    columns: set[str] = set()
    instant: dict[str, str] = {}
    cells: dict[str, str] = {}
    line = 0
    for row in rows:
        if isinstance(row, BadRow):
            yield row
            continue
        name = row.text(long.name)
        now = {key: row.text(key) for key in keys if key in row.cells}
        if cells and (now != instant or name in cells):
            yield LogRow(path, line, {**instant, **cells})
            cells = {}
        if not cells:
            instant, line = now, row.line
        columns.add(name)
        cells[name] = row.text(long.value)
    if cells:
        yield LogRow(path, line, {**instant, **cells})
    for column, where in needed.items():
        if column not in columns and where not in OF_THE_ROW:
            raise LogError(
                f'{path}: no row with {column!r} in column {long.name!r} (wanted by {where}); '
                f'there are {one_line(", ".join(sorted(columns)), 500)}'
            )


def parse_number(text: str, decimal: Literal['.', ','] = '.') -> float:
    """Read a finite number.

    Raises
    ------
    ValueError
        If it is none; the text says what was expected.
    """
    if decimal == ',' and '.' in text:
        raise ValueError('a number with a decimal comma')
    try:
        value = float(text.replace(decimal, '.'))
    except ValueError:
        raise ValueError('a number') from None
    if not math.isfinite(value) or '_' in text:
        raise ValueError('a finite number')
    return value


def parse_degrees(text: str, decimal: Literal['.', ','] = '.') -> float:
    """Read degrees and minutes, and seconds if they are there, as degrees.

    Charts and plotters write ``57 30.5 N``, ``57°30.5'N``, ``W152°15'30"`` or, packed as in NMEA
    0183, ``5730.5``. South and west are negative.

    Raises
    ------
    ValueError
        If it is none of these; the text says what was expected.
    """
    expected = ValueError("degrees and minutes such as 57 30.5 N or 57°30.5'N")
    bare = text.strip().upper()
    letters = [letter for letter in (*_NEGATIVE, *_POSITIVE) if letter in bare]
    if len(letters) > 1:
        raise expected
    for letter in letters:
        bare = bare.replace(letter, ' ')
    sign = -1.0 if letters and letters[0] in _NEGATIVE else 1.0
    bare = bare.strip()
    if bare.startswith('-'):
        sign, bare = -sign, bare[1:]
    texts = [piece for piece in _DEGREES.split(bare.lower()) if piece]
    try:
        numbers = [parse_number(piece, decimal) for piece in texts]
    except ValueError:
        raise expected from None
    if len(numbers) == 1:
        degrees = math.floor(numbers[0] / 100)
        numbers = [float(degrees), numbers[0] - 100 * degrees]
    if not 2 <= len(numbers) <= 3 or min(numbers) < 0 or max(numbers[1:]) >= 60:
        raise expected
    angle: float = sign * sum(number / 60**place for place, number in enumerate(numbers))
    return angle


def hemisphere_sign(text: str) -> float:
    """Sign of N, S, E or W.

    Raises
    ------
    ValueError
        If it is none of these.
    """
    letter = text.strip().upper()[:1]
    if letter in _NEGATIVE:
        return -1.0
    if letter in _POSITIVE:
        return 1.0
    raise ValueError('N, S, E or W')
