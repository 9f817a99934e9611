# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fields of a message and of all messages within it."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np


def fields_of(message: Any) -> Iterator[tuple[Any, str]]:
    """Return all fields of a message and of its nested messages, each with its owner."""
    for name in getattr(message, '__dataclass_fields__', ()):
        value = getattr(message, name)
        if hasattr(value, '__dataclass_fields__'):
            yield from fields_of(value)
        elif isinstance(value, list) and value and hasattr(value[0], '__dataclass_fields__'):
            yield message, name
            for one in value:
                yield from fields_of(one)
        elif not name.isupper():
            yield message, name


def beyond(message: Any, most: float = math.inf, *, unknown: bool = False) -> set[str]:
    """Return the names of the fields that hold a number above ``most`` or not finite.

    With ``unknown``, numbers that are not finite mean an unknown value and are allowed.
    """
    found = set()
    for owner, name in fields_of(message):
        if not _within(getattr(owner, name), most, unknown):
            found.add(f'{type(owner).__name__}.{name}')
    return found


def _within(value: Any, most: float, unknown: bool) -> bool:
    # NumPy takes ten times as long as Python for one number, and truth is full of them.
    if isinstance(value, float):
        return abs(value) <= most if math.isfinite(value) else unknown
    if getattr(getattr(value, 'dtype', None), 'kind', '') != 'f' or not value.size:
        return True
    size = np.abs(value)
    return bool((size <= most).all() and np.isfinite(size).all()) or bool(
        np.where(np.isfinite(size), size <= most, unknown).all()
    )
