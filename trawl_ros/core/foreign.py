# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Boundary to foreign files: every error in reading them becomes one sentence."""

import json
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.limits import JSON_BYTES, YAML_NUMBER, Limit
from trawl_ros.core.resources import names_in, nearest


@contextmanager
def reading(
    path: str | Path,
    error: type[TrawlError],
    place: Callable[[], str] | None = None,
) -> Iterator[None]:
    """Convert errors of libraries that read a foreign file to errors of the project.

    Readers report the faults that they expect. This covers all others, so that no file can cause a
    traceback.

    Parameters
    ----------
    path
        The file, named in the error.
    error
        Class of the error to raise.
    place
        Function that returns the place in the file (``'byte 4711'``, ``'line 3'``) after an error.

    Raises
    ------
    TrawlError
        Of class ``error``, with file, place and the original error. Errors of the project and
        KeyboardInterrupt pass unchanged.
    """
    try:
        yield
    except TrawlError:
        raise
    except Exception as reason:
        where = f'{path}: {place()}' if place else str(path)
        raise error(
            f'{where}: cannot be read ({short(reason)}), expected an undamaged file'
        ) from reason


def open_file(path: Path, error: type[TrawlError]) -> BinaryIO:
    """Open a regular file for reading; a pipe or device could block or never end.

    Raises
    ------
    TrawlError
        Of class ``error``, if it is not a regular file or cannot be opened.
    """
    try:
        number = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except FileNotFoundError:
        near = nearest(path.name, names_in(path.parent))
        raise error(f'{path}: no such file, expected {error.expected}{near}') from None
    except OSError as reason:
        raise error(f'{path}: cannot be read ({reason.strerror})') from reason
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise error(f'{path}: found a folder, pipe or device, expected a file')
    return os.fdopen(number, 'rb')


def read_whole(path: Path, limit: Limit, error: type[TrawlError], expected: str) -> bytes:
    """Read a file of at most ``limit`` bytes; otherwise the error says what was ``expected``."""
    with open_file(path, error) as stream:
        data = stream.read(limit.value + 1)
    if len(data) > limit.value:
        raise error(f'{path}: larger than {limit}, expected {expected}')
    if not data:
        raise error(f'{path}: the file is empty, expected {error.expected}')
    return data


def load_json(path: Path, error: type[TrawlError]) -> object:
    """Load a JSON file within the limits of size, nesting and numbers.

    Raises
    ------
    TrawlError
        Of class ``error``, if it is missing, too large or not JSON, or contains NaN or a number
        that is too large.
    """
    data = read_whole(path, JSON_BYTES, error, 'a smaller JSON file')
    try:
        return parse_json(data)
    except ValueError as reason:
        raise error(f'{path}: {short(reason)}, expected JSON') from reason


def parse_json(data: bytes) -> object:
    """Parse JSON within the limits of nesting and numbers.

    Raises
    ------
    ValueError
        If it is not JSON, is nested too deeply, or contains NaN or a number that is too large.
    """
    try:
        return json.loads(
            data, parse_int=_bounded_int, parse_float=_bounded, parse_constant=_bounded
        )
    except RecursionError:
        raise ValueError('nested too deeply') from None


def _bounded(text: str) -> float:
    value = float(text)
    if not abs(value) <= YAML_NUMBER.value:
        raise ValueError(
            f'found the number {one_line(text, 30)}, expected a finite number of magnitude '
            f'{YAML_NUMBER.value:.0e} at most'
        )
    return value


def _bounded_int(text: str) -> int:
    # Check the size first: the conversion takes time proportional to the square of the length.
    _bounded(text)
    return int(text)


def short(reason: Exception, width: int = 120) -> str:
    """Describe an exception in one line of limited length."""
    if isinstance(reason, OSError) and reason.strerror:
        return reason.strerror
    return one_line(f'{type(reason).__name__}: {reason}'.rstrip(': '), width)


def one_line(text: str, width: int) -> str:
    """Return the first line of a foreign text, at most ``width`` long."""
    # Cut before splitting, because a foreign text may be long.
    text = text[: 2 * width].split('\n', 1)[0].rstrip()
    # Replace control characters, which a terminal would execute.
    text = ''.join(sign if sign.isprintable() else '?' for sign in text)
    return text if len(text) <= width else f'{text[: width - 3]}...'
