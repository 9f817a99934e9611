# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables of hypotheses: their places in the tree of causes, base rates and sizes, as YAML."""

from functools import cache
from pathlib import Path
from typing import Annotated

from pydantic import Field, model_validator

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.gear.numbers import Positive

TABLES_FOLDER = 'hypotheses'
"""Folder of ``config`` whose files are read."""

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]{0,40}$')]
Place = Annotated[str, Field(pattern=r'^[a-z][a-z /]{0,60}$')]
Key = Annotated[str, Field(pattern=r'^[a-z0-9_]+(\[\d*\])?(\.[a-z0-9_]+(\[\d*\])?)*$')]


class NodeRecord(Record):
    """Place in the tree of causes at which one check on deck finds what is there.

    Attributes
    ----------
    path
        Names from the root, parted by ``/``.
    rate
        Of a hundred examined trials, so many have a cause of this place.
    reason
        Reason for the rate, in words.
    check
        Check on deck, in one sentence.
    """

    path: Place
    rate: Annotated[float, Field(gt=0.0, lt=50.0)]
    reason: str
    check: str


class EntryRecord(Record):
    """Hypothesis: an effect, or a change of the gear file by one size.

    Attributes
    ----------
    name, at
        Name of the hypothesis, and its place in the tree.
    effect, parameters
        Effect with some of its parameters (all if none is given), by default that of the same
        name; not used where ``keys`` are given.
    keys
        Numbers of the gear file that change together; ``[]`` stands for all elements of a list.
    relative, unit
        True if the size is a part of what is changed; else it is added, in this unit.
    usual, low, high
        Common size (a std), and the bounds of what happens.
    larger, smaller
        The change in words, to either side.
    one_sided
        True where it happens to ropes of one side alone too.
    """

    name: Name
    at: Place
    effect: Name | None = None
    parameters: Annotated[tuple[Name, ...], Field(max_length=10)] = ()
    keys: Annotated[tuple[Key, ...], Field(max_length=10)] = ()
    relative: bool = True
    unit: str = ''
    usual: Positive = 1.0
    low: Annotated[float, Field(le=0.0)] = 0.0
    high: Annotated[float, Field(ge=0.0)] = 0.0
    larger: str = ''
    smaller: str = ''
    one_sided: bool = False

    @model_validator(mode='after')
    def _sized(self) -> 'EntryRecord':
        if self.keys and self.low == self.high:
            raise ValueError(f'high: found {self.high:g}, expected more than low')
        if self.keys and self.relative and (self.unit or self.low < -1.0):
            raise ValueError(
                f'low: found {self.low:g} {self.unit}'.rstrip()
                + ', expected a part of -1 or more, without a unit'
            )
        return self

    def words(self, size: float, where: str = '') -> str:
        """Return the change of a size in words, and where it is."""
        # Two digits, and no power of ten for what is more than the whole.
        shown = float(f'{abs(size) * (100.0 if self.relative else 1.0):.2g}')
        told = f'{shown:g} {"%" if self.relative else self.unit}'
        return f'{self.larger if size > 0.0 else self.smaller}{where}, by about {told}'


class TableRecord(Record):
    """Table of hypotheses; its entries may stand at nodes of another table."""

    nodes: Annotated[tuple[NodeRecord, ...], Field(max_length=200)] = ()
    entries: Annotated[tuple[EntryRecord, ...], Field(max_length=500)] = ()


@cache
def hypothesis_table(*more: Path) -> TableRecord:
    """Return all rows of the tables in ``config/hypotheses``, and of ``more`` files.

    Raises
    ------
    TrawlError
        Naming file, key, what was found and what was expected.
    """
    nodes: dict[str, NodeRecord] = {}
    entries: dict[str, EntryRecord] = {}
    for path in (*sorted(share_path('config', TABLES_FOLDER).glob('*.yaml')), *more):
        table = validated(TableRecord, load_yaml(path, TrawlError), path, TrawlError)
        nodes |= {node.path: node for node in table.nodes}
        for number, entry in enumerate(table.entries):
            if entry.name in entries:
                raise TrawlError(
                    f'{path}: entries.{number}.name: found {entry.name} twice, expected each '
                    'name once'
                )
            if entry.at not in nodes:
                raise TrawlError(
                    f'{path}: entries.{number}.at: found {entry.at}, expected the path of a node: '
                    f'{", ".join(nodes)}'
                )
            entries[entry.name] = entry
    return TableRecord(nodes=tuple(nodes.values()), entries=tuple(entries.values()))
