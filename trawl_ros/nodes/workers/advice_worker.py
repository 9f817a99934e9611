"""Advice on the next manoeuvre, computed in a thread of its own with spare time."""

import time
from collections.abc import Callable
from queue import Empty, SimpleQueue
from threading import Thread

from trawl_ros.core.errors import sentence_of
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.planning.next_manoeuvre import Advice, Adviser

SHARE = 0.1
"""Part of a core that looking manoeuvres up may take."""

IDLE_S = 0.1
"""Wait before it asks again whether the estimator is at rest."""


class AdvisingThread(Thread):
    """Chooses the next manoeuvre after each window, and anew whenever more are known.

    Parameters
    ----------
    adviser
        Nobody else may use it, or its predictor, from now on.
    at_rest
        True if the estimator has nothing to do: it comes first.
    on_advice
        Called in this thread with the advice, or None where there is none, and with what went
        wrong, '' for nothing.
    """

    def __init__(
        self,
        adviser: Adviser,
        at_rest: Callable[[], bool],
        on_advice: Callable[[Advice | None, str], None],
    ) -> None:
        super().__init__(name='advising', daemon=True)
        self._adviser = adviser
        self._at_rest = at_rest
        self._on_advice = on_advice
        self._fits: SimpleQueue[Fit | None] = SimpleQueue()
        self._fit: Fit | None = None
        self._stopped = False

    def fitted(self, fit: Fit) -> None:
        """Hand over the newest fit; one without windows withdraws the advice."""
        self._fits.put(fit)

    def stop(self) -> None:
        """End the thread, and wait for it."""
        self._stopped = True
        self._fits.put(None)
        self.join()

    def run(self) -> None:
        """Advise until stopped."""
        rest: float | None = None
        while not self._stopped:
            if self._new_fit(rest):
                rest = IDLE_S if self._attempt(self._advise) else None
            elif not self._at_rest():
                rest = IDLE_S
            else:
                began = time.thread_time()
                more = self._attempt(self._look_up)
                rest = (time.thread_time() - began) * (1.0 / SHARE - 1.0) if more else None

    def _new_fit(self, timeout: float | None) -> bool:
        """Wait for a fit; of several the newest counts."""
        try:
            fit = self._fits.get(timeout=timeout)
            while not self._fits.empty():
                fit = self._fits.get()
        except Empty:
            return False
        if fit is not None:
            self._fit = fit
        return fit is not None

    def _attempt(self, act: Callable[[Fit], bool]) -> bool:
        if self._fit is None:
            return False
        try:
            return act(self._fit)
        except Exception as reason:
            # Without advice the node still estimates, so this ends the thread's work on this fit.
            self._on_advice(None, sentence_of(reason))
        return False

    def _advise(self, fit: Fit) -> bool:
        self._on_advice(self._adviser.advise(fit), '')
        return bool(fit.windows)

    def _look_up(self, fit: Fit) -> bool:
        return self._adviser.look_up(fit.coefficients) and self._advise(fit)
