"""Table of the changes of a gear file that happen at sea, from ``config/mimics``."""

from functools import cache
from typing import Annotated

from pydantic import Field, model_validator

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.gear.numbers import Positive

TABLE = 'gear_file'
"""Name of the table that comes with the package."""

Name = Annotated[str, Field(pattern=r'^[a-z][a-z0-9_]{0,40}$')]
Key = Annotated[str, Field(pattern=r'^[a-z0-9_]+(\[\d*\])?(\.[a-z0-9_]+(\[\d*\])?)*$')]


class MimicRecord(Record):
    """A change of a gear file by one size that may be positive or negative.

    Attributes
    ----------
    name
        Of the change.
    keys
        Numbers that change together; ``[]`` stands for all elements of a list, ``[0]`` for one.
    relative
        True if the size is the part by which they grow, False if it is added to them.
    unit
        Of an added size.
    usual
        Common size, a standard deviation.
    low, high
        Sizes that happen at sea.
    larger, smaller
        The change in words, to either side.
    same_as
        Effects of the catalogue that are the same thing.
    one_sided
        True where it happens to ropes of one side alone too.
    """

    name: Name
    keys: Annotated[tuple[Key, ...], Field(min_length=1, max_length=10)]
    relative: bool = True
    unit: str = ''
    usual: Positive
    low: Annotated[float, Field(le=0.0)]
    high: Annotated[float, Field(ge=0.0)]
    larger: str
    smaller: str
    same_as: Annotated[tuple[Name, ...], Field(max_length=10)] = ()
    one_sided: bool = False

    @model_validator(mode='after')
    def _sized(self) -> 'MimicRecord':
        if self.low == self.high:
            raise ValueError(f'high: found {self.high:g}, expected more than low')
        if self.relative and (self.unit or self.low < -1.0):
            raise ValueError(
                f'low: found {self.low:g} {self.unit}'.rstrip()
                + ', expected a part of -1 or more, without a unit'
            )
        return self

    def words(self, size: float, where: str = '') -> str:
        """The change of a size in words, and where it is."""
        # Two digits, and no power of ten for what is more than the whole.
        shown = float(f'{abs(size) * (100.0 if self.relative else 1.0):.2g}')
        told = f'{shown:g} {"%" if self.relative else self.unit}'
        return f'{self.larger if size > 0.0 else self.smaller}{where}, by about {told}'


class MimicTableRecord(Record):
    """Table of changes."""

    changes: Annotated[tuple[MimicRecord, ...], Field(max_length=200)]

    @model_validator(mode='after')
    def _named_once(self) -> 'MimicTableRecord':
        names = [change.name for change in self.changes]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f'changes: found {name} twice, expected each name once')
        return self


@cache
def mimic_table(name: str = TABLE) -> tuple[MimicRecord, ...]:
    """Changes of a table that comes with the package, or of a file.

    Raises
    ------
    TrawlError
        Naming file, key, what was found and what was expected.
    """
    path = packaged(name, 'mimics', TrawlError)
    return validated(MimicTableRecord, load_yaml(path, TrawlError), path, TrawlError).changes
