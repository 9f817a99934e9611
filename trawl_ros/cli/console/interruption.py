# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Handling of Ctrl-C, deferred to the next safe moment."""

import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

INTERRUPTED = 130
"""Exit code of an interrupted command, as in shells: 128 + SIGINT."""


class Interruption:
    """Deferred interruption: the first SIGINT or SIGTERM sets a flag, and a second one raises.

    The writer can so stop between two messages, not within one.
    """

    def __init__(self) -> None:
        self.requested = False

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.requested:
            raise KeyboardInterrupt
        self.requested = True

    def __enter__(self) -> 'Interruption':
        self._before = {
            number: signal.signal(number, self._note) for number in (signal.SIGINT, signal.SIGTERM)
        }
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)


class Uninterrupted:
    """Blocked interruption: SIGINT and SIGTERM wait until the context is left.

    Python can interrupt between any two instructions, for example between the start of a process
    and the record that it was started. Handlers are used instead of a signal mask, because a child
    would inherit the mask and not react to signals. Only the main thread is ever interrupted, so in
    other threads this does nothing.

    Parameters
    ----------
    noted
        Function that is called at a signal; it must not raise.
    """

    def __init__(self, noted: Callable[[], None] = lambda: None) -> None:
        self._noted = noted
        self._waiting: list[int] = []
        self._before: dict[int, Any] = {}

    def _note(self, number: int, frame: FrameType | None) -> None:
        self._waiting.append(number)
        self._noted()

    def __enter__(self) -> 'Uninterrupted':
        if threading.current_thread() is threading.main_thread():
            try:
                for number in (signal.SIGINT, signal.SIGTERM):
                    self._before[number] = signal.getsignal(number)
                    signal.signal(number, self._note)
            except BaseException:
                self._restore()
                raise
        return self

    def __exit__(self, *_: object) -> None:
        self._restore()
        if self._waiting:
            signal.raise_signal(self._waiting[0])

    def _restore(self) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
