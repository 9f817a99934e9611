# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checkpoint format: objects of the identification as JSON and raw numbers, bit by bit.

Classes change and a saved file must not decide what is built: only classes of the packages
named here are, without running any of their code, and only with the attributes they have.
What is no data (the model, functions) stays out and is put back from a fresh object.
"""

import sys
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from math import prod
from typing import Any

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray

PACKAGES = ('trawl_ros.estimation.', 'trawl_ros.records.', 'trawl_ros.model.', 'trawl_ros.solver.')
"""Packages whose classes may stand in a checkpoint."""

SEQUENCES: Mapping[str, Any] = {'list': list, 'tuple': tuple, 'set': set, 'frozenset': frozenset}
MAPPINGS: Mapping[str, Any] = {'dict': dict, 'Counter': Counter}
NUMBERS = ('<f8', '<i8', '|b1')
"""Kinds of numbers in arrays, as numpy calls them."""


class Packer:
    """Encoder of objects into JSON and one string of bytes for the numbers of their arrays.

    What is met twice is packed once, so objects that share a counter still do afterwards.

    Parameters
    ----------
    left_out
        An object that stays out, as functions do.

    Attributes
    ----------
    numbers : bytearray
        The numbers of all arrays.
    given : dict
        Parts that stayed out, by their path of attributes.
    attributes : dict
        Names of the attributes of each class that was met.
    """

    def __init__(self, left_out: Any) -> None:
        self.numbers = bytearray()
        self.given: dict[str, Any] = {}
        self.attributes: dict[str, list[str]] = {}
        self._left_out = left_out
        self._met: dict[int, tuple[int, Any]] = {}

    def pack(self, value: Any, path: str = '') -> Any:
        """Encode a value as JSON.

        Raises
        ------
        TypeError
            If something in it is neither data nor of a class that is saved.
        """
        if isinstance(value, np.generic):
            value = value.item()
        if value is None or isinstance(value, bool | int | float | str):
            return value
        if value is self._left_out or callable(value):
            self.given[path] = value
            return {'given': path}
        if id(value) in self._met:
            return {'same': self._met[id(value)][0]}
        # Kept, so that no other object takes its place and its id.
        self._met[id(value)] = len(self._met), value
        return {'number': self._met[id(value)][0], **self._content(value, path)}

    def _content(self, value: Any, path: str) -> dict[str, Any]:
        if isinstance(value, np.ndarray):
            return self._array(value, path)
        for name, kind in SEQUENCES.items():
            if type(value) is kind:
                return {name: [self.pack(item, f'{path}.{i}') for i, item in enumerate(value)]}
        if isinstance(value, deque):
            items = [self.pack(item, f'{path}.{i}') for i, item in enumerate(value)]
            return {'deque': items, 'most': value.maxlen}
        if isinstance(value, Mapping):
            name = 'Counter' if isinstance(value, Counter) else 'dict'
            return {name: [[self.pack(k), self.pack(v, f'{path}.{k}')] for k, v in value.items()]}
        name = f'{type(value).__module__}.{type(value).__qualname__}'
        if not name.startswith(PACKAGES):
            raise TypeError(f'{path} is a {name}, which cannot be saved')
        names = attribute_names(value)
        self.attributes[name] = sorted(names)
        return {
            'object': name,
            'has': {key: self.pack(getattr(value, key), f'{path}.{key}') for key in names},
        }

    def _array(self, value: FloatArray | IntArray | BoolArray, path: str) -> dict[str, Any]:
        if value.dtype.str not in NUMBERS:
            raise TypeError(f'{path} has numbers of kind {value.dtype.str}, which are not saved')
        offset = len(self.numbers)
        self.numbers += value.tobytes()
        return {'array': value.dtype.str, 'shape': list(value.shape), 'at': offset}


class Unpacker:
    """Decoder of the output of a `Packer`.

    Parameters
    ----------
    numbers
        The numbers of all arrays.
    fresh
        A packer that has packed an object of the same kind: it knows what stays out, and the
        attributes that each class has now.
    """

    def __init__(self, numbers: bytes, fresh: Packer) -> None:
        self._numbers = numbers
        self._fresh = fresh
        self._made: dict[int, Any] = {}

    def unpack(self, tree: Any) -> Any:
        """Decode a value.

        Raises
        ------
        LookupError, TypeError, ValueError, AttributeError
            If it is not what a packer gave.
        """
        if tree is None or isinstance(tree, bool | int | float | str):
            return tree
        if 'given' in tree:
            return self._fresh.given[tree['given']]
        if 'same' in tree:
            return self._made[tree['same']]
        return self._content(tree, tree['number'])

    def _content(self, tree: dict[str, Any], number: int) -> Any:
        if 'object' in tree:
            return self._object(tree, number)
        made: Any
        if 'array' in tree:
            made = self._array(tree)
        elif 'deque' in tree:
            made = deque(map(self.unpack, tree['deque']), maxlen=tree['most'])
        elif names := SEQUENCES.keys() & tree.keys():
            (name,) = names
            made = SEQUENCES[name](map(self.unpack, tree[name]))
        else:
            (name,) = MAPPINGS.keys() & tree.keys()
            pairs = ((self.unpack(key), self.unpack(value)) for key, value in tree[name])
            made = MAPPINGS[name](dict(pairs))
        self._made[number] = made
        return made

    def _object(self, tree: dict[str, Any], number: int) -> Any:
        name, has = tree['object'], tree['has']
        kind = _class(name)
        now = self._fresh.attributes.get(name)
        if now is None and is_dataclass(kind):
            now = sorted(field.name for field in fields(kind))
        if now is not None and now != sorted(has):
            raise ValueError(f'{name} has other attributes')
        made: Any = object.__new__(kind)
        # Known before it is whole, for what it has may refer to it.
        self._made[number] = made
        for key, value in has.items():
            object.__setattr__(made, key, self.unpack(value))
        return made

    def _array(self, tree: dict[str, Any]) -> FloatArray | IntArray | BoolArray:
        if tree['array'] not in NUMBERS:
            raise ValueError(f'numbers of kind {tree["array"]!r}')
        kind, shape = np.dtype(tree['array']), [int(size) for size in tree['shape']]
        if min([tree['at'], *shape]) < 0:
            raise ValueError('an array of negative size')
        flat = np.frombuffer(self._numbers, kind, prod(shape), tree['at'])
        # A copy: what was read from bytes could not be written to.
        array: FloatArray | IntArray | BoolArray = flat.reshape(shape).copy()
        return array


def attribute_names(value: Any) -> list[str]:
    """Names of an object's attributes; of a dataclass its fields, without cached ones."""
    if is_dataclass(value):
        return [field.name for field in fields(value)]
    return list(vars(value))


def _class(name: str) -> type:
    module, _, own = name.rpartition('.')
    # Nothing is imported: whatever there is to resume has its classes loaded already.
    kind = getattr(sys.modules.get(module), own) if name.startswith(PACKAGES) else None
    if not isinstance(kind, type) or kind.__module__ != module:
        raise ValueError(f'{name} is not a class that is saved')
    return kind
