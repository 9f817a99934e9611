"""Mapping files of CSV logs: column and unit of each reading."""

from pathlib import Path
from typing import Annotated

from pydantic import Field, model_validator

from trawl_ros.bags.logs.clock import Clock
from trawl_ros.bags.logs.layout import LogLayout
from trawl_ros.core.errors import LogError
from trawl_ros.core.quantity import Quantity, check_unit, in_si
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.core.units import UNITS
from trawl_ros.records.fields import FIELDS, RANGE_TOPICS, STD_QUANTITIES, Stated, WaterColumn

_TOGETHER = (
    'door/port/attitude',
    'door/starboard/attitude',
    'vessel/velocity_ground',
    'vessel/fix',
)
"""Topics that make no sense without all of their fields."""


class ColumnMapping(Record):
    """Column of a reading: (cell x scale + offset) in the unit.

    ``hemisphere`` names a column with N, S, E or W for a latitude or longitude. ``missing`` are
    numbers that stand for no reading in this column, beside those of the whole log.
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


class TopicMapping(Record):
    """Mapping of one topic: its readings by field, and the errors its messages state.

    An ``optional`` topic is left out where the log has not all of its columns. ``clock`` is the
    topic's own where its times stand in columns of their own. With ``changes_only`` a reading that
    is the same as in the row before gives no message: many loggers repeat the last one until the
    next comes.
    """

    fields: Annotated[dict[str, ColumnMapping], Field(min_length=1)]
    clock: Clock | None = None
    optional: bool = False
    changes_only: bool = False
    std: Quantity | None = None
    min_range: Quantity | None = None
    max_range: Quantity | None = None

    @property
    def columns(self) -> list[str]:
        """Columns of its readings, and those of hemispheres."""
        fields = self.fields.values()
        return [field.column for field in fields] + [f.hemisphere for f in fields if f.hemisphere]

    def stated(self, topic: str, water: WaterColumn | None) -> Stated:
        """Give noise and limits in SI units; a depth gauge's noise in metres becomes pressure."""
        std = in_si(self.std)
        in_metres = self.std is not None and UNITS[self.std.unit].quantity == 'length'
        if water and in_metres and STD_QUANTITIES.get(topic) == 'pressure':
            std = water.depth_to_difference(std)
        return Stated(std, in_si(self.min_range), in_si(self.max_range))


class LogMapping(Record):
    """Mapping of a whole log.

    ``only`` gives by column the texts of rows that are used; ``missing`` the texts, in lower case,
    that stand for no reading, where ``-999`` also stands for ``-999.00``.
    """

    clock: Clock
    topics: Annotated[dict[str, TopicMapping], Field(min_length=1)]
    layout: LogLayout = LogLayout()
    only: dict[str, tuple[str, ...]] = Field(default_factory=dict)
    water: WaterColumn | None = None
    missing: tuple[str, ...] = ('', 'nan', 'na', 'n/a', 'null')

    def clocks(self) -> list[Clock]:
        """Give all clocks, that of the whole log first."""
        return [self.clock, *(entry.clock for entry in self.topics.values() if entry.clock)]

    def needed(self) -> dict[str, str]:
        """Name the columns that must be there, each with the key that needs it."""
        wanted: dict[str, str] = {}
        for topic, entry in self.topics.items():
            if not entry.optional:
                wanted |= dict.fromkeys(entry.columns, f'topics.{topic}')
        wanted |= dict.fromkeys(self.only, 'only')
        return wanted | {column: 'clock' for clock in self.clocks() for column in clock.columns}

    @model_validator(mode='after')
    def _fits_the_topics(self) -> 'LogMapping':
        for topic, mapping in self.topics.items():
            where = f'topics.{topic}'
            if topic not in FIELDS:
                raise ValueError(f'{where}: unknown topic, expected one of {", ".join(FIELDS)}')
            self._check_fields(where, mapping.fields, FIELDS[topic])
            self._check_std(where, topic, mapping.std)
            self._check_limits(where, mapping, topic in RANGE_TOPICS)
        return self

    def _check_fields(
        self, where: str, fields: dict[str, ColumnMapping], known: dict[str, str]
    ) -> None:
        for field, column in fields.items():
            if field not in known:
                raise ValueError(
                    f'{where}.fields.{field}: unknown field, expected one of {", ".join(known)}'
                )
            check_unit(f'{where}.fields.{field}.unit', column.unit, known[field])
            if column.hemisphere and field not in ('latitude', 'longitude'):
                raise ValueError(
                    f'{where}.fields.{field}.hemisphere: given, expected none: it is no position'
                )
        if known is FIELDS['vessel/velocity_water'] and 'forward' not in fields:
            raise ValueError(f'{where}.fields: to_port alone, expected forward beside it')
        if 'depth' in fields and 'pressure' in fields:
            raise ValueError(f'{where}.fields: both depth and pressure, expected one of them')
        if 'depth' in fields and self.water is None:
            raise ValueError(f'water: missing, expected density_kg_m3 for the depth of {where}')
        paired = where.removeprefix('topics.') in _TOGETHER
        if paired and len(fields) < len(known):
            raise ValueError(f'{where}.fields: {", ".join(fields)}, expected {" and ".join(known)}')

    def _check_limits(self, where: str, mapping: TopicMapping, wanted: bool) -> None:
        limits = {'min_range': mapping.min_range, 'max_range': mapping.max_range}
        for name, limit in limits.items():
            if limit is None and wanted:
                raise ValueError(f'{where}.{name}: missing, expected a length')
            if limit is not None and not wanted:
                raise ValueError(f'{where}.{name}: given, expected none: it measures no distance')
            if limit is not None:
                check_unit(f'{where}.{name}.unit', limit.unit, 'length')
        low, high = limits.values()
        if low and high and not 0 <= low.si() < high.si():
            raise ValueError(
                f'{where}.max_range: found {high.value:g} {high.unit}, '
                f'expected more than min_range ({low.value:g} {low.unit})'
            )

    def _check_std(self, where: str, topic: str, std: Quantity | None) -> None:
        quantity = STD_QUANTITIES.get(topic)
        if std is None:
            return
        if quantity is None:
            raise ValueError(f'{where}.std: given, expected none: its messages cannot state it')
        if std.value <= 0:
            raise ValueError(f'{where}.std.value: found {std.value:g}, expected more than 0')
        # A depth gauge is specified in metres as often as in pascals.
        if quantity == 'pressure' and self.water and UNITS.get(std.unit, ('',))[0] == 'length':
            return
        check_unit(f'{where}.std.unit', std.unit, quantity)


def load_mapping(path: str | Path) -> LogMapping:
    """Read a mapping.

    Raises
    ------
    LogError
        If the file is missing, unreadable, or names topics, fields or units that do not exist.
    """
    file = packaged(path, 'logs', LogError)
    return validated(LogMapping, load_yaml(file, LogError), file, LogError)
