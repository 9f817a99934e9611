# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files and folders of results: checked before the work, and written completely or not at all."""

import json
import math
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import chain, count
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import TYPE_CHECKING, TextIO

from trawl_ros.core.errors import TrawlError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def empty_folder(path: Path, *, force: bool) -> Path:
    """Check before the work that results can be written to a folder, which may not exist yet.

    Raises
    ------
    TrawlError
        If it contains files, unless ``force`` allows replacing them, or if it cannot be written
        to.
    """
    require_writable(path, TrawlError)
    if path.is_dir() and any(path.iterdir()) and not force:
        raise TrawlError(
            f'{path}: holds files already, which are not written over; expected a new or empty '
            'folder, or --force'
        )
    return path


def new_folder(path: Path, error: type[TrawlError]) -> Path:
    """Check before the work that a folder can be made.

    Raises
    ------
    TrawlError
        Of the type ``error``, if the path exists or the folder cannot be made there.
    """
    if os.path.lexists(path):
        raise error(f'{path}: exists already and is not written over; expected a new path')
    require_writable(path, error)
    return path


def free_path(path: Path, *, or_empty: bool = False, suffix: str = '') -> Path:
    """Return a path, or the first free one of ``NAME_2``, ``NAME_3`` … if it exists.

    Parameters
    ----------
    path
        The path.
    or_empty
        True to accept an empty folder too.
    suffix
        End of the name, after the number.
    """
    name = path.name.removesuffix(suffix)
    numbered = (path.with_name(f'{name}_{number}{suffix}') for number in count(2))
    return next(one for one in chain((path,), numbered) if _is_free(one, or_empty))


def _is_free(path: Path, or_empty: bool) -> bool:
    if or_empty and path.is_dir():
        return not any(path.iterdir())
    return not os.path.lexists(path)


def require_writable(path: Path, error: type[TrawlError]) -> None:
    """Check that a path can be written, without leaving a file.

    Raises
    ------
    TrawlError
        Of the type ``error``, if it cannot be written.
    """
    try:
        with TemporaryFile(dir=_nearest(path)) as file:
            file.write(b'?')
    except OSError as reason:
        raise error(f'{path}: cannot be written ({reason.strerror})') from reason


def _nearest(path: Path) -> Path:
    """Return the path or its nearest existing parent."""
    for place in (path, *path.parents):
        with suppress(FileNotFoundError, NotADirectoryError):
            place.lstat()
            return place
    return path


def made_folder(path: Path) -> Path:
    """Make a folder and its parents, if they do not exist.

    Raises
    ------
    TrawlError
        If the folder cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as reason:
        raise TrawlError(f'{path}: cannot be made ({reason.strerror})') from reason
    return path


@contextmanager
def written(path: Path) -> Iterator[Path]:
    """Write a file completely or not at all, also when interrupted or on a full disk.

    Parameters
    ----------
    path
        The file. A link is replaced; its target stays unchanged.

    Yields
    ------
    Path
        Temporary file in the same folder, with the same suffix, which replaces the file.

    Raises
    ------
    TrawlError
        If the file cannot be written.
    """
    draft = path.with_name(f'.{os.getpid()}.{path.name}')
    try:
        draft.unlink(missing_ok=True)
        yield draft
        draft.replace(path)
    except OSError as reason:
        raise TrawlError(f'{path}: cannot be written ({reason.strerror})') from reason
    finally:
        with suppress(OSError):
            draft.unlink(missing_ok=True)


@contextmanager
def written_folder(path: Path, error: type[TrawlError]) -> Iterator[Path]:
    """Write a folder completely or not at all, also when interrupted or on a full disk.

    Yields
    ------
    Path
        Temporary path of the same name on the same disk, which replaces the folder.

    Raises
    ------
    TrawlError
        Of the type ``error``, if it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=path.parent, prefix='.unfinished_') as folder:
            draft = Path(folder) / path.name
            try:
                yield draft
            except error as reason:
                raise error(str(reason).replace(str(draft), str(path))) from reason
            draft.replace(path)
    except OSError as reason:
        raise error(f'{path}: cannot be written ({reason.strerror})') from reason


def write_text(path: Path, text: str) -> None:
    """Write text with one newline at its end, completely or not at all."""
    with written(path) as draft:
        # File names may contain bytes that are not valid text.
        draft.write_bytes(f'{text.rstrip()}\n'.encode('utf-8', 'backslashreplace'))


def write_json(
    path: Path, record: object, *, indent: int | None = None, ensure_ascii: bool = True
) -> None:
    """Write JSON, completely or not at all.

    Raises
    ------
    ValueError
        If a number is not finite, which JSON does not allow.
    """
    write_text(path, json.dumps(record, indent=indent, ensure_ascii=ensure_ascii, allow_nan=False))


def finite(value: float) -> float | None:
    """Return a number for JSON: None if it is NaN or infinite."""
    return float(value) if math.isfinite(value) else None


def write_figure(path: Path, figure: 'Figure', dpi: float) -> None:
    """Write a figure as PNG, completely or not at all."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.dpi = dpi
    with written(path) as draft:
        # `savefig` would draw the figure twice for its layout.
        FigureCanvasAgg(figure).print_png(draft)  # type: ignore[no-untyped-call]


def appending(path: Path) -> TextIO:
    """Open a text file of results for appending; a link, pipe or device is refused.

    Raises
    ------
    TrawlError
        If the file cannot be opened.
    """
    # Without O_NONBLOCK, opening a pipe without a reader would wait forever.
    flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        number = os.open(path, flags, 0o666)
    except OSError as reason:
        raise TrawlError(f'{path}: cannot be written ({reason.strerror})') from reason
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise TrawlError(f'{path}: found a pipe or device, expected a file or a new path')
    return os.fdopen(number, 'a', encoding='utf-8')


def is_there(path: Path, error: type[TrawlError]) -> bool:
    """Return True if a file exists that a node continues and will replace.

    The caller checks the content before it writes.

    Raises
    ------
    TrawlError
        Of the type ``error``, if it is not a regular file: a link would be replaced, and a pipe or
        device would be read without end.
    """
    if not os.path.lexists(path):
        return False
    if not stat.S_ISREG(path.lstat().st_mode):
        raise error(f'{path}: found a link, folder, pipe or device, expected a file or a new path')
    return True
