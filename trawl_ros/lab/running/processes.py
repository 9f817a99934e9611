# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Processes of nodes, which are started, watched and ended together."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from trawl_ros.cli.console.interruption import Uninterrupted
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import made_folder

ENDED = (0, -signal.SIGINT)
"""Return codes of an interrupted node; the second one had not been imported yet, and had begun
nothing."""

LAST_LINES = 15
"""Number of output lines shown of a process that failed."""

END_S = 20.0
"""Time (s) that a process has to end after it was asked to."""

POLL_S = 0.02

Value = str | int | float | bool | list[str]


class NodeFailed(TrawlError):
    """Node that ended when it should not have, or could not end cleanly."""


class Processes:
    """Child processes, one per node; leaving the context ends all that still run.

    Parameters
    ----------
    logs
        Folder that takes what each of them says.
    environment
        Variables they get besides those of this process.
    """

    def __init__(self, logs: Path, environment: Mapping[str, str]) -> None:
        self._logs = logs
        self._environment = {**os.environ, **environment}
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        made_folder(logs)

    def start(self, node: str, **parameters: Value) -> None:
        """Start a node of this package with ROS parameters."""
        # JSON is YAML, so strings stay strings whatever is in them.
        options = [
            word
            for key, value in parameters.items()
            for word in ('-p', f'{key}:={json.dumps(value)}')
        ]
        code = (
            # Until the node hears it, the signal ends the process: an extension that is being
            # imported makes an ImportError of a KeyboardInterrupt.
            'import signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); '
            'signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT]); '
            f"sys.argv[0] = '{node}'; from trawl_ros.nodes.{node} import main; sys.exit(main())"
        )
        command = [sys.executable, '-c', code, '--ros-args', *options]
        # Anew: what is there may be a link to something else.
        self._log(node).unlink(missing_ok=True)
        with self._log(node).open('xb') as log, Uninterrupted(), _born_deaf():
            # A session of their own: Ctrl-C is for the demo, which ends them in good order.
            self._running[node] = subprocess.Popen(
                command,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    def check(self) -> None:
        """Raise `NodeFailed`, with the last output, if a node has ended by itself."""
        for node, process in self._running.items():
            if process.poll() is not None:
                raise NodeFailed(self._failure(node, process.returncode))

    def finished(self, node: str) -> bool:
        """True if a node that ends by itself has done so; the others are checked.

        Raises
        ------
        NodeFailed
            If it, or another one, has failed.
        """
        code = self._running[node].poll()
        if code == 0:
            del self._running[node]
        self.check()
        return code == 0

    def ended(self) -> dict[str, str]:
        """Return the last output of nodes that ended by themselves, and stop watching them."""
        codes = {node: process.poll() for node, process in self._running.items()}
        over = {node: self._failure(node, code) for node, code in codes.items() if code is not None}
        for node in over:
            del self._running[node]
        return over

    def signal(self, node: str, number: signal.Signals) -> None:
        """Send a signal to a node."""
        self._running[node].send_signal(number)

    def kill(self, node: str) -> None:
        """Kill a node (SIGKILL), and wait until it is gone."""
        process = self._running.pop(node)
        process.kill()
        process.wait()

    def pids(self) -> dict[str, int]:
        """Return the process number of each node that is not known to have ended."""
        return {node: process.pid for node, process in self._running.items()}

    def stop(self, *nodes: str) -> None:
        """Stop nodes as Ctrl-C does, all of them at once.

        Raises
        ------
        NodeFailed
            If one fails in doing so, or does not end in time.
        """
        for node in nodes:
            if self._running[node].poll() is None:
                self._running[node].send_signal(signal.SIGINT)
        for node in nodes:
            try:
                code = self._running[node].wait(END_S)
            except subprocess.TimeoutExpired:
                raise NodeFailed(self._failure(node, None)) from None
            if code not in ENDED:
                raise NodeFailed(self._failure(node, code))
            del self._running[node]

    def _failure(self, node: str, code: int | None) -> str:
        ended = f'did not end within {END_S:g} s' if code is None else f'ended with code {code}'
        text = self._log(node).read_text(encoding='utf-8', errors='replace')
        lines = text.strip().splitlines()[-LAST_LINES:]
        said = '\n'.join(f'    {line}' for line in lines) or '    (nothing)'
        return f'{node} {ended}; its last output ({self._log(node)}):\n{said}'

    def _log(self, node: str) -> Path:
        return self._logs / f'{node}.txt'

    def __enter__(self) -> 'Processes':
        return self

    def __exit__(self, *_: object) -> None:
        # Whoever is impatient shortens what is left to them, but leaves none of them behind.
        with Uninterrupted(self._hasten):
            self._deadline = time.monotonic() + END_S
            for process in self._running.values():
                if process.poll() is None:
                    process.send_signal(signal.SIGINT)
            for process in self._running.values():
                while process.poll() is None and time.monotonic() < self._deadline:
                    time.sleep(POLL_S)
                if process.poll() is None:
                    process.kill()
                    process.wait()
            self._running.clear()

    def _hasten(self) -> None:
        self._deadline = time.monotonic()


@contextmanager
def _born_deaf() -> Iterator[None]:
    """Block SIGINT in a child until the child unblocks it.

    An interpreter that is interrupted before its first line reports a fatal error.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
