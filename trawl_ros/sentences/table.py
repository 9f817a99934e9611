# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Table of sentences: a YAML file per system, field by field, with the source of each."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.errors import SentenceError
from trawl_ros.core.quantity import check_unit
from trawl_ros.core.resources import packaged, share_path
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.core.units import UNITS
from trawl_ros.records.fields import (
    FIELDS,
    RANGE_TOPICS,
    Stated,
    StatedTopic,
    WaterColumn,
)

FOLDER = 'sentences'
KINDS = ('text', 'any', 'reading', 'hemisphere', 'time', 'date', 'status', 'keel_offset')

COMMANDS: dict[str, dict[str, str]] = {
    'command/winch': {'port_length': 'length', 'starboard_length': 'length'},
    'command/vessel': {'speed': 'speed', 'turn_to_port': 'rate of turn'},
}
"""Fields of command topics that a sentence can provide."""

READINGS = FIELDS | COMMANDS

_ADDRESS = re.compile(r'(--)?[A-Z0-9]{2,10}( [A-Z]{2})*')


class SentenceField(Record):
    """Field of a sentence; exactly one of `KINDS` says which.

    Attributes
    ----------
    text, also
        Stands there as it is; ``also`` are other spellings that are read.
    any
        Whatever stands there is passed over; this is written.
    reading
        Topic and field, one blank between them, such as ``door/spread distance``.
    unit, scale, decimals, digits, suffix
        Of a reading: its unit; a factor from the project's sign to that of the sentence; digits
        behind the point, and before it with zeros in front; what stands behind the number.
    missing
        Texts that stand for no reading; the first is written.
    hemisphere
        N, S, E or W of ``latitude`` or ``longitude``.
    time, date
        Time of day: ``hhmmss`` and a number of decimals, or with colons. Date: ``ddmmyy``,
        ``yymmdd``, ``dd/mm/yy``, or one of ``dd``, ``mm``, ``yyyy``.
    status, invalid, valid
        ``status`` is written where there is a reading, the first of ``invalid`` where there is
        none. A text in ``invalid`` says that there is no reading; where ``valid`` is given, so
        does every text that is not in it.
    keel_offset
        Height (m) of the transducer above the keel with a minus sign, which is added to the depth.
        A positive one is the transducer's own depth, and is not used. This text is written.
    """

    text: str | None = None
    also: tuple[str, ...] = ()
    any: str | None = None
    reading: str | None = None
    unit: str = ''
    scale: Annotated[float, Field(ge=-1000, le=1000)] = 1.0
    decimals: Annotated[int, Field(ge=0, le=9)] = 0
    digits: Annotated[int, Field(ge=0, le=9)] = 0
    suffix: str = ''
    missing: Annotated[tuple[str, ...], Field(min_length=1)] = ('',)
    hemisphere: Literal['latitude', 'longitude'] | None = None
    time: (
        Literal['hhmmss', 'hhmmss.s', 'hhmmss.ss', 'hhmmss.sss', 'hh:mm:ss', 'hh:mm:ss.sss'] | None
    ) = None
    date: Literal['ddmmyy', 'yymmdd', 'dd/mm/yy', 'dd', 'mm', 'yyyy'] | None = None
    status: str | None = None
    invalid: tuple[str, ...] = ()
    valid: tuple[str, ...] = ()
    keel_offset: str | None = None

    @property
    def kind(self) -> str:
        """Kind of the field, one of `KINDS`."""
        return next(kind for kind in KINDS if getattr(self, kind) is not None)

    @property
    def target(self) -> tuple[str, str]:
        """Topic and field of a reading."""
        topic, _, field = (self.reading or '').partition(' ')
        return topic, field

    @property
    def size(self) -> float:
        """SI value of one unit of a reading, with its sign."""
        return UNITS[self.unit].size / self.scale

    @property
    def step(self) -> float:
        """SI value of one step of the last digit of a reading."""
        minutes = 60.0 if self.unit == 'deg_min' else 1.0
        return float(abs(self.size) * 10.0**-self.decimals / minutes)

    @model_validator(mode='after')
    def _is_one_kind(self) -> 'SentenceField':
        kinds = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(kinds) != 1:
            found = ' and '.join(kinds) or 'nothing'
            raise ValueError(f'found {found}, expected exactly one of {", ".join(KINDS)}')
        if kinds == ['reading']:
            topic, field = self.target
            if topic not in READINGS:
                raise ValueError(
                    f'reading: found topic {topic!r}, expected one of {", ".join(READINGS)}'
                )
            if field not in READINGS[topic]:
                raise ValueError(
                    f'reading: found field {field!r} of {topic}, expected one of '
                    f'{", ".join(READINGS[topic])}'
                )
            check_unit('unit', self.unit, READINGS[topic][field])
            if self.scale == 0.0:
                raise ValueError('scale: found 0, expected another number')
        if kinds == ['status'] and not self.invalid:
            raise ValueError('invalid: missing, expected what says that there is no reading')
        return self


class SentenceRow(Record):
    """Row of the table: one sentence.

    Attributes
    ----------
    start, address
        ``$`` and ``PSCMSM2``; ``--`` in front of an address stands for any two letters, the
        talker, of which ``talker`` is written.
    separator
        Between fields; a blank where texts stand between them.
    checksum
        ``yes``, ``no`` (none is written; one that is there must be right) or ``optional`` (it is
        written; one that is not there is not missed).
    form
        Name of another form in which a system may say the same. It is read and not written, and
        makes samples with sentences of the same form only.
    optional, more
        Number of fields at the end that older forms do not have; true if further ones may follow.
    passed_over
        True for a sentence without a reading for the project, such as a temperature: it is
        known, and no fault.
    least_interval_s, rate_source
        Least time between two of these sentences, for readings between are not sent; and the
        manual that says so.
    source, assumed
        Manual or code that says this; and what none of them says.
    """

    start: Literal['$', '@', '#'] = '$'
    address: str
    talker: Annotated[str, Field(pattern='^[A-Z]{2}$')] = 'II'
    separator: Literal[',', ' '] = ','
    fields: Annotated[tuple[SentenceField, ...], Field(max_length=40)]
    checksum: Literal['yes', 'no', 'optional'] = 'yes'
    form: str = ''
    optional: Annotated[int, Field(ge=0, le=10)] = 0
    more: bool = False
    passed_over: bool = False
    least_interval_s: Annotated[float, Field(ge=0.0, le=3600.0)] = 0.0
    rate_source: str = ''
    source: Annotated[str, Field(min_length=3)]
    assumed: str = ''

    @property
    def topics(self) -> tuple[str, ...]:
        """Topics of its readings, each once."""
        return tuple(dict.fromkeys(field.target[0] for field in self.fields if field.reading))

    @property
    def is_clock(self) -> bool:
        """True if it states date and time and nothing else."""
        return not self.topics and not self.passed_over

    @model_validator(mode='after')
    def _fits_together(self) -> 'SentenceRow':
        if not _ADDRESS.fullmatch(self.address):
            raise ValueError(f'address: found {self.address!r}, expected as PSCMSM2 or --HDT')
        targets = [field.target for field in self.fields if field.reading]
        if len(set(targets)) < len(targets):
            raise ValueError('fields: a reading twice, expected each once')
        if bool(self.rate_source) != (self.least_interval_s > 0.0):
            raise ValueError('rate_source: expected with least_interval_s, and only with it')
        if self.passed_over and targets:
            raise ValueError('passed_over: true, expected no reading')
        if self.is_clock:
            said = {field.kind for field in self.fields}
            if not {'time', 'date'} <= said:
                raise ValueError('fields: no reading, expected one, or date and time')
        return self


class SentenceTable(Record):
    """Table of one system's sentences, as its file has it."""

    system: Annotated[str, Field(pattern='^[a-z][a-z0-9_]*$')]
    title: str
    topics: dict[str, StatedTopic] = Field(default_factory=dict)
    sentences: Annotated[dict[str, SentenceRow], Field(min_length=1, max_length=200)]

    def stated(self, topic: str, water: WaterColumn) -> Stated:
        """Return the noise and limits of a topic, SI; empty if the table states none."""
        return self.topics.get(topic, StatedTopic()).si(topic, water)

    @model_validator(mode='after')
    def _states_limits(self) -> 'SentenceTable':
        told = {topic for row in self.sentences.values() for topic in row.topics}
        for topic in sorted(told & set(RANGE_TOPICS)):
            self.topics.get(topic, StatedTopic()).check(topic)
        for topic, stated in self.topics.items():
            if topic not in told:
                raise ValueError(f'topics.{topic}: no sentence gives it, expected one that does')
            stated.check(topic)
        return self


def packaged_systems() -> list[str]:
    """Names of the systems that come with the package."""
    return sorted(path.stem for path in share_path('config', FOLDER).glob('*.yaml'))


def load_table(path: str | Path) -> SentenceTable:
    """Read the table of a system.

    Parameters
    ----------
    path
        YAML file, or the name of one that comes with the package.

    Raises
    ------
    SentenceError
        If there is none, or it says something impossible; names file, key, found and expected.
    """
    file = packaged(path, FOLDER, SentenceError)
    return validated(SentenceTable, load_yaml(file, SentenceError), file, SentenceError)


def load_tables(paths: Sequence[str | Path]) -> tuple[SentenceTable, ...]:
    """Read several tables; two of one system are refused.

    Raises
    ------
    SentenceError
        As `load_table`, or if a system comes twice.
    """
    tables = tuple(load_table(path) for path in paths)
    names = [table.system for table in tables]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise SentenceError(f'system {twice[0]}: named twice, expected each table once')
    return tables
