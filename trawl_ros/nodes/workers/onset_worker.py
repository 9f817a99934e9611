"""Worker thread that watches a tow in progress for what begins in it."""

from collections.abc import Callable, Generator
from dataclasses import dataclass
from queue import SimpleQueue
from threading import Event, Lock, Thread
from typing import TYPE_CHECKING

from trawl_ros.core.errors import sentence_of
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.nodes.workers.identification_worker import POLL_S
from trawl_ros.records.samples import Sample

if TYPE_CHECKING:
    from trawl_ros.diagnosis.onset.monitor import OnsetMonitor


@dataclass(frozen=True)
class _Reset:
    """Request to begin anew."""


@dataclass(frozen=True)
class _Stop:
    """Request to end the thread."""


class OnsetThread(Thread):
    """Worker thread that feeds a monitor, in the order in which samples come.

    Coroutines may await the thread: that lasts until all samples so far are dealt with.

    Parameters
    ----------
    monitor
        Nobody else may feed it from now on.
    on_finding
        Called in this thread with each finding that is new or has changed.
    dealt_with
        Called in this thread after each sample.
    """

    def __init__(
        self,
        monitor: 'OnsetMonitor',
        on_finding: Callable[[Finding], None],
        dealt_with: Callable[[Sample], None],
    ) -> None:
        super().__init__(name='onset', daemon=True)
        self._monitor, self._on_finding, self._dealt_with = monitor, on_finding, dealt_with
        self._queue: SimpleQueue[Sample | _Reset | _Stop] = SimpleQueue()
        self._using, self._counting = Lock(), Lock()
        self._waiting = 0
        self._at_rest = Event()
        self._at_rest.set()
        self.trouble = ''

    @property
    def idle(self) -> bool:
        """True if all samples are dealt with."""
        return self._at_rest.is_set()

    def feed(self, sample: Sample) -> None:
        """Queue a sample."""
        self._put(sample)

    def reset(self) -> None:
        """Begin anew behind what was queued."""
        self._put(_Reset())

    def dismiss(self, number: int) -> Finding | None:
        """Dismiss a finding between two samples; None where there is no such open one."""
        with self._using:
            return self._monitor.dismiss(number)

    def stop(self) -> None:
        """End the thread after its queued work, and wait for it."""
        self._put(_Stop())
        self.join()

    def __await__(self) -> Generator[None, None, None]:
        # Some executors ask again at once, which would take the processor from this thread.
        while not self._at_rest.wait(POLL_S):
            yield

    def _put(self, work: Sample | _Reset | _Stop) -> None:
        with self._counting:
            self._waiting += 1
            self._at_rest.clear()
        self._queue.put(work)

    def run(self) -> None:
        """Watch until stopped."""
        while True:
            work = self._queue.get()
            try:
                if isinstance(work, _Stop):
                    return
                self._do(work)
            finally:
                with self._counting:
                    self._waiting -= 1
                    if not self._waiting:
                        self._at_rest.set()

    def _do(self, work: Sample | _Reset) -> None:
        try:
            with self._using:
                if isinstance(work, _Reset):
                    self._monitor.reset()
                    return
                findings = self._monitor.feed(work)
            for found in findings:
                self._on_finding(found)
        except Exception as reason:
            # Unsaid, it would end the thread: the node would look alive and watch nothing.
            self.trouble = sentence_of(reason)
        if not isinstance(work, _Reset):
            self._dealt_with(work)
