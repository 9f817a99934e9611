"""Viewer of Rerun as a process: its window, or its web page, bound to this machine unless asked."""

import ipaddress
import os
import socket
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Literal

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.foreign import one_line
from trawl_ros.core.network import THIS_MACHINE
from trawl_ros.view.rerun_library import EXECUTABLE

Kind = Literal['window', 'web', 'headless']

DISPLAYS = ('DISPLAY', 'WAYLAND_DISPLAY')

STARTS_S = 30.0
ENDS_S = 5.0
POLL_S = 0.05
LAST_WORDS = 300
NEEDS = 'a display and graphics that work, or --web, or --out FILE.rrd'


class ViewerFailed(TrawlError):
    """Viewer that cannot be opened, or that ended when it should not have."""


def address_of(bind: str) -> str:
    """Check the address on which a viewer is to listen.

    Raises
    ------
    ViewerFailed
        If it is none.
    """
    try:
        return str(ipaddress.ip_address(bind))
    except ValueError:
        raise ViewerFailed(
            f'--bind {one_line(bind, 60)}: expected an IP address such as {THIS_MACHINE}, this '
            'machine alone, or 0.0.0.0, everybody who reaches it'
        ) from None


class Viewer:
    """Viewer in a process of its own while entered.

    Parameters
    ----------
    kind
        ``window``, ``web`` for a page to be opened in a browser, or ``headless`` for pictures.
    bind
        Address on which it listens. Whoever reaches another one than that of this machine sees the
        tow, and can add to it.
    port
        Of the web page, whose data are at the next one; by default free ones.
    memory_mb
        Beyond it the oldest data are given up.
    environment
        Variables of this process.

    Raises
    ------
    ViewerFailed
        If there is no display for a window, a port is taken, or it does not start.
    """

    def __init__(
        self,
        kind: Kind,
        *,
        bind: str = THIS_MACHINE,
        port: int | None = None,
        memory_mb: int = 2000,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        if kind == 'window' and not any(environment.get(name) for name in DISPLAYS):
            raise ViewerFailed(
                f'no display ({" and ".join(DISPLAYS)} are empty) for the window of the viewer; '
                'expected one, or --web for a page in a browser, or --out FILE.rrd'
            )
        self._kind = kind
        self._bind = address_of(bind)
        self._environment = environment
        page, data = _ports(self._bind, port)
        host = _reached(self._bind)
        self.url = f'rerun+http://{host}:{data}/proxy'
        self.page = f'http://{host}:{page}/?url=rerun%2Bhttp%3A%2F%2F{host}%3A{data}%2Fproxy'
        self._port = data
        own: dict[Kind, list[str]] = {
            'window': ['--hide-welcome-screen', '--expect-data-soon'],
            'web': ['--serve-web', '--web-viewer-port', str(page)],
            'headless': ['--headless', '--hide-welcome-screen', '--window-size', '1920x1080'],
        }
        memory = f'{memory_mb}MB'
        self._arguments = [
            *('--bind', self._bind, '--port', str(data)),
            *('--memory-limit', memory, '--server-memory-limit', memory),
            *own[kind],
        ]

    @property
    def running(self) -> bool:
        """True until it is closed."""
        return self._process.poll() is None

    def check(self) -> None:
        """Check that it did not end by itself because of an error.

        Raises
        ------
        ViewerFailed
            With its last words.
        """
        if self._process.poll():
            raise ViewerFailed(f'the viewer has ended: {self._last_words()}; expected {NEEDS}')

    def wait(self, seconds: float) -> None:
        """Wait until it is closed, at most so long."""
        try:
            self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return

    def __enter__(self) -> 'Viewer':
        self._folder = TemporaryDirectory(prefix='trawl_view_')
        try:
            self._start(Path(self._folder.name))
        except BaseException:
            self._folder.cleanup()
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._end()
        self._folder.cleanup()

    def _start(self, folder: Path) -> None:
        environment = _silent(self._environment, folder)
        self._log = folder / 'log'
        with self._log.open('wb') as log:
            # A session of its own: Ctrl-C is for the command, which then ends it.
            self._process = subprocess.Popen(
                [EXECUTABLE, *self._arguments],
                env=environment,
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

    def _wait_for_port(self) -> None:
        end = time.monotonic() + STARTS_S
        while not _listens(_reached(self._bind), self._port):
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

    They are switched in the user's configuration alone, so this one has a configuration of its own.
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


def _reached(bind: str) -> str:
    """Return the host by which this machine reaches an address on which it listens."""
    address = ipaddress.ip_address(bind)
    if address.is_unspecified:
        return THIS_MACHINE if address.version == 4 else '[::1]'
    return bind if address.version == 4 else f'[{bind}]'


def _ports(bind: str, wanted: int | None) -> tuple[int, int]:
    """Two ports that are free, one after the other where the first is wanted."""
    asked: Sequence[int] = (0, 0) if wanted is None else (wanted, wanted + 1)
    family = socket.AF_INET if ipaddress.ip_address(bind).version == 4 else socket.AF_INET6
    ears = []
    try:
        for port in asked:
            ear = socket.socket(family, socket.SOCK_STREAM)
            ears.append(ear)
            ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                ear.bind((bind, port))
            except OSError as reason:
                raise ViewerFailed(
                    f'{bind} port {port}: cannot be listened on ({reason.strerror}); expected an '
                    'address of this machine and a free port'
                ) from reason
        page, data = (ear.getsockname()[1] for ear in ears)
        return page, data
    finally:
        for ear in ears:
            ear.close()


def _listens(host: str, port: int) -> bool:
    try:
        with socket.create_connection((host.strip('[]'), port), 1.0):
            return True
    except OSError:
        return False
