"""Boundary to foreign files: any error of their reading becomes a sentence."""

import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from trawl_ros.core.errors import TrawlError


@contextmanager
def reading(
    path: str | Path,
    error: type[TrawlError],
    place: Callable[[], str] | None = None,
) -> Iterator[None]:
    """Convert errors of libraries that read a foreign file into the project's own error.

    Readers say themselves what they expected wherever they know; this is for what they could not
    foresee, so that no file can show a traceback.

    Parameters
    ----------
    path
        The file, named in the error.
    error
        Class of the error to raise.
    place
        Says where in the file the reader was (``'byte 4711'``, ``'line 3'``), asked only then.

    Raises
    ------
    TrawlError
        Of class ``error``, with file, place and what was raised. Errors of the project pass
        unchanged, as does a wish to stop.
    """
    try:
        yield
    except TrawlError:
        raise
    except Exception as reason:
        where = f'{path}: {place()}' if place else str(path)
        raise error(f'{where}: cannot be read ({short(reason)}), expected a sound file') from reason


def open_file(path: Path, error: type[TrawlError]) -> BinaryIO:
    """Open a file for reading if it is one: a pipe or device would wait, or never end.

    Raises
    ------
    TrawlError
        Of class ``error``, if it is something else or cannot be opened.
    """
    try:
        number = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except FileNotFoundError:
        raise error(f'{path}: no such file') from None
    except OSError as reason:
        raise error(f'{path}: cannot be read ({reason.strerror})') from reason
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise error(f'{path}: not a file but a folder, pipe or device; expected a file')
    return os.fdopen(number, 'rb')


def short(reason: Exception, width: int = 120) -> str:
    """Name an exception in one line of bounded length."""
    if isinstance(reason, OSError) and reason.strerror:
        return reason.strerror
    return one_line(f'{type(reason).__name__}: {reason}'.rstrip(': '), width)


def one_line(text: str, width: int) -> str:
    """Cut what a file or message brings along to its first line, at most ``width`` long."""
    # Not split before it is cut: what is foreign may be long.
    text = text[: 2 * width].split('\n', 1)[0].rstrip()
    # It may hold control characters, which a terminal would obey.
    text = ''.join(sign if sign.isprintable() else '?' for sign in text)
    return text if len(text) <= width else f'{text[: width - 3]}...'
