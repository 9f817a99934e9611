# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""First start on a machine: folder of compiled loops, and messages while they compile."""

import logging
import os
import stat
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

LOG = logging.getLogger('trawl_ros.first_start')
"""Without a handler, Python prints its warnings on stderr; nodes pass them to the ROS log."""

PACKAGE = Path(__file__).parents[1]

QUIET_S = 1.0
"""Compilation time without a message, s."""

LINE_EVERY_S = 5.0
"""Interval of messages, s."""

USUAL_TIME = '20 to 60 s'
"""Time to compile the loops of a tow, on one core of 2020 to 2025."""


@dataclass(frozen=True)
class LoopFolder:
    """Folder of compiled loops, None if no folder can be written to; ``why`` is the reason."""

    path: Path | None
    why: str


def loop_folder(environment: Mapping[str, str] = os.environ) -> LoopFolder:
    """Choose the first folder for compiled loops that can be written to.

    The order is ``NUMBA_CACHE_DIR``, the package, the user's cache and a temporary folder.
    """
    given = environment.get('NUMBA_CACHE_DIR', '')
    if given and _takes_files(Path(given)):
        return LoopFolder(Path(given), f'once: they are kept in {given}')
    missed = f'NUMBA_CACHE_DIR={given} cannot be written to; ' if given else ''
    home = _home(environment)
    cache = environment.get('XDG_CACHE_HOME', '')
    users = Path(cache) if cache.startswith('/') else home and home / '.cache'
    for folder in (PACKAGE / '__pycache__' / 'loops', users and users / 'trawl_ros'):
        if folder is not None and _takes_files(folder):
            return LoopFolder(folder, f'once on this machine: {missed}they are kept in {folder}')
    private = private_folder()
    if private is not None:
        return LoopFolder(
            private,
            f'until {private} is emptied: {missed}neither package nor home can be written to; set '
            'NUMBA_CACHE_DIR to a folder that stays',
        )
    return LoopFolder(
        None,
        f'at each start: {missed}neither package, home nor a temporary folder can be written to; '
        'set NUMBA_CACHE_DIR to a folder that can',
    )


def private_folder() -> Path | None:
    """Return a temporary folder that no other user can write to, or None.

    Compiled loops are code, so a folder of another user with this name is not used.
    """
    folder = _private_path()
    if folder is None:
        return None
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return None
    own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    return folder if own and not found.st_mode & 0o022 and _takes_files(folder) else None


def _private_path() -> Path | None:
    if not hasattr(os, 'getuid'):  # Windows, whose temporary folder is the user's own
        return None
    try:
        place = Path(tempfile.gettempdir())
        # `tempfile` falls back to the working folder, where users expect no such folder.
        return None if place == Path.cwd() else place / f'trawl_ros-{os.getuid()}'
    except OSError:
        return None


def need_home() -> bool:
    """Give this process a temporary home if it has none that can be written to.

    ROS 2, Dask and matplotlib write to it. Without it ROS 2 does not start, Dask makes a folder
    named ``~``, and matplotlib warns.

    Returns
    -------
    bool
        False if there is no folder for one.
    """
    if _home(os.environ) is None:
        folder = private_folder()
        if folder is None:
            return False
        os.environ['HOME'] = str(folder)
    return True


def _home(environment: Mapping[str, str]) -> Path | None:
    home = Path(environment.get('HOME', ''))
    own = home.is_absolute() and home.is_dir() and _takes_files(home)
    # The folder of `need_home` is temporary, so it is no home.
    return home if own and home != _private_path() else None


def _takes_files(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b'?')
    except OSError:
        return False
    return True


class CompilationWatch:
    """Watch of compilation, which reports its progress and stops it on request.

    Parameters
    ----------
    clock
        Function that returns wall time in s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._stop: Callable[[], bool] = lambda: False
        self._under_way = 0
        self._loops = 0
        self._began_s = 0.0
        self._spent_s = 0.0
        self._said_s: float | None = None
        self.folder: LoopFolder | None = None

    @contextmanager
    def stopping(self, wanted: Callable[[], bool]) -> Iterator[None]:
        """Raise KeyboardInterrupt from a compilation within this context if a stop is wanted."""
        self._stop = wanted
        try:
            yield
        finally:
            self._stop = lambda: False

    def begin(self) -> None:
        """Record the start of a compilation, which may be nested."""
        if self._under_way == 0:
            self._began_s = self._clock()
        self._under_way += 1

    def end(self) -> None:
        """Record the end of a compilation, or its failure."""
        self._loops += 1
        self._under_way -= 1
        if self._under_way == 0:
            self._spent_s += self._clock() - self._began_s

    def step(self) -> None:
        """Report the progress during a compilation, or stop it.

        Raises
        ------
        KeyboardInterrupt
            If a stop is wanted, in the main thread.
        """
        if self._stop() and threading.current_thread() is threading.main_thread():
            raise KeyboardInterrupt
        spent = self._spent_s + self._clock() - self._began_s
        if self._said_s is None and spent >= QUIET_S:
            why = 'once' if self.folder is None else self.folder.why
            LOG.warning('compiling the loops of the model takes %s, %s', USUAL_TIME, why)
        elif self._said_s is not None and spent - self._said_s >= LINE_EVERY_S:
            LOG.warning('compiled %d loops in %.0f s', self._loops, spent)
        else:
            return
        self._said_s = spent


COMPILATION = CompilationWatch()
"""Watch of this process."""
