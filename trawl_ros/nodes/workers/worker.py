# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Worker thread that does queued work in order and survives its errors."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator
from queue import Empty, SimpleQueue
from threading import Event, Lock, Thread
from typing import Generic, TypeVar

from trawl_ros.core.errors import sentence_of

Work = TypeVar('Work')

POLL_S = 0.005
"""Time for which an awaiting executor is held up; some would ask again at once otherwise, and
take the processor from the worker.
"""


class Worker(Thread, ABC, Generic[Work]):
    """Worker thread with one queue; nothing that its work uses may be used by other threads.

    Coroutines may await the worker: that lasts until all queued work is done.

    Parameters
    ----------
    name
        Name of the thread.

    Attributes
    ----------
    troubles : dict of str to str
        Activity → the sentence of its last error.
    """

    def __init__(self, name: str) -> None:
        super().__init__(name=name, daemon=True)
        self._queue: SimpleQueue[Work | None] = SimpleQueue()
        self._counting = Lock()
        self._waiting = 0
        self._at_rest = Event()
        self._at_rest.set()
        self.troubles: dict[str, str] = {}

    @property
    def idle(self) -> bool:
        """True if all queued work is done."""
        return self._at_rest.is_set()

    def put(self, work: Work) -> None:
        """Queue work."""
        with self._counting:
            self._waiting += 1
            self._at_rest.clear()
        self._queue.put(work)

    def stop(self) -> None:
        """End the thread after its queued work, and wait for it."""
        self._queue.put(None)
        self.join()

    @abstractmethod
    def do(self, work: Work) -> None:
        """Do a piece of work, in this thread."""

    def patience_s(self) -> float | None:
        """Return the time (s) without work after which `be_quiet` is called; None for never."""
        return None

    def be_quiet(self) -> None:
        """Act on a lack of work, in this thread."""

    def attempt(self, activity: str, act: Callable[[], None]) -> bool:
        """Run an action; keep the sentence of its error in `troubles`. Return True on success.

        An uncaught error would end the thread: the node would look alive and do nothing.
        """
        try:
            act()
        except Exception as reason:
            self.troubles[activity] = sentence_of(reason)
            return False
        return True

    def run(self) -> None:
        """Work until stopped."""
        while True:
            try:
                work = self._queue.get(timeout=self.patience_s())
            except Empty:
                self.be_quiet()
                continue
            if work is None:
                return
            try:
                self.do(work)
            finally:
                with self._counting:
                    self._waiting -= 1
                    if not self._waiting:
                        self._at_rest.set()

    def __await__(self) -> Generator[None, None, None]:
        while not self._at_rest.wait(POLL_S):
            yield
