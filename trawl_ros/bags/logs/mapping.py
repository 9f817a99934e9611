# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Mapping files of logs: column and unit of each reading, or sentences of each topic."""

from collections.abc import Iterator
from datetime import date
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.bags.logs.clock import Clock, ClockReader
from trawl_ros.bags.logs.layout import LogLayout
from trawl_ros.core.errors import LogError
from trawl_ros.core.quantity import Quantity, check_quantity, check_unit
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.core.stamps import DAY_NS
from trawl_ros.core.units import UNITS
from trawl_ros.records.fields import FIELDS, StatedTopic, WaterColumn
from trawl_ros.sentences.fields import YEARS
from trawl_ros.sentences.log import SentenceLogOptions, TopicChoice, ship_kinds
from trawl_ros.sentences.table import load_tables

_TOGETHER = (
    'door/port/attitude',
    'door/starboard/attitude',
    'vessel/velocity_ground',
    'vessel/fix',
)
"""Topics that need all of their fields."""


class ColumnMapping(Record):
    """Column of a reading: (cell x scale + offset) in the unit.

    ``hemisphere`` names a column with N, S, E or W for a latitude or longitude. ``missing`` are
    numbers that mean no reading in this column, in addition to those of the whole log.
    """

    column: str
    unit: str
    scale: float = 1.0
    offset: float = 0.0
    hemisphere: str | None = None
    missing: tuple[float, ...] = ()

    def si(self, cell: float) -> float:
        """Convert the cell into SI units."""
        return (cell * self.scale + self.offset) * UNITS[self.unit].size


class TopicMapping(StatedTopic):
    """Mapping of one topic: its readings by field, and the errors that its messages state.

    An ``optional`` topic is left out if the log lacks one of its columns. ``clock`` is the topic's
    own clock if it has time columns of its own. With ``changes_only`` a reading equal to the one
    before gives no message: many loggers repeat the last reading until the next one arrives.
    """

    fields: Annotated[dict[str, ColumnMapping], Field(min_length=1)]
    clock: Clock | None = None
    optional: bool = False
    changes_only: bool = False

    @property
    def columns(self) -> list[str]:
        """Columns of its readings, and of their hemispheres."""
        fields = self.fields.values()
        return [field.column for field in fields] + [f.hemisphere for f in fields if f.hemisphere]


class LogMapping(Record):
    """Mapping of a whole log.

    ``only`` gives by column the texts of rows that are used. ``missing`` are the texts, in lower
    case, that mean no reading; ``-999`` also stands for ``-999.00``.
    """

    clock: Clock
    topics: Annotated[dict[str, TopicMapping], Field(min_length=1)]
    layout: LogLayout = LogLayout()
    only: dict[str, tuple[str, ...]] = Field(default_factory=dict)
    water: WaterColumn | None = None
    missing: tuple[str, ...] = ('', 'nan', 'na', 'n/a', 'null')

    def clocks(self) -> list[Clock]:
        """Return all clocks, first that of the whole log."""
        return [self.clock, *(entry.clock for entry in self.topics.values() if entry.clock)]

    def needed(self) -> dict[str, str]:
        """Return the required columns, each with the key that needs it."""
        wanted: dict[str, str] = {}
        for topic, entry in self.topics.items():
            if not entry.optional:
                wanted |= dict.fromkeys(entry.columns, f'topics.{topic}')
        wanted |= dict.fromkeys(self.only, 'only')
        return wanted | {column: 'clock' for clock in self.clocks() for column in clock.columns}

    @model_validator(mode='after')
    def _fits_the_topics(self) -> 'LogMapping':
        faults: list[str] = []
        for topic, mapping in self.topics.items():
            faults += self._faults(topic, mapping)
        if faults:
            raise ValueError('\n'.join(faults))
        return self

    def _faults(self, topic: str, mapping: TopicMapping) -> Iterator[str]:
        """Yield all faults of a topic, each a sentence."""
        where, fields, known = f'topics.{topic}', mapping.fields, FIELDS.get(topic)
        if known is None:
            yield f'{where}: unknown topic, expected one of {", ".join(FIELDS)}'
            return
        for field, column in fields.items():
            if field not in known:
                yield f'{where}.fields.{field}: unknown field, expected one of {", ".join(known)}'
                continue
            try:
                check_unit(f'{where}.fields.{field}.unit', column.unit, known[field])
            except ValueError as fault:
                yield str(fault)
            if column.hemisphere and field not in ('latitude', 'longitude'):
                yield f'{where}.fields.{field}.hemisphere: given, expected none: it is no position'
        if topic == 'vessel/velocity_water' and 'forward' not in fields:
            yield f'{where}.fields: found to_port alone, expected forward as well'
        if 'depth' in fields and 'pressure' in fields:
            yield f'{where}.fields: both depth and pressure, expected one of them'
        if 'depth' in fields and self.water is None:
            yield f'water: missing, expected density_kg_m3 for the depth of {where}'
        if topic in _TOGETHER and len(fields) < len(known):
            yield f'{where}.fields: {", ".join(fields)}, expected {" and ".join(known)}'
        try:
            mapping.check(topic, has_water=self.water is not None)
        except ValueError as fault:
            yield str(fault)


class RecorderClock(Clock):
    """Clock of the recorder, which writes a time in front of each sentence."""

    columns: tuple[str, ...] = ('time in front of the sentence',)


class SentenceMapping(Record):
    """Mapping of a log of sentences.

    ``time`` selects the stamps: those in the sentences (the date from RMC or ZDA, or ``date`` for
    the first of them), or those that a recorder put ahead. ``keel_depth`` is the depth of the keel
    below the echo sounder's transducer, if its sentence does not state it. ``topics`` selects among
    the ship's sentences. ``systems`` names tables of sentences of fishing gear, packaged ones or
    files. ``water`` converts their depths to pressures.
    """

    time: Literal['sentences', 'recorder'] = 'sentences'
    recorder: RecorderClock | None = None
    date: str | None = None
    need_checksum: bool = True
    keel_depth: Quantity = Quantity(value=0.0, unit='m')
    topics: Annotated[dict[str, TopicChoice], Field(min_length=1)]
    systems: tuple[str, ...] = ()
    water: WaterColumn = WaterColumn(density_kg_m3=1025.0)

    def options(self, *, leave_out: bool) -> SentenceLogOptions:
        """Return the options of the reader.

        Raises
        ------
        SentenceError
            If a table of a system is missing or wrong.
        """
        first = date.fromisoformat(self.date) if self.date else None
        return SentenceLogOptions(
            choices=self.topics,
            gear=load_tables(self.systems),
            water=self.water,
            keel_depth_m=self.keel_depth.si(),
            need_checksum=self.need_checksum,
            start=None if first is None else (first - date(1970, 1, 1)).days * DAY_NS,
            recorder=ClockReader(self.recorder).read if self.recorder else None,
            leave_out=leave_out,
        )

    @model_validator(mode='after')
    def _fits_the_topics(self) -> 'SentenceMapping':
        if (self.time == 'recorder') != (self.recorder is not None):
            found = (
                'missing, expected its format' if self.recorder is None else 'given, expected none'
            )
            raise ValueError(f'recorder: {found} for time {self.time!r}')
        if self.date is not None and not _is_date(self.date):
            raise ValueError(
                f'date: found {self.date!r}, expected as 2026-08-01, from {YEARS[0]} to {YEARS[-1]}'
            )
        check_quantity('keel_depth', self.keel_depth, 'length')
        kinds = ship_kinds()
        for topic, choice in self.topics.items():
            if topic not in kinds:
                raise ValueError(
                    f'topics.{topic}: unknown topic, expected one of {", ".join(kinds)}'
                )
            if strange := [name for name in choice.sentences if name not in kinds[topic]]:
                raise ValueError(
                    f'topics.{topic}.sentences: found {", ".join(strange)}, expected some of '
                    f'{", ".join(kinds[topic])}'
                )
            choice.check(topic)
        return self


class _SentenceFile(Record):
    nmea: SentenceMapping


def _is_date(text: str) -> bool:
    try:
        return date.fromisoformat(text).year in YEARS
    except ValueError:
        return False


def load_mapping(path: str | Path) -> LogMapping | SentenceMapping:
    """Read a mapping: one of sentences if its only key is ``nmea``, else one of a table.

    Parameters
    ----------
    path
        YAML file, or the name of one that comes with the package.

    Raises
    ------
    LogError
        If the file is missing, unreadable, or names topics, fields, sentences or units that do
        not exist.
    """
    file = packaged(path, 'logs', LogError)
    data = load_yaml(file, LogError)
    if 'nmea' in data:
        return validated(_SentenceFile, data, file, LogError).nmea
    return validated(LogMapping, data, file, LogError)
