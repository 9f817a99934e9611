# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Codec of single sentences: from a frame to readings, and from readings to a sentence."""

import math
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from trawl_ros.sentences.fields import (
    SaidTime,
    read_day,
    read_number,
    read_time,
    write_number,
    write_time,
)
from trawl_ros.sentences.framing import Foreign, Frame, Unreadable, framed
from trawl_ros.sentences.table import SentenceField, SentenceRow, SentenceTable

Readings = Mapping[tuple[str, str], float]
"""SI values by topic and field; NaN if a sentence states that there is no reading."""

KEEL_DEPTH = ('vessel/echo_sounder/depth', 'distance')
"""Reading that the sentence gives from the transducer, and the sample from the keel."""


@dataclass(frozen=True)
class Spoken:
    """Sentence that was understood.

    Attributes
    ----------
    system, name
        Table and row.
    talker
        First letters of its address, where the row leaves them open.
    readings
        SI values by topic and field; NaN is no reading.
    time
        Time that it says; None without one.
    valid
        False if its status says that it has no reading.
    """

    system: str
    name: str
    talker: str
    readings: Readings
    time: SaidTime | None
    valid: bool = True

    def of_topic(self, topic: str) -> dict[str, float]:
        """Readings of one topic by field."""
        return {name: value for (told, name), value in self.readings.items() if told == topic}

    @property
    def topics(self) -> tuple[str, ...]:
        """Topics of its readings, each once."""
        return tuple(dict.fromkeys(topic for topic, _ in self.readings))

    def restricted(self, topics: Collection[str]) -> 'Spoken':
        """Return the sentence with the readings of these topics only."""
        return replace(
            self, readings={key: value for key, value in self.readings.items() if key[0] in topics}
        )


class SentenceReader:
    """Reader of sentences by tables.

    Parameters
    ----------
    tables
        Systems that are understood.
    keel_depth_m
        Height of the echo sounder's transducer above the keel, where its sentence does not say it.
    """

    def __init__(self, tables: Sequence[SentenceTable], *, keel_depth_m: float = 0.0) -> None:
        self._keel_depth_m = keel_depth_m
        self.rows = {
            (table.system, name): row for table in tables for name, row in table.sentences.items()
        }
        self._by_address: dict[str, list[tuple[str, str]]] = defaultdict(list)
        for key, row in self.rows.items():
            self._by_address[row.start + row.address].append(key)

    def knows(self, frame: Frame) -> bool:
        """True if a table has sentences of this address."""
        return bool(self._candidates(frame))

    def read(self, frame: Frame) -> Spoken:
        """Read a sentence.

        Raises
        ------
        Foreign
            If no table has its address.
        Unreadable
            If no row fits; the reason names the sentence, and the field that comes nearest.
        """
        found = self._candidates(frame)
        if not found:
            raise Foreign(f'sentence {_name(frame)}, which is in no table')
        best, reason = -1, ''
        for (system, name), address in found:
            row = self.rows[system, name]
            texts = frame.body[len(address) :].removeprefix(row.separator).split(row.separator)
            try:
                if row.checksum == 'yes' and not frame.checked:
                    raise _Misfit(99, 'no checksum')
                readings, time, valid = _read_fields(row, texts, self._keel_depth_m)
            except _Misfit as misfit:
                if misfit.fields > best:
                    best, reason = misfit.fields, str(misfit)
                continue
            talker = address[:2] if row.address.startswith('--') else ''
            return Spoken(system, name, talker, readings, time, valid)
        raise Unreadable(f'sentence {_name(frame)}: {reason}')

    def _candidates(self, frame: Frame) -> list[tuple[tuple[str, str], str]]:
        """Return the rows of an address, each with the body text that stands for the address."""
        address = frame.body.partition(',')[0]
        if frame.start == '#':
            # Its address has blanks, as have its fields.
            return [
                (key, frame.body[: len(frame.body) - len(rest)])
                for start, keys in self._by_address.items()
                if start[0] == '#' and (rest := _after(frame.body, start[1:])) is not None
                for key in keys
            ]
        keys = [*self._by_address.get(frame.start + address, ())]
        keys += self._by_address.get(f'{frame.start}--{address[2:]}', ()) if address[2:] else ()
        return [(key, address) for key in keys]


def write_sentence(row: SentenceRow, readings: Readings, stamp: int) -> str | None:
    """Write a sentence, without its end.

    Parameters
    ----------
    row
        Of the table.
    readings
        SI values by topic and field; what is not there is missing.
    stamp
        Time of the readings, ns.

    Returns
    -------
    str or None
        None if it would hold no reading; where there is a status for that, it is written.
    """
    values = [readings.get(field.target, math.nan) for field in row.fields if field.reading]
    silent = bool(values) and not any(map(math.isfinite, values))
    if silent and not any(field.status is not None for field in row.fields):
        return None
    texts = [_write_field(field, readings, stamp, silent) for field in row.fields]
    address = row.address.replace('--', row.talker)
    body = row.separator.join([address, *texts])
    return framed(row.start, body, checksum=row.checksum != 'no')


class _Misfit(ValueError):
    """Row that does not fit, with the number of fields that did."""

    def __init__(self, fields: int, reason: str) -> None:
        super().__init__(reason)
        self.fields = fields


def _read_fields(
    row: SentenceRow, texts: Sequence[str], keel_depth_m: float
) -> tuple[dict[tuple[str, str], float], SaidTime | None, bool]:
    if row.separator == ' ':
        texts = [text for text in texts if text]
    wanted = len(row.fields)
    if len(texts) < wanted - row.optional or (len(texts) > wanted and not row.more):
        raise _Misfit(0, f'{len(texts)} fields, expected {wanted}')
    readings: dict[tuple[str, str], float] = {}
    signs: dict[str, float] = {}
    of_day: int | None = None
    dates: list[tuple[str, str]] = []
    valid = True
    for number, (field, raw) in enumerate(zip(row.fields, texts, strict=False)):
        text = raw.strip()
        try:
            if field.text is not None and text not in (field.text, *field.also):
                raise ValueError(f'field {number + 1} is {text[:8]!r}, expected {field.text!r}')
            if field.reading is not None:
                readings[field.target] = read_number(text, field)
            elif field.hemisphere is not None:
                signs[field.hemisphere] = _sign(text, field.hemisphere)
            elif field.time is not None:
                of_day = read_time(text) if text else None
            elif field.date is not None:
                dates.append((field.date, text))
            elif field.keel_offset is not None:
                keel_depth_m = _keel_depth(text, keel_depth_m)
            elif field.status is not None:
                valid &= text not in field.invalid and (not field.valid or text in field.valid)
        except ValueError as reason:
            raise _Misfit(number, str(reason)) from None
    try:
        day = read_day(dates)
    except ValueError as reason:
        raise _Misfit(wanted, str(reason)) from None
    for (topic, name), value in readings.items():
        sign = signs.get(name, 1.0) if topic == 'vessel/fix' else 1.0
        readings[topic, name] = sign * value if valid else math.nan
    course = readings.get(('vessel/velocity_ground', 'compass_course'), 0.0)
    if math.isnan(course) and readings.get(('vessel/velocity_ground', 'speed')) == 0.0:
        # A receiver that stands still gives no course.
        readings['vessel/velocity_ground', 'compass_course'] = 0.0
    if KEEL_DEPTH in readings:
        readings[KEEL_DEPTH] -= keel_depth_m
    return readings, None if of_day is None else SaidTime(of_day, day), valid


def _write_field(field: SentenceField, readings: Readings, stamp: int, silent: bool) -> str:
    if field.text is not None:
        return field.text
    if field.any is not None:
        return field.any
    if field.keel_offset is not None:
        return field.keel_offset
    if field.reading is not None:
        return write_number(readings.get(field.target, math.nan), field)
    if field.hemisphere is not None:
        value = readings.get(('vessel/fix', field.hemisphere), math.nan)
        if math.isnan(value):
            return ''
        return ('SN' if field.hemisphere == 'latitude' else 'WE')[value >= 0.0]
    if field.status is not None:
        return field.invalid[0] if silent else field.status
    return write_time(stamp, field)


def _keel_depth(text: str, otherwise: float) -> float:
    """Height (m) of the transducer above the keel by the offset of a depth."""
    if not text:
        return otherwise
    offset = read_number(text, SentenceField(reading=' '.join(KEEL_DEPTH), unit='m'))
    return -offset if offset < 0.0 else otherwise


def _after(body: str, address: str) -> str | None:
    """Return the text behind an address, which may follow blanks; None for another address."""
    bare = body.lstrip()
    return bare[len(address) :] if bare.startswith(f'{address} ') else None


def _sign(text: str, which: str) -> float:
    letters = {'N': 1.0, 'S': -1.0} if which == 'latitude' else {'E': 1.0, 'W': -1.0}
    if text and text not in letters:
        raise ValueError('a hemisphere other than N, S, E or W')
    return letters.get(text, math.nan)


def _name(frame: Frame) -> str:
    """Return the name of a sentence for a reason, without parts that differ between sentences."""
    address = frame.body.partition(',')[0] if frame.start != '#' else frame.body[:5]
    return frame.start + ''.join(sign if sign.isalnum() or sign == ' ' else '?'
                                 for sign in address[:10])  # fmt: skip
