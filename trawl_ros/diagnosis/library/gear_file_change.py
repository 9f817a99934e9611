# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Effect that changes numbers at keys of a gear file and builds the gear again."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath

import numpy as np
from pydantic import BaseModel

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.library.table import EntryRecord, hypothesis_table
from trawl_ros.effects.base.effect import Effect, Parameter, Situation
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.line import BarProperties

KEPT = 4
"""So many sizes are kept built: a derivative takes two, at all windows."""

SIDES = ('port', 'starboard')

Path = Sequence[str | int | None]
"""Names of keys and places in lists, None for all of a list."""


@dataclass(frozen=True, kw_only=True)
class GearFileChange(Effect):
    """Change of a gear file by one size.

    It builds the whole gear, so that it must be the first effect of those that act.

    Attributes
    ----------
    record
        The change.
    believed
        Gear file that is changed.
    side
        0 for ropes of the port side alone, 1 for those of starboard; None for both.
    both
        The change on both sides, whose gears one on a side is made of.
    """

    record: EntryRecord
    believed: GearRecord
    side: int | None = None
    both: 'GearFileChange | None' = field(default=None, repr=False, compare=False)
    _built: dict[float, GearModel] = field(default_factory=dict, repr=False, compare=False)

    def words(self, size: float) -> str:
        """The change of a size in words."""
        return self.record.words(
            size, '' if self.side is None else f' on the {SIDES[self.side]} side'
        )

    def gear(self, values: FloatArray, model: GearModel, at: Situation) -> GearModel:
        """Gear model of the changed file, with the coefficients of this one."""
        size = float(values[0])
        if size == 0.0:
            return model
        if size not in self._built:
            while len(self._built) >= KEPT:
                self._built.pop(next(iter(self._built)))
            if self.side is None or self.both is None:
                built = build_model(changed(self.believed, self.record, size))
            else:
                built = _on_side(self.side, self.both.gear(values, model, at), model)
            self._built[size] = built
        return self._built[size].with_coefficients(model.coefficients)


def _on_side(side: int, changed_gear: GearModel, believed: GearModel) -> GearModel:
    """Gear with the ropes of one side from a changed one, all else as it is believed."""
    on = np.zeros(len(believed.ends), dtype=bool)
    for name, _, bars in believed.layout.lines:
        on[bars] |= name.startswith(f'{SIDES[side]}_')
    columns = zip(changed_gear.bars.columns, believed.bars.columns, strict=True)
    return replace(
        believed,
        bars=BarProperties(*(np.where(on, new, old) for new, old in columns)),
        rest=np.where(on, changed_gear.rest, believed.rest),
    )


def changes_of(gear: GearRecord, *more: FilePath) -> Iterator[GearFileChange]:
    """Yield all changes of the tables that change anything in this gear file, and on each side."""
    for record in hypothesis_table(*more).entries:
        if not record.keys or changed(gear, record, 0.5 * (record.high or record.low)) == gear:
            continue
        both = _change(gear, record, None)
        yield both
        if record.one_sided:
            for side in range(len(SIDES)):
                yield replace(_change(gear, record, side), both=both)


def _change(gear: GearRecord, record: EntryRecord, side: int | None) -> GearFileChange:
    one = '' if side is None else f'{SIDES[side]}_'
    where = '' if side is None else f', on the {SIDES[side]} side'
    return GearFileChange(
        name=f'{one}{record.name}',
        sentence=f'{record.larger.capitalize()} than the gear file has{where}.',
        parameters=(Parameter('change', record.unit, 0.0, record.low, record.high, record.usual),),
        excited_by='any tow, compared with a baseline',
        record=record,
        believed=gear,
        side=side,
    )


def changed(gear: GearRecord, record: EntryRecord, size: float) -> GearRecord:
    """Gear file with a change of a size; itself where it has none of the keys."""

    def change(value: float) -> float:
        return value * (1.0 + size) if record.relative else value + size

    for key in record.keys:
        new = _changed(gear, _path(key), change)
        assert isinstance(new, GearRecord)
        gear = new
    return gear


def _path(key: str) -> Path:
    path: list[str | int | None] = []
    for name, _, place in re.findall(r'([a-z0-9_]+)(\[(\d*)\])?', key):
        path.append(name)
        if f'{name}[' in key:
            path.append(int(place) if place else None)
    return path


def _changed(value: object, path: Path, change: Callable[[float], float]) -> object:
    """Value with the numbers at a path changed; what is missing stays so."""
    if not path:
        return change(value) if isinstance(value, float) else value
    first, rest = path[0], path[1:]
    if isinstance(value, BaseModel) and isinstance(first, str):
        own = getattr(value, first)
        new = _changed(own, rest, change)
        return value if new is own else value.model_copy(update={first: new})
    if isinstance(value, tuple) and not isinstance(first, str):
        return tuple(
            _changed(own, rest, change) if first in (None, place) else own
            for place, own in enumerate(value)
        )
    return value
