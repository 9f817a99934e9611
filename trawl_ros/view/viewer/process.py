# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Program of Rerun as a process that listens on a port, with its usage statistics off."""

import os
import socket
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.foreign import one_line
from trawl_ros.view.viewer.rerun_library import EXECUTABLE

STARTS_S = 30.0
ENDS_S = 5.0
POLL_S = 0.05
LAST_WORDS = 300
NEEDS = 'a display and graphics that work, or --web, or --out FILE.rrd'


class ViewerFailed(TrawlError):
    """Viewer that cannot be opened, or that ended unexpectedly."""


class RerunProcess:
    """Process of Rerun while entered.

    Parameters
    ----------
    arguments
        Of the program.
    address
        Host and port on which it listens once it has started.
    folder
        For its settings and what it says.
    environment
        Variables of this process.

    Raises
    ------
    ViewerFailed
        If it does not start.
    """

    def __init__(
        self,
        arguments: Sequence[str],
        address: tuple[str, int],
        folder: Path,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        self._arguments = arguments
        self._address = address
        self._log = folder / 'log'
        self._environment = _silent(environment, folder)

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def running(self) -> bool:
        """True until it is closed."""
        return self._process.poll() is None

    def check(self) -> None:
        """Raise an error if it ended by itself with an error.

        Raises
        ------
        ViewerFailed
            With its last words.
        """
        if self._process.poll():
            raise ViewerFailed(f'the viewer has ended: {self._last_words()}; expected {NEEDS}')

    def wait(self, seconds: float) -> None:
        """Wait until it is closed, at most this long."""
        try:
            self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return

    def __enter__(self) -> 'RerunProcess':
        with self._log.open('wb') as log:
            # A session of its own: Ctrl-C is for the command, which then ends it.
            self._process = subprocess.Popen(
                [EXECUTABLE, *self._arguments],
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        try:
            self._wait_for_port()
        except BaseException:
            self._end()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def _wait_for_port(self) -> None:
        end = time.monotonic() + STARTS_S
        while not _listens(self._address):
            if not self.running or time.monotonic() > end:
                said = self._last_words()
                raise ViewerFailed(f'the viewer does not start: {said}; expected {NEEDS}')
            time.sleep(POLL_S)

    def _last_words(self) -> str:
        text = self._log.read_text('utf-8', 'replace').strip().rpartition('\n')[2]
        return one_line(text, LAST_WORDS) or 'it says nothing'

    def _end(self) -> None:
        if self.running:
            self._process.terminate()
            self.wait(ENDS_S)
        if self.running:
            self._process.kill()
            self._process.wait()


def _silent(environment: Mapping[str, str], folder: Path) -> dict[str, str]:
    """Return the environment of a viewer whose usage statistics are off, whatever the user's are.

    Only the user's configuration can switch them off, so this viewer has its own configuration.
    """
    private = {'XDG_CONFIG_HOME': str(folder), 'XDG_DATA_HOME': str(folder)}
    subprocess.run(
        [EXECUTABLE, 'analytics', 'disable'],
        env={**environment, **private, 'CI': '1'},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        check=False,
    )
    forced = {'FORCE_RERUN_ANALYTICS'}
    kept = {name: value for name, value in environment.items() if name not in forced}
    return {**kept, 'XDG_CONFIG_HOME': str(folder)}


def _listens(address: tuple[str, int]) -> bool:
    try:
        with socket.create_connection(address, 1.0):
            return True
    except OSError:
        return False
