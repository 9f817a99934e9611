"""Worker thread that diagnoses a tow in progress."""

from collections.abc import Callable, Generator
from dataclasses import dataclass
from queue import SimpleQueue
from threading import Event, Lock, Thread

from trawl_ros.core.errors import sentence_of
from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.nodes.workers.identification_worker import POLL_S

Windows = tuple[SteadyWindow, ...]


@dataclass(frozen=True)
class DiagnosisOutcome:
    """Result of a diagnosis of the newest windows, or its error."""

    diagnosis: Diagnosis | None = None
    trouble: str = ''


class WatchingThread(Thread):
    """Worker thread that diagnoses all windows so far; of several sets the newest counts.

    Coroutines may await the thread: that lasts until the newest windows are diagnosed.

    Parameters
    ----------
    diagnose
        From windows to a diagnosis.
    on_outcome
        Called in this thread after each look, but not after one at windows that are forgotten.
    """

    def __init__(
        self,
        diagnose: Callable[[Windows], Diagnosis],
        on_outcome: Callable[[DiagnosisOutcome], None],
    ) -> None:
        super().__init__(name='diagnosis', daemon=True)
        self._diagnose = diagnose
        self._on_outcome = on_outcome
        self._queue: SimpleQueue[None] = SimpleQueue()
        self._handing_over = Lock()
        self._newest: Windows | None = None
        self._forgotten = 0
        self._stopped = False
        self._at_rest = Event()
        self._at_rest.set()

    @property
    def idle(self) -> bool:
        """True if the newest windows are diagnosed."""
        return self._at_rest.is_set()

    def look_at(self, windows: Windows) -> None:
        """Hand over all windows so far."""
        with self._handing_over:
            self._newest = windows
            self._at_rest.clear()
        self._queue.put(None)

    def forget(self) -> None:
        """Discard the windows that were handed over before."""
        with self._handing_over:
            self._newest = None
            self._forgotten += 1

    def stop(self) -> None:
        """End the thread after its queued work, and wait for it."""
        self._stopped = True
        self._queue.put(None)
        self.join()

    def __await__(self) -> Generator[None, None, None]:
        # Some executors ask again at once, which would take the processor from this thread.
        while not self._at_rest.wait(POLL_S):
            yield

    def run(self) -> None:
        """Diagnose until stopped."""
        while not (self._stopped and self.idle):
            self._queue.get()
            with self._handing_over:
                windows, self._newest = self._newest, None
                forgotten = self._forgotten
            if windows is not None:
                outcome = self._attempt(windows)
                with self._handing_over:
                    if forgotten == self._forgotten:
                        self._on_outcome(outcome)
            with self._handing_over:
                if self._newest is None:
                    self._at_rest.set()

    def _attempt(self, windows: Windows) -> DiagnosisOutcome:
        try:
            return DiagnosisOutcome(self._diagnose(windows))
        except Exception as reason:
            # Unsaid, it would end the thread: the node would look alive and diagnose nothing.
            return DiagnosisOutcome(trouble=sentence_of(reason))
