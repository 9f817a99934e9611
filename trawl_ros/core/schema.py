# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records from YAML files, with strict checks.

Gear, scenario and instrument files all use it, so they refuse the same mistakes in the same words.
Every error names the file, the key, what was found and what was expected.
"""

import math
import re
from collections.abc import Hashable
from pathlib import Path
from typing import Annotated, NoReturn, TypeVar

import yaml
from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.foreign import one_line, read_whole, reading
from trawl_ros.core.limits import DIAGNOSIS, YAML_BYTES, YAML_DEPTH, YAML_NUMBER, YAML_VALUES
from trawl_ros.core.validation_messages import shown, validation_messages

MAX_COMPLAINTS = 10


class Record(BaseModel):
    """Record from a file.

    It is immutable, and refuses unknown keys, NaN, infinity and values of another type: neither
    ``true`` nor ``'3'`` is a number. Sequences are tuples.
    """

    model_config = ConfigDict(frozen=True, extra='forbid', strict=True, allow_inf_nan=False)


class FrozenDict(dict[str, float]):
    """Immutable numbers by name, so that a record with them can be hashed."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))

    def __reduce__(self) -> tuple[type['FrozenDict'], tuple[dict[str, float]]]:
        return FrozenDict, (dict(self),)

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError(f'found a change of {shown(dict(self))}, expected none: it is frozen')

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse


Numbers = Annotated[dict[str, float], AfterValidator(FrozenDict)]
"""Numbers by name, in a `Record`."""

RecordT = TypeVar('RecordT', bound=BaseModel)


def load_yaml(path: str | Path, error: type[TrawlError]) -> dict[str, object]:
    """Read a YAML file whose top level is a mapping.

    Parameters
    ----------
    path
        File of at most 1 MB in UTF-8.
    error
        Class of the error to raise.

    Returns
    -------
    dict
        Keys are text. Scalars follow YAML 1.2, so ``1e5`` is a number, ``no`` and ``12:30``
        are text.

    Raises
    ------
    TrawlError
        Of class ``error``: the file is missing, unreadable, too large, not YAML or not a
        mapping; a key occurs twice or is not text; an alias or a tag is used.
    """
    raw = read_whole(Path(path), YAML_BYTES, error, 'a smaller YAML file')
    with reading(path, error):
        try:
            data = yaml.load(raw.decode('utf-8'), _Loader)
        except UnicodeDecodeError as reason:
            raise error(
                f'{path}: byte {reason.start} is not UTF-8, expected a text file'
            ) from reason
        except yaml.YAMLError as reason:
            raise error(f'{path}: {_yaml_complaint(reason)}') from reason
    if data is None:
        raise error(f'{path}: found no keys and values, expected {error.expected}')
    if not isinstance(data, dict):
        raise error(f'{path}: found {shown(data)}, expected keys and values at the top level')
    return data


def validated(
    cls: type[RecordT],
    data: object,
    path: str | Path,
    error: type[TrawlError],
    *,
    prefix: str = '',
) -> RecordT:
    """Convert the content of a file to a record.

    Parameters
    ----------
    cls
        Class of the record, usually a `Record`.
    data
        Result of `load_yaml`, or a part of it. Lists become tuples.
    path
        Path for the error.
    error
        Class of the error to raise.
    prefix
        Key of ``data`` in the file (``'instruments'``), put before each key.

    Raises
    ------
    TrawlError
        Of class ``error``, one line per fault, each with file, key, found and expected.
    """
    data = _with_tuples(data)
    try:
        return cls.model_validate(data)
    except ValidationError as reason:
        found = validation_messages(cls, data, reason.errors(include_url=False), prefix)
        # A check of a whole record can find several faults, one on each line.
        lines = [line for message in found for line in message.splitlines()]
        more = len(lines) - MAX_COMPLAINTS
        # A line may contain a whole value of the file.
        messages = [f'{path}: {one_line(line, DIAGNOSIS.value)}' for line in lines[:MAX_COMPLAINTS]]
        if more > 0:
            messages.append(f'{path}: and {more} more like these')
        raise error('\n'.join(messages)) from reason


CONTROL = re.compile('[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]')
"""Control characters of a terminal or of the text direction, and single surrogates."""


class _Loader(yaml.SafeLoader):
    """SafeLoader with YAML 1.2 scalars and limits, without aliases, tags and double keys."""

    _depth = 0
    _values = 0

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event = self.peek_event()  # type: ignore[no-untyped-call]  # PyYAML's stubs say nothing
        mark = event.start_mark
        if isinstance(event, yaml.AliasEvent):
            # A few lines of aliases can stand for billions of values.
            self._refuse(mark, 'an alias (*), expected the value itself')
        if getattr(event, 'tag', None) is not None:
            # `!!int abc` would make constructors fail in unexpected ways.
            self._refuse(mark, f'a tag ({event.tag}), expected the value itself')
        if isinstance(event, yaml.ScalarEvent) and CONTROL.search(event.value):
            self._refuse(mark, 'a control character or half a character, expected text')
        self._depth += 1
        self._values += 1
        if self._depth > YAML_DEPTH.value:
            self._refuse(mark, f'nesting, expected {YAML_DEPTH} at most')
        if self._values > YAML_VALUES.value:
            self._refuse(mark, f'one more value, expected {YAML_VALUES} at most')
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_mapping(
        self, node: yaml.MappingNode, deep: bool = False
    ) -> dict[Hashable, object]:
        seen: dict[str, int] = {}
        for key_node, _ in node.value:
            if key_node.tag != 'tag:yaml.org,2002:str':
                self._refuse(key_node.start_mark, 'a key that is not text, expected a name')
            line = key_node.start_mark.line + 1
            if key_node.value in seen:
                first = seen[key_node.value]
                again = f"key '{key_node.value}' again (first on line {first})"
                self._refuse(key_node.start_mark, f'{again}, expected each key once')
            seen[key_node.value] = line
        return super().construct_mapping(node, deep)

    def construct_yaml_float(self, node: yaml.ScalarNode) -> float:
        value = super().construct_yaml_float(node)
        if YAML_NUMBER.value < abs(value) < math.inf:
            # Its powers and products would overflow.
            found = f'{node.value}, expected a number of magnitude {YAML_NUMBER.value:.0e} at most'
            self._refuse(node.start_mark, found)
        return value

    def _refuse(self, mark: yaml.error.Mark | None, found: str) -> NoReturn:
        raise yaml.constructor.ConstructorError(None, None, f'found {found}', mark)


# Own table, because YAML 1.1 reads 1e5 as text, 12:30 as 750 and `no` as false.
_Loader.yaml_implicit_resolvers = {}
for _tag, _pattern, _first in (
    ('bool', r'^(?:true|True|TRUE|false|False|FALSE)$', 'tTfF'),
    ('null', r'^(?:~|null|Null|NULL|)$', ['~', 'n', 'N', '']),
    ('int', r'^[-+]?[0-9]{1,18}$', '-+0123456789'),
    (
        'float',
        r'^(?:[-+]?(?:(?:\.\d+|\d+\.?\d*)(?:[eE][-+]?\d+)?|\.(?:inf|Inf|INF))|\.(?:nan|NaN|NAN))$',
        '-+.0123456789',
    ),
):
    _Loader.add_implicit_resolver(
        f'tag:yaml.org,2002:{_tag}', re.compile(_pattern, re.ASCII), list(_first)
    )
# SafeLoader would read 010 as eight.
_Loader.add_constructor('tag:yaml.org,2002:int', lambda _, node: int(node.value))
_Loader.add_constructor('tag:yaml.org,2002:float', _Loader.construct_yaml_float)


def _yaml_complaint(reason: yaml.YAMLError) -> str:
    mark = getattr(reason, 'problem_mark', None)
    problem = getattr(reason, 'problem', None) or getattr(reason, 'reason', None) or 'not YAML'
    where = f'line {mark.line + 1}, column {mark.column + 1}: ' if mark else ''
    return f'{where}{problem}' + ('' if 'expected' in problem else ', expected plain YAML')


def _with_tuples(data: object) -> object:
    if isinstance(data, dict):
        return {key: _with_tuples(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return tuple(_with_tuples(value) for value in data)
    return data
