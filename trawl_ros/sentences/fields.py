# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Texts of single fields: numbers, positions, times of day and dates."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime

from trawl_ros.core.stamps import DAY_NS
from trawl_ros.core.time import SECOND
from trawl_ros.sentences.table import SentenceField

YEARS = range(1970, 2038)
"""Range of possible years: stamps of messages count seconds in 32 bits."""

NOT_A_NUMBER = 'a field that is not a number'
NOT_A_POSITION = 'a position that is not degrees and minutes'
NOT_A_TIME = 'a field that is not a time'

_NUMBER = re.compile(r'[+-]?(?:\d{1,15}(?:\.\d{0,15})?|\.\d{1,15})')
_TIME = re.compile(r'(\d\d):?(\d\d):?(\d\d)(?:\.(\d{1,9}))?')
_EPOCH = date(1970, 1, 1)
_TURN = 2 * math.pi


def read_number(text: str, field: SentenceField) -> float:
    """Read a number as SI; NaN if the text means that there is no reading.

    Raises
    ------
    ValueError
        If it is no number.
    """
    bare = text.strip()
    if bare in field.missing:
        return math.nan
    if field.suffix:
        if not bare.endswith(field.suffix):
            raise ValueError(f'a field that does not end in {field.suffix!r}')
        bare = bare.removesuffix(field.suffix).strip()
    if not _NUMBER.fullmatch(bare):
        raise ValueError(NOT_A_NUMBER)
    number = float(bare)
    if field.unit == 'deg_min':
        degrees = math.floor(number / 100)
        minutes = number - 100 * degrees
        if number < 0 or minutes >= 60:
            raise ValueError(NOT_A_POSITION)
        number = degrees + minutes / 60
    return number * field.size


def write_number(value: float, field: SentenceField) -> str:
    """Write a reading (SI) in the format of its field, rounded; NaN as the text for no reading.

    Positions are written without sign, which is in the field of the hemisphere.
    """
    if not math.isfinite(value):
        return field.missing[0]
    number = value / field.size
    if field.unit == 'deg_min':
        steps = round(abs(number) * 60 * 10**field.decimals)
        degrees, rest = divmod(steps, 60 * 10**field.decimals)
        minutes = f'{rest / 10**field.decimals:0{field.decimals + 3}.{field.decimals}f}'
        return f'{degrees:0{max(field.digits - 2, 1)}d}{minutes}{field.suffix}'
    text = f'{number:.{field.decimals}f}'
    turn = _TURN / abs(field.size)
    if field.target[1].startswith('compass_') and float(text) >= turn - 1e-9:
        text = f'{float(text) - turn:.{field.decimals}f}'
    if float(text) == 0.0:
        text = text.removeprefix('-')
    if field.digits:
        whole, point, decimals = text.lstrip('-').partition('.')
        text = '-' * text.startswith('-') + whole.zfill(field.digits) + point + decimals
    return text + field.suffix


@dataclass(frozen=True)
class SaidTime:
    """Time of a sentence: ns since midnight, and the day if the sentence states it."""

    of_day: int
    day: date | None = None

    def stamp(self, near: int | None) -> int | None:
        """Return the stamp (ns) on the stated day, else on that nearest to ``near``."""
        if self.day is not None:
            return (self.day - _EPOCH).days * DAY_NS + self.of_day
        if near is None:
            return None
        around = near - near % DAY_NS + self.of_day
        return min((around - DAY_NS, around, around + DAY_NS), key=lambda stamp: abs(stamp - near))


def read_time(text: str) -> int:
    """Read a time of day, ns.

    Raises
    ------
    ValueError
        If it is none.
    """
    match = _TIME.fullmatch(text.strip())
    if match is None:
        raise ValueError(NOT_A_TIME)
    hours, minutes, seconds = (int(match[number]) for number in (1, 2, 3))
    if hours > 23 or minutes > 59 or seconds > 60:
        raise ValueError(NOT_A_TIME)
    return (hours * 3600 + minutes * 60 + seconds) * SECOND + int((match[4] or '').ljust(9, '0'))


def read_day(parts: Sequence[tuple[str, str]]) -> date | None:
    """Read a date from fields, each as (format, text); None if all are empty.

    Raises
    ------
    ValueError
        If it is none.
    """
    if not any(text.strip() for _, text in parts):
        return None
    numbers: dict[str, int] = {}
    for form, text in parts:
        bare = text.strip()
        if len(bare) != len(form):
            raise ValueError(NOT_A_TIME)
        for sign in ('yyyy', 'yy', 'mm', 'dd'):
            at = form.find(sign)
            if at >= 0 and sign[0] not in numbers:
                numbers[sign[0]] = int(bare[at : at + len(sign)])
                if sign == 'yy':
                    # As POSIX has it: 69 and above belong to the last century.
                    numbers['y'] += 1900 if numbers['y'] >= 69 else 2000
    year = numbers['y']
    if year not in YEARS:
        raise ValueError('an impossible year')
    try:
        return date(year, numbers['m'], numbers['d'])
    except ValueError:
        raise ValueError(NOT_A_TIME) from None


def write_time(stamp: int, field: SentenceField) -> str:
    """Write the time of day or the date of a stamp (ns) in the format of a field, truncated."""
    form: str = field.time or field.date or ''
    decimals = len(form.partition('.')[2])
    step = SECOND // 10**decimals
    stamp -= stamp % step
    when = datetime.fromtimestamp(stamp // SECOND, UTC)
    if field.date:
        for sign, code in (('yyyy', '%Y'), ('yy', '%y'), ('mm', '%m'), ('dd', '%d')):
            form = form.replace(sign, when.strftime(code))
        return form
    text = when.strftime('%H:%M:%S' if ':' in form else '%H%M%S')
    return f'{text}.{stamp % SECOND // step:0{decimals}d}' if decimals else text
