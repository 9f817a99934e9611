# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Viewer of Rerun: its window, or its page in a browser; by default for this machine only."""

import os
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

from trawl_ros.core.network import THIS_MACHINE, is_this_machine
from trawl_ros.view.viewer.page import Page
from trawl_ros.view.viewer.ports import address_of, in_url, reached, two_ports
from trawl_ros.view.viewer.process import RerunProcess, ViewerFailed

Kind = Literal['window', 'web', 'headless']

DISPLAYS = ('DISPLAY', 'WAYLAND_DISPLAY')


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
        self._page_port, self._data_port = two_ports(self._bind, port)
        host = in_url(reached(self._bind))
        self.url = f'rerun+http://{host}:{self._data_port}/proxy'
        asked = self.url.replace('+', '%2B').replace(':', '%3A').replace('/', '%2F')
        self.page = f'http://{host}:{self._page_port}/?url={asked}'
        own: dict[Kind, list[str]] = {
            'window': ['--hide-welcome-screen', '--expect-data-soon'],
            'web': ['--serve-grpc', *self._origins()],
            'headless': ['--headless', '--hide-welcome-screen', '--window-size', '1920x1080'],
        }
        memory = f'{memory_mb}MB'
        self._arguments = [
            *('--bind', self._bind, '--port', str(self._data_port)),
            *('--memory-limit', memory, '--server-memory-limit', memory),
            *own[kind],
        ]

    def _origins(self) -> list[str]:
        """Allow the page to be opened by any name of this machine."""
        if is_this_machine(self._bind):
            return []
        return ['--cors-allow-origin', f'http://*:{self._page_port}']

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def running(self) -> bool:
        """True until it is closed."""
        return self._process.running

    def check(self) -> None:
        """Raise an error if it ended by itself with an error.

        Raises
        ------
        ViewerFailed
            With its last words.
        """
        self._process.check()

    def wait(self, seconds: float) -> None:
        """Wait until it is closed, at most this long."""
        self._process.wait(seconds)

    def __enter__(self) -> 'Viewer':
        with ExitStack() as stack:
            folder = Path(stack.enter_context(TemporaryDirectory(prefix='trawl_view_')))
            if self._kind == 'web':
                address = self._bind, self._page_port
                page = Page(address, self._data_port, folder, self._environment)
                stack.enter_context(page)
            at = reached(self._bind), self._data_port
            process = RerunProcess(self._arguments, at, folder, self._environment)
            self._process = stack.enter_context(process)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()
