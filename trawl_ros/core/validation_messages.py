# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Validation messages: one sentence for each fault of a record.

Pydantic describes faults in terms of Python. These messages use the terms of the file: its key,
what was found, what was expected, and the unit.
"""

import difflib
import math
import re
import types
from typing import Annotated, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from trawl_ros.core.units import UNITS

KEY_UNITS = {
    **{
        symbol.lower().replace('/', '_'): UNITS[symbol].name
        for symbol in ('m', 'mm', 'N', 'kN', 'Pa', 'kPa', 'deg', 'rad', 'deg/s', 'rad/s', 'm/s')
    },
    'm2': 'square metres',
    'm3': 'cubic metres',
    'per_m3': 'per cubic metre',
    'm4': 'metres to the fourth power',
    'kg': 'kilograms',
    't': 'tonnes',
    'gpa': 'gigapascals',
    's': 'seconds',
    'min': 'minutes',
    'minutes': 'minutes',
    'hz': 'hertz',
    'khz': 'kilohertz',
    'db': 'decibels',
    'm_s2': 'metres per second squared',
    'kg_m': 'kilograms per metre',
    'kg_m2': 'kilogram square metres',
    'kg_m3': 'kilograms per cubic metre',
    'kg_m4': 'kilograms per cubic metre and metre',
    'n_m': 'newton metres',
    'n_m2': 'newtons per square metre',
}
"""Names of units by the last words of a key."""


def key_unit(key: str) -> str | None:
    """Return the unit named by the end of a key: ``'length_m'`` gives ``'metres'``."""
    words = key.split('_')
    for start in range(1, len(words)):
        unit = KEY_UNITS.get('_'.join(words[start:]))
        if unit is not None:
            return unit
    return 'minutes' if key == 'minutes' else None


_OWN_KEY = re.compile(r'[\w.\[\]]+: ')
_SCALARS = {
    'float_type': 'a number',
    'int_type': 'a whole number',
    'int_from_float': 'a whole number',
    'string_type': 'text',
    'bool_type': 'true or false',
}


def _is_consequence(detail: ErrorDetails, errors: list[ErrorDetails]) -> bool:
    """Return True for a list that is too short only because of wrong entries."""
    place = detail['loc']
    return detail['type'] == 'too_short' and any(
        len(other['loc']) > len(place) and other['loc'][: len(place)] == place for other in errors
    )


def validation_messages(
    cls: type[BaseModel], data: object, errors: list[ErrorDetails], prefix: str = ''
) -> list[str]:
    """Return the validation messages of a record, unknown keys first.

    Parameters
    ----------
    cls
        Class of the expected record.
    data
        Content of the file; mappings and tuples.
    errors
        Errors of pydantic.
    prefix
        Key of ``data`` in the file, put before each key.

    Returns
    -------
    list of str
        One sentence per key. A missing key is left out if a similar unknown key was found.
    """
    lines: list[str] = []
    explained: set[str] = set()
    errors = [detail for detail in errors if not _is_consequence(detail, errors)]
    for detail in errors:
        if detail['type'] == 'extra_forbidden':
            line, meant = _unknown_key(cls, data, detail['loc'], prefix)
            lines.append(line)
            explained.add(meant)
    wanted: dict[str, tuple[str, list[str], str]] = {}
    for detail in errors:
        loc, kind = detail['loc'], detail['type']
        key = _key(data, loc, prefix)
        if kind == 'extra_forbidden' or (kind == 'missing' and key in explained):
            continue
        if kind == 'value_error':
            message = detail['msg'].removeprefix('Value error, ')
            # The message of a record's own check begins with the key below the record.
            own = not key or _OWN_KEY.match(message)
            lines.append(_join(key, message) if own else f'{key}: {message}')
        elif not _other_branch(detail, errors):
            found = 'missing' if kind == 'missing' else f'found {shown(detail["input"])}'
            unit = key_unit(next((s for s in reversed(loc) if isinstance(s, str)), ''))
            entry = wanted.setdefault(key, (found, [], f' ({unit})' if unit else ''))
            entry[1].append(_expected(detail, _annotation(cls, loc)))
    for key, (found, expected, hint) in wanted.items():
        start = f'{key}: ' if key else ''
        lines.append(f'{start}{found}, expected {" or ".join(dict.fromkeys(expected))}{hint}')
    return lines


def shown(value: object) -> str:
    """Format a value as in a file, shortened to 60 characters."""
    if isinstance(value, bool | None):
        return {True: 'true', False: 'false', None: 'nothing'}[value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    text = repr(list(value) if isinstance(value, tuple) else value)
    return text if len(text) <= 60 else f'{text[:57]}...'


def _unknown_key(
    cls: type[BaseModel], data: object, loc: tuple[int | str, ...], prefix: str
) -> tuple[str, str]:
    """Return the message on an unknown key, and the key that was probably meant, or ''."""
    unknown = str(loc[-1])
    key = _key(data, loc, prefix)
    owners = _records(_annotation(cls, loc[:-1]))
    known = list(owners[0].model_fields) if owners else []
    closest = _closest(unknown, known)
    if closest is None:
        return f'{key}: unknown key, expected {_any_of(known)}', ''
    meant = key.removesuffix(unknown) + closest
    unit = key_unit(closest)
    return f'{key}: unknown key; did you mean {meant}{f" ({unit})" if unit else ""}?', meant


def _other_branch(detail: ErrorDetails, errors: list[ErrorDetails]) -> bool:
    """Return True if a section is refused as text or number only because of a union."""
    loc = detail['loc']
    return (
        isinstance(detail['input'], dict)
        and detail['type'] in _SCALARS
        and any(e['loc'][: len(loc) - 1] == loc[:-1] and len(e['loc']) > len(loc) for e in errors)
    )


def _key(data: object, loc: tuple[int | str, ...], prefix: str) -> str:
    """Format a location as the key of the file, without the branches of unions."""
    text = prefix
    for number, step in enumerate(loc):
        if isinstance(step, int) and isinstance(data, tuple):
            text, data = f'{text}[{step}]', data[step] if step < len(data) else None
        elif isinstance(data, dict) and step in data:
            text, data = _join(text, str(step)), data[step]
        elif isinstance(data, dict) and number == len(loc) - 1:
            text = _join(text, str(step))
    return text


def _join(where: str, key: str) -> str:
    return f'{where}.{key}' if where else key


def _annotation(cls: object, loc: tuple[int | str, ...]) -> object:
    """Follow a location through the record's annotations; None if it leads nowhere."""
    here = cls
    for step in loc:
        records = [r for r in _records(here) if isinstance(step, str) and step in r.model_fields]
        if records:
            here = records[0].model_fields[str(step)]
            continue
        if isinstance(step, str) and any(r.__name__ == step for r in _records(here)):
            continue
        inner = _inside(here, step)
        if inner is None:
            return None
        here = inner
    return here


def _parts(annotation: object) -> list[object]:
    """Unwrap a field, `Annotated` and unions to the plain annotations that they allow."""
    if isinstance(annotation, FieldInfo):
        return _parts(annotation.annotation)
    origin = get_origin(annotation)
    if origin is Annotated:
        return _parts(get_args(annotation)[0])
    if origin in (Union, types.UnionType):
        return [p for arg in get_args(annotation) for p in _parts(arg)]
    return [] if annotation is type(None) else [annotation]


def _records(annotation: object) -> list[type[BaseModel]]:
    return [p for p in _parts(annotation) if isinstance(p, type) and issubclass(p, BaseModel)]


def _inside(annotation: object, step: int | str) -> object:
    for part in _parts(annotation):
        args = [arg for arg in get_args(part) if arg is not Ellipsis]
        if get_origin(part) is dict and len(args) == 2:
            return args[1]
        if get_origin(part) in (tuple, list) and args:
            return args[step] if isinstance(step, int) and 0 < step < len(args) else args[0]
    return None


def _kind_of(annotation: object) -> str:
    for part in _parts(annotation):
        if part in (float, int):
            return 'a number' if part is float else 'a whole number'
        if part is str:
            return 'text'
        if part is bool:
            return 'true or false'
        if isinstance(part, type) and issubclass(part, BaseModel):
            return 'a section with ' + _any_of(list(part.model_fields), 'and')
        if get_origin(part) in (tuple, list):
            return 'a list'
        if get_origin(part) is dict:
            return 'keys and values'
    return 'a value'


def _expected(detail: ErrorDetails, annotation: object) -> str:
    kind, ctx = detail['type'], detail.get('ctx', {})
    if kind == 'missing':
        return _kind_of(annotation)
    if kind in _SCALARS:
        return _SCALARS[kind]
    if kind in ('model_type', 'dict_type', 'tuple_type'):
        return _kind_of(annotation)
    if kind == 'too_short':
        return f'at least {ctx["min_length"]} entries'
    if kind == 'too_long':
        return f'at most {ctx["max_length"]} entries'
    expected = detail['msg'].removeprefix('Input should be ')
    return f'a number {expected}' if expected.startswith(('greater', 'less')) else expected


def _closest(unknown: str, known: list[str]) -> str | None:
    """Find the intended key: the same quantity in another unit, then a misspelling."""
    stems = {unknown, _without_unit(unknown), unknown.rsplit('_', 1)[0]}
    same = [name for name in known if key_unit(name) and _without_unit(name) in stems]
    close = same or difflib.get_close_matches(unknown, known, n=1, cutoff=0.6)
    return close[0] if close else None


def _without_unit(key: str) -> str:
    words = key.split('_')
    for start in range(1, len(words)):
        if '_'.join(words[start:]) in KEY_UNITS:
            return '_'.join(words[:start])
    return key


def _any_of(names: list[str], word: str = 'or') -> str:
    if len(names) > 12:
        names = [*names[:11], f'{len(names) - 11} more']
    return f' {word} '.join(', '.join(names).rsplit(', ', 1)) if names else 'no key at all'
