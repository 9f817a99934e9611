"""The tables of docs/gear_format.md are drawn from the records that check a gear file.

`python test/gear/test_gear_format.py` draws them again.
"""

import ast
import inspect
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Literal, get_args, get_origin

import pytest
from pydantic.fields import FieldInfo

from trawl_ros.core.schema import Record
from trawl_ros.gear.board_parameters import PARAMETERS_OF_KIND
from trawl_ros.gear.records import GearRecord

DOCUMENT = Path(__file__).parents[2] / 'docs' / 'gear_format.md'
TABLE = re.compile(r'<!-- (keys [\w ]+) -->\n.*?<!-- /\1 -->', re.DOTALL)

PREFIXES = {
    'WarpRecord': 'warp', 'BridleRecord': 'bridle', 'CurrentAt': 'current',
    'TemperatureAt': 'temperature', 'InertiaRecord': 'inertia', 'FasteningRecord': 'fastening',
    'InstallationRecord': 'installation', 'HangingRecord': 'hanging',
}  # fmt: skip
"""Key of a record whose keys are in one table with those of another record."""

DESCRIBED_IN_TEXT = {
    'BoardLawRecord', 'PolarPointRecord', 'TiltPointRecord', 'ProvenanceRecord', 'SourceRecord',
}  # fmt: skip
"""Records without a table. Laws have text and tables of their own; programs write provenances."""

UNBOUNDED = 1e6
"""Upper bounds from here on only keep numbers finite, so they are not shown."""


def records_of(kind: object) -> Iterator[type[Record]]:
    """All records in an annotation."""
    if isinstance(kind, type) and issubclass(kind, Record):
        yield kind
    for part in get_args(kind):
        yield from records_of(part)


def reachable(record: type[Record], found: dict[str, type[Record]]) -> dict[str, type[Record]]:
    """Records of a gear file by name, with those from which they inherit keys."""
    for kind in record.__mro__:
        if kind is not Record and issubclass(kind, Record) and own_keys(kind):
            found[kind.__name__] = kind
        if kind is Record:
            break
    for field in record.model_fields.values():
        for inner in records_of(field.annotation):
            if inner.__name__ not in found:
                reachable(inner, found)
    return found


def own_keys(record: type[Record]) -> list[str]:
    return [key for key in record.model_fields if key in inspect.get_annotations(record)]


def meanings(record: type[Record]) -> dict[str, str]:
    """Docstrings of the keys."""
    body = ast.parse(inspect.getsource(record)).body[0].body
    return {
        line.target.id: ' '.join(text.value.value.split())
        for line, text in pairwise(body)
        if isinstance(line, ast.AnnAssign)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
    }


def default(field: FieldInfo) -> str:
    if field.is_required() or field.default is None or isinstance(field.default, Record):
        return ''
    value = field.default
    if isinstance(value, tuple) or value == {} or value == '':
        return ''
    return str(value).lower() if isinstance(value, bool) else f'{value}'.removesuffix('.0')


def allowed(field: FieldInfo) -> str:
    """Bounds, or the texts that are allowed."""
    texts = [text for kind in (field.annotation, *get_args(field.annotation))
             if get_origin(kind) is Literal for text in get_args(kind)]  # fmt: skip
    if texts:
        return ', '.join(f'`{text}`' for text in texts)
    parts = (part for kind in get_args(field.annotation) for part in metadata(kind))
    bounds = {
        name: value
        for part in (*field.metadata, *parts)
        for name in ('ge', 'gt', 'le', 'lt')
        if (value := getattr(part, name, None)) is not None
    }
    low, high = bounds.get('ge', bounds.get('gt')), bounds.get('le', bounds.get('lt'))
    if low is None and high is None:
        return ''
    above = 'above ' if 'gt' in bounds else ''
    if high is None or high >= UNBOUNDED:
        return f'{above}{low:g}' if above else f'at least {low:g}'
    return f'{above}{low:g} to {"below " if "lt" in bounds else ""}{high:g}'


def metadata(kind: object) -> Iterator[object]:
    """What an annotation within another one says of its numbers."""
    for part in getattr(kind, '__metadata__', ()):
        yield from part.metadata if isinstance(part, FieldInfo) else (part,)


def row(record: type[Record], key: str) -> str:
    field = record.model_fields[key]
    meaning = meanings(record).get(key, '')
    # The meaning says so where another key gives the value.
    needed = field.is_required() and not re.search('default|needed', meaning)
    name = '.'.join([*filter(None, [PREFIXES.get(record.__name__)]), key])
    return f'| `{name}` | {meaning} | {"needed" if needed else default(field)} | {allowed(field)} |'


def table(marker: str) -> str:
    """Draw the keys of the records that a marker names."""
    found = reachable(GearRecord, {})
    rows = [row(found[n], key) for n in marker.split()[1:] for key in own_keys(found[n])]
    head = ['| key | meaning | default | values |', '|---|---|---|---|']
    return '\n'.join([f'<!-- {marker} -->', *head, *rows, f'<!-- /{marker} -->'])


def drawn(text: str) -> str:
    """The document with its tables as they should be."""
    return TABLE.sub(lambda found: table(found[1]), text)


def test_the_tables_are_those_of_the_records():
    text = DOCUMENT.read_text('utf-8')
    assert text == drawn(text), 'python test/gear/test_gear_format.py draws them again'


def test_each_record_of_a_gear_file_has_a_table_or_text():
    markers = TABLE.findall(DOCUMENT.read_text('utf-8'))
    named = {name for marker in markers for name in marker.split()[1:]}
    assert set(reachable(GearRecord, {})) == named | DESCRIBED_IN_TEXT


@pytest.mark.parametrize('record', sorted(reachable(GearRecord, {})))
def test_no_key_is_missing(record):
    kind = reachable(GearRecord, {})[record]
    if record in DESCRIBED_IN_TEXT:
        text = DOCUMENT.read_text('utf-8')
        keys = own_keys(kind) if record in ('BoardLawRecord', 'PolarPointRecord') else []
        assert [key for key in keys if f'`{key}' not in text] == []
    else:
        assert [key for key in own_keys(kind) if not meanings(kind).get(key)] == []


@pytest.mark.parametrize('kind', PARAMETERS_OF_KIND)
def test_no_parameter_of_a_board_law_is_missing(kind):
    text = DOCUMENT.read_text('utf-8')
    assert [name for name in PARAMETERS_OF_KIND[kind].names if f'`{name}`' not in text] == []


if __name__ == '__main__':
    DOCUMENT.write_text(drawn(DOCUMENT.read_text('utf-8')), 'utf-8')
