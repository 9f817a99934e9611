"""The diagnosis of a tow that goes on, in a thread of its own."""

from collections.abc import Callable
from queue import SimpleQueue
from threading import Event, Thread
from traceback import format_exc

from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.errors import TrawlError
from trawl_ros.identification.window_records import SteadyWindow

Windows = tuple[SteadyWindow, ...]


class WatchingThread(Thread):
    """Diagnoses all windows so far whenever there are new ones; of several the newest count.

    Parameters
    ----------
    diagnose
        From windows to a diagnosis.
    told
        Called in this thread with each diagnosis, or None, and with what went wrong, '' for
        nothing.
    """

    def __init__(
        self,
        diagnose: Callable[[Windows], Diagnosis],
        told: Callable[[Diagnosis | None, str], None],
    ) -> None:
        super().__init__(name='diagnosis', daemon=True)
        self._diagnose = diagnose
        self._told = told
        self._queue: SimpleQueue[Windows | None] = SimpleQueue()
        self._at_rest = Event()
        self._at_rest.set()

    @property
    def idle(self) -> bool:
        """Whether the newest windows are diagnosed."""
        return self._at_rest.is_set()

    def look_at(self, windows: Windows) -> None:
        """Hand over all windows so far."""
        self._at_rest.clear()
        self._queue.put(windows)

    def stop(self) -> None:
        """End the thread after what it has to do, and wait for it."""
        self._queue.put(None)
        self.join()

    def run(self) -> None:
        """Diagnose until stopped."""
        last = False
        while not last:
            newest: Windows | None = None
            waiting = [self._queue.get()]
            while not self._queue.empty():
                waiting.append(self._queue.get())
            for windows in waiting:
                last = last or windows is None
                newest = windows if windows is not None else newest
            if newest is not None:
                self._attempt(newest)
            if self._queue.empty():
                self._at_rest.set()

    def _attempt(self, windows: Windows) -> None:
        try:
            self._told(self._diagnose(windows), '')
        except TrawlError as reason:
            self._told(None, str(reason))
        except Exception:
            # Unsaid, it would end the thread: the node would look alive and diagnose nothing.
            self._told(None, f'an error of the program; {format_exc()}')
