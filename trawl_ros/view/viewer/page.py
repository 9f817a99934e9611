# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Page of the viewer, which may connect only to the data of the tow.

Rerun's own page sends usage statistics and requests news and a font, and has no setting against
this. A browser enforces the policy that comes with a page, whatever the page does.
"""

import os
from collections.abc import Mapping
from functools import partial
from http.server import SimpleHTTPRequestHandler
from pathlib import Path
from socketserver import TCPServer, ThreadingMixIn
from threading import Thread
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.request import ProxyHandler, build_opener

from trawl_ros.core.network import THIS_MACHINE
from trawl_ros.view.viewer.ports import family_of, two_ports
from trawl_ros.view.viewer.process import RerunProcess, ViewerFailed

FILES = ('index.html', 're_viewer.js', 're_viewer_bg.wasm', 'favicon.ico')
FETCH_S = 30.0

POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; "
    "worker-src 'self' blob:; connect-src 'self' data: blob: http://*:{data}; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""Content security policy of the page; a browser may use any name of this machine."""


class Page:
    """Server of the page while entered.

    Parameters
    ----------
    address
        Address on which it listens, and port.
    data
        Port of the data.
    folder
        For the files of the page.
    environment
        Variables of this process.

    Raises
    ------
    ViewerFailed
        If the port is taken, or Rerun does not give its page.
    """

    def __init__(
        self,
        address: tuple[str, int],
        data: int,
        folder: Path,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        self._files = folder / 'page'
        self._files.mkdir()
        _copy(self._files, folder, environment)
        handler = partial(_Handler, directory=str(self._files), policy=POLICY.format(data=data))
        try:
            self._server = _Server(address, handler)
        except OSError as reason:
            host, port = address
            raise ViewerFailed(
                f'{host} port {port}: cannot be listened on ({reason.strerror}); expected a free '
                'port'
            ) from reason
        self._thread = Thread(target=self._server.serve_forever, name='page', daemon=True)

    def __enter__(self) -> 'Page':
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


class _Server(ThreadingMixIn, TCPServer):
    """HTTP server that does not look up its own name."""

    allow_reuse_address = True
    daemon_threads = True

    def __init__(self, address: tuple[str, int], handler: Any) -> None:
        self.address_family = family_of(address[0])
        super().__init__(address, handler)


class _Handler(SimpleHTTPRequestHandler):
    """Handler of one request for a file of the page."""

    timeout = FETCH_S

    def __init__(self, *given: Any, policy: str, **named: Any) -> None:
        self._policy = policy
        super().__init__(*given, **named)

    def end_headers(self) -> None:
        self.send_header('Content-Security-Policy', self._policy)
        self.send_header('Referrer-Policy', 'no-referrer')
        super().end_headers()

    def log_message(self, *_: Any) -> None:
        """Log nothing about requests."""


def _copy(files: Path, folder: Path, environment: Mapping[str, str]) -> None:
    """Let Rerun serve its page to this process alone, until it is copied."""
    page, data = two_ports(THIS_MACHINE, None)
    arguments = [
        *('--bind', THIS_MACHINE, '--port', str(data)),
        *('--serve-web', '--web-viewer-port', str(page)),
    ]
    # No proxy of the environment is asked for what is on this machine.
    opener = build_opener(ProxyHandler({}))
    with RerunProcess(arguments, (THIS_MACHINE, page), folder, environment):
        for name in FILES:
            path = '' if name == 'index.html' else name
            try:
                with opener.open(f'http://{THIS_MACHINE}:{page}/{path}', timeout=FETCH_S) as given:
                    (files / name).write_bytes(given.read())
            except HTTPError as reason:
                if name != FILES[-1]:
                    raise ViewerFailed(f'the viewer gives no {name} ({reason})') from reason
            except (URLError, OSError) as reason:
                raise ViewerFailed(f'the viewer gives no {name} ({reason})') from reason
