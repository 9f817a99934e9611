# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Definitions of message types from a foreign bag: parsed, and checked against the limits.

Codecs are generated from them as Python code, so only identifiers and sizes that were checked here
go into it.
"""

import re
from dataclasses import make_dataclass
from functools import cache
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import FieldDesc, Typesdict
from rosbags.serde.utils import SIZEMAP
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.base import BaseName, BaseType, make_typesdict, normalize_fieldname
from rosbags.typesys.idl import BinaryExpression, ExpType, IDLParser, eval_expression
from rosbags.typesys.store import Typestore

from trawl_ros.bags.storage.stored import Definition
from trawl_ros.core.limits import (
    CHUNK_BYTES,
    DEFINITION_BYTES,
    DEFINITION_DEPTH,
    DEFINITION_FIELDS,
    DEFINITION_VALUES,
    Limit,
)

_IDL_SEPARATOR = '=' * 80 + '\n'
_TYPE = re.compile(r'(?:[A-Za-z]\w*/)+(?:msg|srv|action)/(?:[A-Za-z]\w*/)?[A-Za-z]\w*', re.ASCII)
_FIELD = re.compile(r'[A-Za-z]\w*', re.ASCII)
_NOTHING: list[tuple[str, FieldDesc]] = [
    ('structure_needs_at_least_one_member', (Nodetype.BASE, ('uint8', 0)))
]
_INTEGER = ExpType(BaseType(BaseName.UINT64))
_STRING_BYTES = 5


def parse_definition(definition: Definition) -> Typesdict:
    """Read the definition of a type, with those of all types in it.

    Raises
    ------
    TypesysError
        If it is not understood, or asks for more than the limits allow.
    """
    if len(definition.text) > DEFINITION_BYTES.value:
        raise _beyond(f'{len(definition.text)} bytes', DEFINITION_BYTES)
    if not _TYPE.fullmatch(definition.type):
        raise TypesysError('the name of the type is none; expected one as std_msgs/msg/Header')
    text = definition.text.decode('utf-8')
    match definition.schema_encoding:
        case 'ros2msg':
            types = get_types_from_msg(text, definition.type)
        case 'ros2idl':
            types = {}
            for section in text.split(_IDL_SEPARATOR):
                body = section.partition('\n')[2] if section.startswith('IDL: ') else section
                if section.strip():
                    types.update(make_typesdict(_IdlParser(body).specification()))
        case other:
            raise TypesysError(f'schema encoding {other!r}; expected ros2msg or ros2idl')
    types = {name: (consts, fields or _NOTHING) for name, (consts, fields) in types.items()}
    _Sizes(types).check(definition.type)
    return types


def make_store(types: Typesdict) -> Typestore:
    """Make a store of types that `parse_definition` gave."""
    store = get_typestore(Stores.EMPTY)
    for name, (consts, fields) in types.items():
        store.fielddefs[name] = (consts, fields)
        store.types[name] = make_dataclass(
            name.replace('/', '__'),
            [(normalize_fieldname(field), Any) for field, _ in fields],
            namespace={'__msgtype__': name} | {const: value for const, _, value in consts},
        )
    return store


def objects_per_byte(types: Typesdict, name: str) -> float:
    """Bound of the Python objects per byte that a message of a type may become."""
    return _Sizes(types).density(name)


class _IdlParser(IDLParser):
    """Parser of ``rosbags`` in linear time, with constants of 64 bits.

    The original tries each rule at a place again for each rule above it, and parentheses are nine
    rules deep. Here a rule is tried once per place.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text)
        for rule in (
            *('annotation_appl', 'const_expr', 'or_expr', 'xor_expr', 'and_expr', 'shift_expr'),
            *('add_expr', 'mult_expr', 'unary_expr', 'primary_expr', 'type_spec', 'scoped_name'),
            *('sequence_type', 'optspace', 'space', 'strings_literal', 'declarators'),
        ):
            setattr(self, rule, cache(getattr(self, rule)))

    def _binop(self, *args: Any) -> Any:
        value = super()._binop(*args)
        expression = getattr(value, 'value', None)
        if isinstance(expression, BinaryExpression) and expression.op in ('<<', '*'):
            # Only these make large numbers of small ones, so they are looked at before they are
            # worked out.
            sides = (expression.left, expression.right)
            factors: list[Any] = [eval_expression(side, _INTEGER, '', ()).value for side in sides]
            if not all(
                isinstance(factor, int | float) and abs(factor) < 2**64 for factor in factors
            ):
                raise TypesysError('a constant of more than 64 bits')
            if expression.op == '<<' and not 0 <= factors[1] < 64:
                raise TypesysError('a shift by more than 63 bits')
        return value


class _Sizes:
    """Sizes of types, nested ones included."""

    def __init__(self, types: Typesdict) -> None:
        self._types = types
        self._known: dict[str, tuple[int, int]] = {}

    def check(self, root: str) -> None:
        """Refuse a type for which no codec can be generated."""
        count = sum(len(fields) for _, fields in self._types.values())
        if count > DEFINITION_FIELDS.value:
            raise _beyond(f'{count} fields', DEFINITION_FIELDS)
        for name in self._types:
            names = [normalize_fieldname(entry) for entry in self._names(name)]
            if not _TYPE.fullmatch(name) or not all(map(_FIELD.fullmatch, names)):
                raise TypesysError('a name that is none; expected letters, digits and _')
            if len(names) != len(set(names)):
                raise TypesysError(f'a field of {name} stands twice; expected each once')
        if sum(self._own(name) for name in self._types) > DEFINITION_VALUES.value:
            raise _beyond('too many elements in arrays of a fixed length', DEFINITION_VALUES)
        size, values = self._size(root, 0)
        if values > DEFINITION_VALUES.value:
            raise _beyond(f'{values} values', DEFINITION_VALUES)
        if size > CHUNK_BYTES.value:
            raise _beyond(f'messages of {size} bytes', CHUNK_BYTES)

    def density(self, root: str) -> float:
        """Largest number of objects per byte in sequences of objects, over all of a type."""
        self._size(root, 0)
        most = 0.0
        for name in self._known:
            for field in self._fields(name):
                kind, inner, what, _ = _taken_apart(field)
                if kind is Nodetype.SEQUENCE and inner is Nodetype.NAME:
                    size, values = self._known[what]
                    most = max(most, (1 + values) / size)
                elif kind is Nodetype.SEQUENCE and what[0] == 'string':
                    most = max(most, 1 / _STRING_BYTES)
        return most

    def _names(self, name: str) -> list[str]:
        consts, fields = self._types[name]
        return [const[0] for const in consts] + [field for field, _ in fields]

    def _own(self, name: str) -> int:
        """Number of repetitions of code for the elements of a type's arrays."""
        return sum(
            count
            for kind, inner, what, count in map(_taken_apart, self._fields(name))
            if kind is Nodetype.ARRAY and not _is_plain(inner, what)
        )

    def _fields(self, name: str) -> list[FieldDesc]:
        return [field for _, field in self._types[name][1]]

    def _size(self, name: str, depth: int) -> tuple[int, int]:
        """Least size of a message in bytes, and values in it without those in sequences."""
        if name in self._known:
            return self._known[name]
        if depth > DEFINITION_DEPTH.value:
            raise _beyond('nesting', DEFINITION_DEPTH)
        if name not in self._types:
            raise TypesysError(f'{name} is not defined; expected its definition too')
        size = values = 0
        for kind, inner, what, count in map(_taken_apart, self._fields(name)):
            if kind is Nodetype.ARRAY and count < 1:
                raise TypesysError(f'an array of {count} elements in {name}; expected some')
            if inner is Nodetype.NAME:
                part = self._size(what, depth + 1)
            elif what[0] == 'string' or what[0] in SIZEMAP:
                part = SIZEMAP.get(what[0], _STRING_BYTES), 1
            else:
                raise TypesysError(f'a field of type {what[0]}, which ROS 2 does not send')
            if kind is Nodetype.SEQUENCE:
                size, values = size + 4, values + 1
                continue
            size += count * part[0]
            values += 1 if _is_plain(inner, what) else count * (part[1] + (inner is Nodetype.NAME))
        self._known[name] = size, values
        return size, values


def _taken_apart(field: FieldDesc) -> tuple[Nodetype, Nodetype, Any, int]:
    """Split a field: its kind, then kind, type and number of its elements."""
    kind: Any
    detail: Any
    kind, detail = field
    if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        (inner, what), count = detail
        return kind, inner, what, count
    return kind, kind, detail, 1


def _is_plain(kind: Nodetype, what: Any) -> bool:
    """True if an array of such elements is one array of numbers."""
    return kind is Nodetype.BASE and what[0] != 'string'


def _beyond(what: str, limit: Limit) -> TypesysError:
    return TypesysError(f'{what}; expected {limit} at most')
