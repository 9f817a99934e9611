# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Time columns of logs, and their formats."""

import re
from collections.abc import Mapping
from datetime import UTC, date, datetime, timedelta
from decimal import Decimal, InvalidOperation
from typing import Annotated, Literal
from zoneinfo import ZoneInfo

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.core.stamps import DAY_NS, END_NS
from trawl_ros.core.time import SECOND

UNIX: Mapping[str, int] = {
    'seconds': SECOND,
    'milliseconds': 1_000_000,
    'microseconds': 1000,
    'nanoseconds': 1,
}
"""Formats that count since 1970-01-01 UTC, with the nanoseconds of one unit."""

ELAPSED: Mapping[str, int] = {
    'elapsed milliseconds': 1_000_000,
    'elapsed seconds': SECOND,
    'elapsed minutes': 60 * SECOND,
    'elapsed hours': 3600 * SECOND,
    'elapsed hh:mm:ss': SECOND,
}
"""Formats that count since ``start``, with the nanoseconds of one unit."""

EXCEL_DAYS = 'excel days'
DAY_OF_YEAR = 'day of year'
ISO = 'iso'
WORDS = (*UNIX, *ELAPSED, EXCEL_DAYS, DAY_OF_YEAR, ISO)
"""Words that may replace a strptime format."""

_EPOCH = datetime(1970, 1, 1)
_EXCEL_EPOCH = datetime(1899, 12, 30)
_HALF_DAY = DAY_NS // 2
_ISO = re.compile(
    r'(?P<day>\d{4}-\d\d-\d\d|\d{8})[T _]+(?P<h>\d\d):?(?P<m>\d\d)(?::?(?P<s>\d\d)'
    r'(?:[.,](?P<fraction>\d{1,9}))?)?\s*(?P<zone>Z|[+-]\d\d(?::?\d\d)?)?',
    re.ASCII,
)
_CLOCK_FACE = re.compile(r'(\d+):([0-5]\d):([0-5]\d)(?:[.,](\d{1,9}))?', re.ASCII)
_DATED = ('%Y', '%y', '%j', '%d', '%x', '%c')


class Clock(Record):
    """Clock of a log: the time columns of a row, joined by one blank, and their format.

    ``format`` is a strptime format, or one of `WORDS`. Times without a zone are ``utc_offset_h``
    ahead of UTC, or in ``zone``, an IANA name. ``date`` is the day of the first row if the columns
    hold only the time of day; after midnight the next day begins. ``start`` is the time of zero
    elapsed time, and ``year`` that of a day of the year. ``add_s`` corrects a wrong clock.
    """

    columns: Annotated[tuple[str, ...], Field(min_length=1)]
    format: str
    utc_offset_h: Annotated[float, Field(ge=-14, le=14)] | None = None
    zone: str | None = None
    date: str | None = None
    start: str | None = None
    year: Annotated[int, Field(ge=1970, le=2037)] | None = None
    add_s: float = 0.0

    @model_validator(mode='after')
    def _fits_together(self) -> 'Clock':
        if self.zone is not None:
            if self.utc_offset_h is not None:
                raise ValueError('zone: found utc_offset_h too, expected one of them')
            try:
                ZoneInfo(self.zone)
            except (KeyError, ValueError, OSError):
                raise ValueError(
                    f'zone: found {self.zone!r}, expected a name such as America/Anchorage'
                ) from None
        if self.format not in WORDS and '%' not in self.format:
            raise ValueError(
                f"format: found {self.format!r}, expected one such as '%Y-%m-%d %H:%M:%S', or one "
                f'of {", ".join(WORDS)}'
            )
        try:
            datetime.strptime('', self.format)
        except re.error:
            raise ValueError(
                f'format: found {self.format!r}, expected each directive once'
            ) from None
        except ValueError:
            pass  # An empty text has no format; rows say what is wrong with theirs.
        self._check_key('start', self.start, self.format in ELAPSED, '2026-08-01 10:00:00')
        self._check_key('year', self.year, self.format == DAY_OF_YEAR, '2026')
        timed_only = self.format not in WORDS and not any(p in self.format for p in _DATED)
        self._check_key('date', self.date, timed_only, '2026-08-01')
        if self.start is not None and _ISO.fullmatch(self.start) is None:
            raise ValueError(f'start: found {self.start!r}, expected as 2026-08-01 10:00:00')
        if self.date is not None:
            try:
                date.fromisoformat(self.date)
            except ValueError:
                raise ValueError(f'date: found {self.date!r}, expected as 2026-08-01') from None
        return self

    def _check_key(self, name: str, value: object, wanted: bool, example: str) -> None:
        if wanted and value is None:
            raise ValueError(f'{name}: missing, expected as {example} for format {self.format!r}')
        if value is not None and not wanted:
            raise ValueError(f'{name}: given, expected none for format {self.format!r}')


class ClockReader:
    """Reader of the times of a log in the order of its rows.

    Parameters
    ----------
    clock
        Entry of the mapping.
    decimal
        Sign between a number and its fraction.
    """

    def __init__(self, clock: Clock, decimal: Literal['.', ','] = '.') -> None:
        self._clock = clock
        self._decimal = decimal
        self._zone = ZoneInfo(clock.zone) if clock.zone else None
        self._offset = round((clock.utc_offset_h or 0.0) * 3600 * SECOND)
        self._day = _nanoseconds(datetime.fromisoformat(clock.date)) if clock.date else 0
        self._last_of_day: int | None = None
        self._start = self._iso(clock.start) if clock.start else 0

    def read(self, text: str) -> int:
        """Convert the text of the columns into a stamp, ns since 1970-01-01 UTC.

        Raises
        ------
        ValueError
            If it is no such time; the text says what was expected.
        """
        try:
            stamp = self._read(text)
        except (InvalidOperation, OverflowError):
            raise ValueError(f'a time as {self._clock.format}') from None
        stamp += round(self._clock.add_s * SECOND)
        if not 0 <= stamp < END_NS:
            raise ValueError('a time from 1970 to 2038')
        return stamp

    def _read(self, text: str) -> int:
        form = self._clock.format
        if form in UNIX:
            return self._scaled(text, UNIX[form]) - self._offset
        if form == 'elapsed hh:mm:ss':
            return self._start + self._elapsed(text)
        if form in ELAPSED:
            return self._start + self._scaled(text, ELAPSED[form])
        if form == EXCEL_DAYS:
            return self._to_utc(_nanoseconds(_EXCEL_EPOCH) + self._scaled(text, DAY_NS))
        if form == DAY_OF_YEAR:
            first = _nanoseconds(datetime(self._clock.year or 1970, 1, 1))
            return self._to_utc(first + self._scaled(text, DAY_NS) - DAY_NS)
        if form == ISO:
            return self._iso(text)
        try:
            time = datetime.strptime(text, form)
        except ValueError:
            raise ValueError(f'a time as {form}') from None
        if time.tzinfo is not None:
            return _nanoseconds(time.astimezone(UTC).replace(tzinfo=None))
        if self._clock.date is None:
            return self._to_utc(_nanoseconds(time))
        return self._to_utc(self._on_its_day(time))

    def _scaled(self, text: str, size: int) -> int:
        number = Decimal(text.replace(self._decimal, '.') if self._decimal != '.' else text)
        return int(number * size)

    def _elapsed(self, text: str) -> int:
        match = _CLOCK_FACE.fullmatch(text)
        if match is None:
            raise ValueError('a time as 12:34:56')
        hours, minutes, seconds, fraction = match.groups()
        whole = int(hours) * 3600 + int(minutes) * 60 + int(seconds)
        return whole * SECOND + int((fraction or '').ljust(9, '0') or 0)

    def _iso(self, text: str) -> int:
        match = _ISO.fullmatch(text)
        if match is None:
            raise ValueError('a time as 2026-08-01T10:38:51Z')
        day = match['day'].replace('-', '')
        try:
            time = datetime.strptime(f'{day}{match["h"]}{match["m"]}{match["s"] or "00"}',
                                     '%Y%m%d%H%M%S')  # fmt: skip
        except ValueError:
            raise ValueError('a time as 2026-08-01T10:38:51Z') from None
        stamp = _nanoseconds(time) + int((match['fraction'] or '').ljust(9, '0'))
        zone = match['zone']
        if zone is None:
            return self._to_utc(stamp)
        if zone == 'Z':
            return stamp
        sign = -1 if zone[0] == '-' else 1
        digits = zone[1:].replace(':', '').ljust(4, '0')
        return stamp - sign * (int(digits[:2]) * 3600 + int(digits[2:]) * 60) * SECOND

    def _on_its_day(self, time: datetime) -> int:
        of_day = _nanoseconds(datetime.combine(_EPOCH, time.time()))
        if self._last_of_day is not None and of_day < self._last_of_day - _HALF_DAY:
            self._day += DAY_NS
        self._last_of_day = of_day
        return self._day + of_day

    def _to_utc(self, local: int) -> int:
        if self._zone is None:
            return local - self._offset
        time = _EPOCH + timedelta(microseconds=local // 1000)
        offsets = {time.replace(tzinfo=self._zone, fold=fold).utcoffset() for fold in (0, 1)}
        if len(offsets) > 1:
            raise ValueError(
                f'a time outside the hour in which clocks of {self._clock.zone} change; use '
                'utc_offset_h instead of zone'
            )
        (offset,) = offsets
        return local - (offset or timedelta()) // timedelta(microseconds=1) * 1000


def _nanoseconds(time: datetime) -> int:
    return (time - _EPOCH) // timedelta(microseconds=1) * 1000
