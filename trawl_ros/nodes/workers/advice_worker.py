"""Advice on the next manoeuvre, computed in threads of its own with spare time."""

import time
from collections.abc import Callable
from queue import SimpleQueue
from threading import Event, Thread

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import sentence_of
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.planning.advice import Advice
from trawl_ros.estimation.planning.next_manoeuvre import Adviser, manoeuvre_of

IDLE_S = 0.1
"""Wait before it asks again whether the estimator is at rest."""


class AdvisingThread(Thread):
    """Chooses the next manoeuvre after each window, and anew whenever more are known.

    Manoeuvres are looked up from the beginning on: until the first window, with the board as it is
    believed to be.

    Parameters
    ----------
    adviser
        Nobody else may use it, or its predictor, from now on.
    believed
        Coefficients (12,) before the first window.
    share
        Part of a core that looking manoeuvres up may take.
    at_rest
        True if the estimator has nothing to do: it comes first.
    on_advice
        Called in these threads with the advice, or None where there is none, and with what went
        wrong, '' for nothing.
    """

    def __init__(
        self,
        adviser: Adviser,
        believed: FloatArray,
        share: float,
        at_rest: Callable[[], bool],
        on_advice: Callable[[Advice | None, str], None],
    ) -> None:
        super().__init__(name='advising', daemon=True)
        self._adviser = adviser
        self._believed = believed
        self._share = share
        self._at_rest = at_rest
        self._on_advice = on_advice
        self._asked: SimpleQueue[None] = SimpleQueue()
        self._fit: Fit | None = None
        self._advice: Advice | None = None
        self._fresh, self._stopped = Event(), Event()
        # A manoeuvre may take seconds to be looked up, for which a fit is not to wait.
        self._looking = Thread(target=self._look, name='looking up', daemon=True)

    def fitted(self, fit: Fit) -> None:
        """Hand over the newest fit; one without windows withdraws the advice."""
        self._fit = fit
        self._fresh.set()
        self._asked.put(None)

    def stop(self) -> None:
        """End the thread, and wait for it."""
        self._stopped.set()
        self._fresh.set()
        self._asked.put(None)
        self.join()
        self._looking.join()

    def run(self) -> None:
        """Advise until stopped."""
        self._looking.start()
        while True:
            self._asked.get()
            while not self._asked.empty():
                self._asked.get()
            if self._stopped.is_set():
                return
            self._attempt(self._advise)

    def _look(self) -> None:
        """Look manoeuvres up until stopped."""
        while not self._stopped.is_set():
            if not self._at_rest():
                self._stopped.wait(IDLE_S)
                continue
            self._fresh.clear()
            began = time.thread_time()
            if self._attempt(self._look_up):
                self._stopped.wait((time.thread_time() - began) * (1.0 / self._share - 1.0))
            else:
                self._fresh.wait()

    def _attempt(self, act: Callable[[], bool]) -> bool:
        try:
            return act()
        except Exception as reason:
            # Without advice the node still estimates, so this ends the thread's work on this fit.
            self._on_advice(self._advice, sentence_of(reason))
        return False

    def _advise(self) -> bool:
        if self._fit is not None:
            # An error in looking up takes no advice away, one in advising does.
            self._advice = None
            self._advice = self._adviser.advise(self._fit)
            self._on_advice(self._advice, self._adviser.trouble)
        return True

    def _look_up(self) -> bool:
        fit = self._fit
        if fit is None or not fit.windows:
            more = self._adviser.look_up(self._believed)
        else:
            more = self._adviser.look_up(fit.coefficients, manoeuvre_of(fit))
        self._asked.put(None)
        return more
