"""Files and folders of results: checked before the work, and written whole."""

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
    """Check, before the work, that its results can go into a folder, which need not exist yet.

    Raises
    ------
    TrawlError
        If there is something in it already, unless ``force`` allows replacing it, or if it cannot
        be written to.
    """
    require_writable(path, TrawlError)
    if path.is_dir() and any(path.iterdir()) and not force:
        raise TrawlError(
            f'{path}: holds files already, which are not written over; expected a new or empty '
            'folder, or --force'
        )
    return path


def new_folder(path: Path, error: type[TrawlError]) -> Path:
    """Check, before the work, that a folder can be made.

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
    """Return a path, or the first free one of ``NAME_2``, ``NAME_3`` … where it is taken.

    Parameters
    ----------
    path
        The path.
    or_empty
        True if a folder without files is free too.
    suffix
        End of the name, behind the number.
    """
    name = path.name.removesuffix(suffix)
    numbered = (path.with_name(f'{name}_{number}{suffix}') for number in count(2))
    return next(one for one in chain((path,), numbered) if _is_free(one, or_empty))


def _is_free(path: Path, or_empty: bool) -> bool:
    if or_empty and path.is_dir():
        return not any(path.iterdir())
    return not os.path.lexists(path)


def require_writable(path: Path, error: type[TrawlError]) -> None:
    """Check that something can be written at a path, which leaves nothing behind.

    Raises
    ------
    TrawlError
        Of the type ``error``, if it cannot.
    """
    try:
        with TemporaryFile(dir=_nearest(path)) as file:
            file.write(b'?')
    except OSError as reason:
        raise error(f'{path}: cannot be written ({reason.strerror})') from reason


def _nearest(path: Path) -> Path:
    """Return the path, or the first above it, that there is."""
    for place in (path, *path.parents):
        with suppress(FileNotFoundError, NotADirectoryError):
            place.lstat()
            return place
    return path


def made_folder(path: Path) -> Path:
    """Make a folder, and those above it, where they do not exist.

    Raises
    ------
    TrawlError
        If it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as reason:
        raise TrawlError(f'{path}: cannot be made ({reason.strerror})') from reason
    return path


@contextmanager
def written(path: Path) -> Iterator[Path]:
    """Write a file whole or not at all, whenever one is interrupted or the disk is full.

    Parameters
    ----------
    path
        The file. Where it is a link, the link is replaced, and what it leads to stays as it is.

    Yields
    ------
    Path
        A file beside it, with the same suffix, to be written; it then takes the other's place.

    Raises
    ------
    TrawlError
        If it cannot be written.
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
    """Write a folder whole or not at all, whenever one is interrupted or the disk is full.

    Yields
    ------
    Path
        A path of the same name elsewhere on the disk, where the folder is to be made; it then
        takes the other's place.

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
    """Write text that ends with one line's end, as `written` does."""
    with written(path) as draft:
        # Names of files may hold bytes that are no text.
        draft.write_bytes(f'{text.rstrip()}\n'.encode('utf-8', 'backslashreplace'))


def write_json(
    path: Path, record: object, *, indent: int | None = None, ensure_ascii: bool = True
) -> None:
    """Write JSON as `written` does.

    Raises
    ------
    ValueError
        If a number is not finite, which JSON does not know.
    """
    write_text(path, json.dumps(record, indent=indent, ensure_ascii=ensure_ascii, allow_nan=False))


def finite(value: float) -> float | None:
    """Return a number as JSON has it: None where it is NaN or infinite."""
    return float(value) if math.isfinite(value) else None


def write_figure(path: Path, figure: 'Figure', dpi: float) -> None:
    """Write a figure as PNG as `written` does."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.dpi = dpi
    with written(path) as draft:
        # `savefig` draws all of it once more beforehand, for its layout, which a canvas does too.
        FigureCanvasAgg(figure).print_png(draft)  # type: ignore[no-untyped-call]


def appending(path: Path) -> TextIO:
    """Open a text file of results to add to it; a link, pipe or device is refused.

    Raises
    ------
    TrawlError
        If it cannot be opened.
    """
    # Without O_NONBLOCK, opening a pipe that nobody reads would wait for ever.
    flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        number = os.open(path, flags, 0o666)
    except OSError as reason:
        raise TrawlError(f'{path}: cannot be written ({reason.strerror})') from reason
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise TrawlError(f'{path}: is a pipe or device; expected a file or a new path')
    return os.fdopen(number, 'a', encoding='utf-8')


def is_there(path: Path, error: type[TrawlError]) -> bool:
    """Return whether a file that a node continues, and will replace, exists.

    Whoever continues it checks by its content that it is its own before it writes.

    Raises
    ------
    TrawlError
        Of the type ``error``, if something other than a file is there: a link would be replaced,
        and a pipe or device would be read without end.
    """
    if not os.path.lexists(path):
        return False
    if not stat.S_ISREG(path.lstat().st_mode):
        raise error(f'{path}: is a link, folder, pipe or device; expected a file or a new path')
    return True
