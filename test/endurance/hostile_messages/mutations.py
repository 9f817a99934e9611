"""Hostile messages, made of sound ones: bytes that are wrong, and values that make no sense."""

import math
from collections.abc import Callable
from copy import deepcopy
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.fields import fields_of

NUMBERS = (math.nan, math.inf, -math.inf, 0.0, -1.0, 1e-308, 1e30, -1e300, 1.7976931348623157e308)
SECONDS = (-(2**31), -5, 0, 1, 2**31 - 1)
NANOSECONDS = (0, 999_999_999, 1_000_000_000, 2**32 - 1)
SHIFTS_S = (-86_400, -3600, -61, -11, -1, 1, 11, 61, 3600, 86_400)
TEXTS = ('', 'map', 'port_warp', 'x' * 5000, '\x1b[2J\nforged', '<script>', 'truth/winch: none')
LENGTHS = (0, 1, 2**16, 2**31 - 1, 2**32 - 1)
MOST_ENTRIES = 2000


def hostile_bytes(data: bytes, type_name: str, rng: Generator) -> bytes:
    """Make a hostile message of a sound one, as a draw has it."""
    kinds = (_flip, _cut, _append, _overwrite_length, _other_values, _other_stamp, _same)
    kind: Callable[[bytes, str, Generator], bytes] = kinds[
        rng.choice(len(kinds), p=(0.1, 0.1, 0.05, 0.15, 0.35, 0.2, 0.05))
    ]
    return kind(data, type_name, rng)


def _flip(data: bytes, _: str, rng: Generator) -> bytes:
    changed = bytearray(data)
    for _bit in range(rng.integers(1, 9)):
        if changed:
            changed[rng.integers(len(changed))] ^= 1 << rng.integers(8)
    return bytes(changed)


def _cut(data: bytes, _: str, rng: Generator) -> bytes:
    return data[: rng.integers(len(data) + 1)]


def _append(data: bytes, _: str, rng: Generator) -> bytes:
    return data + rng.bytes(int(rng.integers(1, 100_000)))


def _overwrite_length(data: bytes, _: str, rng: Generator) -> bytes:
    """Put what may be a length somewhere, on the border on which lengths lie."""
    changed = bytearray(data)
    place = 4 + 4 * int(rng.integers(max((len(data) - 8) // 4, 1)))
    changed[place : place + 4] = int(rng.choice(LENGTHS)).to_bytes(4, 'little')
    return bytes(changed)


def _same(data: bytes, _: str, rng: Generator) -> bytes:
    return data


def _other_stamp(data: bytes, type_name: str, rng: Generator) -> bytes:
    message = deserialize(data, type_name)
    times = [owner for owner, field in fields_of(message) if field == 'sec']
    if not times:
        return data
    for time in times:
        if rng.random() < 0.5:
            time.sec = int(np.clip(time.sec + rng.choice(SHIFTS_S), -(2**31), 2**31 - 1))
        else:
            time.sec = int(rng.choice(SECONDS))
            time.nanosec = int(rng.choice(NANOSECONDS))
    return serialize(message)


def _other_values(data: bytes, type_name: str, rng: Generator) -> bytes:
    message = deepcopy(deserialize(data, type_name))
    fields = [(owner, field) for owner, field in fields_of(message) if field not in _TIME]
    if not fields:
        return data
    for _ in range(rng.integers(1, 4)):
        owner, field = fields[rng.integers(len(fields))]
        value = getattr(owner, field)
        setattr(owner, field, _other(value, rng))
    try:
        return serialize(message)
    except Exception:
        # The draw does not fit the type, so nobody could send it.
        return data


_TIME = ('sec', 'nanosec')


def _other(value: Any, rng: Generator) -> Any:
    match value:
        case bool():
            return not value
        case float():
            return float(rng.choice(NUMBERS))
        case int():
            return int(rng.integers(0, 256))
        case str():
            return str(rng.choice(TEXTS))
        case np.ndarray():
            return _other_array(value, rng)
        case list():
            entries = value * int(rng.integers(0, 4))
            return [str(rng.choice(TEXTS)) if isinstance(e, str) else e for e in entries]
    return value


def _other_array(values: NDArray[np.generic], rng: Generator) -> NDArray[np.generic]:
    changed: NDArray[np.generic] = values.copy()
    if changed.size and changed.dtype.kind == 'f' and rng.random() < 0.7:
        # Numbers too large for the type become infinite.
        with np.errstate(over='ignore'):
            changed[rng.integers(changed.size)] = rng.choice(NUMBERS)
    else:
        changed = np.resize(changed, int(rng.integers(0, MOST_ENTRIES)))
    return changed
