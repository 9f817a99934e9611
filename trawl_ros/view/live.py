# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Live view: a separate thread shows records in bounded memory, whatever the viewer does."""

import time
from collections import deque
from collections.abc import Callable, Collection
from contextlib import ExitStack
from pathlib import Path
from threading import Event, Lock, Thread

from trawl_ros.core.errors import TrawlError, sentence_of
from trawl_ros.core.time import SECOND
from trawl_ros.view.recording import to_file, to_viewer
from trawl_ros.view.records import Coefficients, Innovations, Note, Shown
from trawl_ros.view.rerun_log import RerunLog
from trawl_ros.view.viewer.rerun_library import rr
from trawl_ros.view.viewer.viewer import Kind, Viewer

WAITING_RECORDS = 5000
"""Largest number of waiting records; beyond it the oldest are dropped and counted."""

FLUSH_S = 0.25
IDLE_S = 0.02

BACK_S = 120.0
CONFIRM = 20
"""Number of records in a row with stamps far back that start a new tow."""

LAGGING = (Coefficients, Innovations, Note)
"""Records of windows, which are computed later than they are stamped: they start no new tow."""

ENDS_S = 15.0


class LiveView:
    """View of a running graph.

    Parameters
    ----------
    topics
        Relative names of the topics that there may be.
    kind
        Of the viewer; not looked at where there is an output.
    bind, port, memory_mb
        As for `Viewer`.
    output
        File to be recorded in place of a viewer; None for a viewer.

    Attributes
    ----------
    page : str
        Address of the web page; empty without one.
    shown, lost : int
        Records that were shown, and those given up.
    trouble : str
        Reason why nothing is shown any more; empty while all is well.
    """

    def __init__(
        self,
        topics: Collection[str],
        kind: Kind,
        *,
        bind: str,
        port: int | None,
        memory_mb: int,
        output: Path | None,
    ) -> None:
        self.page = ''
        self.shown, self.lost = 0, 0
        self.trouble = ''
        self._topics = topics
        self._output = output
        self._waiting: deque[Shown] = deque()
        self._lock, self._stop = Lock(), Event()
        self._newest: int | None = None
        self._back = 0
        self._viewer: Viewer | None = None
        self._stack = ExitStack()
        if output is None:
            viewer = Viewer(kind, bind=bind, port=port, memory_mb=memory_mb)
            self._viewer = self._stack.enter_context(viewer)
            self.page = viewer.page if kind == 'web' else ''
        self._tows = 0
        self._log: RerunLog | None = None
        self._tow = ExitStack()
        try:
            self._begin()
        except BaseException:
            self._stack.close()
            raise
        self._thread = Thread(target=self._run, name='view', daemon=True)
        self._thread.start()

    @property
    def closed(self) -> bool:
        """True once the viewer was closed.

        Raises
        ------
        TrawlError
            If it ended because of an error.
        """
        if self._viewer is None or self._viewer.running:
            return False
        self._viewer.check()
        return True

    @property
    def waiting(self) -> int:
        """Number of waiting records."""
        return len(self._waiting)

    def put(self, record: Shown) -> None:
        """Add a record."""
        with self._lock:
            self._waiting.append(record)
            if len(self._waiting) > WAITING_RECORDS:
                self._waiting.popleft()
                self.lost += 1

    def close(self) -> None:
        """Show the waiting records if the viewer accepts them, and end the viewer."""
        self._stop.set()
        self._thread.join(ENDS_S)
        # The viewer goes first where it hangs: what waits for it then ends.
        hangs = self._thread.is_alive()
        for stack in (self._stack, self._tow) if hangs else (self._tow, self._stack):
            try:
                stack.close()
            except TrawlError as reason:
                self.trouble = self.trouble or str(reason)

    def _begin(self) -> None:
        """Start a recording: of the first tow, or of a new one after the stamps went back."""
        if self._log is not None:
            self._log.flush()
        self._tow.close()
        self._tows += 1
        recording: rr.RecordingStream
        if self._output is not None:
            path = self._output
            if self._tows > 1:
                path = path.with_stem(f'{path.stem}_{self._tows}')
            recording = self._tow.enter_context(to_file(path, force=False))
        else:
            assert self._viewer is not None
            recording = self._tow.enter_context(to_viewer(self._viewer.url))
        self._log = RerunLog(recording, self._topics, live=True)
        self._newest = None

    def _run(self) -> None:
        flushed = time.monotonic()
        try:
            while not (self._stop.is_set() and not self._waiting):
                record = self._next()
                if record is not None:
                    self._show(record)
                else:
                    self._stop.wait(IDLE_S)
                if time.monotonic() - flushed > FLUSH_S:
                    self._logged(RerunLog.flush)
                    flushed = time.monotonic()
            self._logged(RerunLog.flush)
        except Exception as reason:
            self.trouble = sentence_of(reason)

    def _next(self) -> Shown | None:
        with self._lock:
            return self._waiting.popleft() if self._waiting else None

    def _show(self, record: Shown) -> None:
        if not isinstance(record, LAGGING):
            if self._newest is not None and record.stamp < self._newest - BACK_S * SECOND:
                self._back += 1
                if self._back < CONFIRM:
                    return
                self._begin()
            self._back = 0
            self._newest = max(record.stamp, self._newest or record.stamp)
        self._logged(lambda log: log.show(record))
        self.shown += 1

    def _logged(self, act: Callable[[RerunLog], None]) -> None:
        assert self._log is not None
        act(self._log)
