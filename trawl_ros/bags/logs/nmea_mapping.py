"""Mapping files of NMEA 0183 logs: sentences of each topic, and source of their times."""

from datetime import date
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.bags.logs.clock import Clock
from trawl_ros.core.errors import LogError
from trawl_ros.core.quantity import Quantity, check_quantity
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.records.fields import RANGE_TOPICS, STD_QUANTITIES, WaterColumn
from trawl_ros.sentences.table import SentenceTable, load_tables
from trawl_ros.sentences.times import DAY

KEY = 'nmea'
"""By which such a mapping is told from one for CSV."""

SENTENCES = {
    'vessel/fix': ('GGA', 'GNS', 'RMC', 'GLL'),
    'vessel/velocity_ground': ('VTG', 'RMC'),
    'vessel/velocity_water': ('VBW', 'VHW'),
    'vessel/heading': ('THS', 'HDT'),
    'vessel/echo_sounder/depth': ('DPT', 'DBT'),
}
"""Kinds of sentences for each topic."""


class RecorderClock(Clock):
    """Clock of the recorder, which writes a time in front of each sentence."""

    columns: tuple[str, ...] = ('time in front of the sentence',)


class NmeaTopic(Record):
    """Mapping of one topic.

    Of ``sentences`` the first one that the log has is used, so that a position that comes in
    three kinds of sentence gives one message. ``talkers`` (such as ``HE`` for a gyro) says who is
    listened to; by default it is the one who says most.
    """

    sentences: Annotated[tuple[str, ...], Field(min_length=1)]
    talkers: tuple[str, ...] | None = None
    std: Quantity | None = None
    min_range: Quantity | None = None
    max_range: Quantity | None = None


class NmeaMapping(Record):
    """Mapping of a whole log.

    ``time`` says whether stamps are those in the sentences (the date from RMC or ZDA, or
    ``date`` for the first of them) or those that a recorder put in front. ``keel_depth`` is how
    far the keel is below the transducer of the echo sounder, where its sentence does not say it.
    ``systems`` names tables of sentences of fishing gear, packaged ones or files; ``water`` makes
    pressures of their depths.
    """

    time: Literal['sentences', 'recorder'] = 'sentences'
    recorder: RecorderClock | None = None
    date: str | None = None
    need_checksum: bool = True
    keel_depth: Quantity = Quantity(value=0.0, unit='m')
    topics: Annotated[dict[str, NmeaTopic], Field(min_length=1)]
    systems: tuple[str, ...] = ()
    water: WaterColumn = WaterColumn(density_kg_m3=1025.0)

    @property
    def start(self) -> int | None:
        """Midnight (ns) before the log begins, where ``date`` says that."""
        if self.date is None:
            return None
        return (date.fromisoformat(self.date) - date(1970, 1, 1)).days * DAY

    def tables(self) -> tuple[SentenceTable, ...]:
        """Load the tables of the systems.

        Raises
        ------
        SentenceError
            If one is missing or wrong.
        """
        return load_tables(self.systems)

    @model_validator(mode='after')
    def _fits_the_topics(self) -> 'NmeaMapping':
        if (self.time == 'recorder') != (self.recorder is not None):
            found = (
                'missing, expected its format' if self.recorder is None else 'given, expected none'
            )
            raise ValueError(f'recorder: {found} for time {self.time!r}')
        if self.date is not None:
            try:
                date.fromisoformat(self.date)
            except ValueError:
                raise ValueError(f'date: found {self.date!r}, expected as 2026-08-01') from None
        check_quantity('keel_depth', self.keel_depth, 'length')
        for topic, entry in self.topics.items():
            where = f'topics.{topic}'
            if topic not in SENTENCES:
                raise ValueError(f'{where}: unknown topic, expected one of {", ".join(SENTENCES)}')
            if strange := [name for name in entry.sentences if name not in SENTENCES[topic]]:
                raise ValueError(
                    f'{where}.sentences: found {", ".join(strange)}, expected some of '
                    f'{", ".join(SENTENCES[topic])}'
                )
            self._check_quantities(where, topic, entry)
        return self

    def _check_quantities(self, where: str, topic: str, entry: NmeaTopic) -> None:
        if entry.std is not None and topic not in STD_QUANTITIES:
            raise ValueError(f'{where}.std: given, expected none: its messages cannot state it')
        if entry.std is not None:
            check_quantity(f'{where}.std', entry.std, STD_QUANTITIES[topic])
        for name, limit in (('min_range', entry.min_range), ('max_range', entry.max_range)):
            if (limit is not None) != (topic in RANGE_TOPICS):
                found = 'missing, expected a length' if limit is None else 'given, expected none'
                raise ValueError(f'{where}.{name}: {found}')
            if limit is not None:
                check_quantity(f'{where}.{name}', limit, 'length')


class _File(Record):
    nmea: NmeaMapping


def is_nmea(path: str | Path) -> bool:
    """True if a mapping is one for NMEA 0183.

    Raises
    ------
    LogError
        If there is no such file, or it is not YAML.
    """
    return KEY in load_yaml(path, LogError)


def load_nmea_mapping(path: str | Path) -> NmeaMapping:
    """Read a mapping.

    Raises
    ------
    LogError
        If the file is missing, unreadable, or names topics or sentences that do not fit.
    """
    data = load_yaml(path, LogError)
    return validated(_File, data, path, LogError).nmea
