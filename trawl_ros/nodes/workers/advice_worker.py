# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Worker thread that advises on the next manoeuvre, with time that nothing else needs."""

import time
from collections.abc import Callable
from threading import Event, Thread

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.planning.advice import Advice
from trawl_ros.estimation.planning.next_manoeuvre import Adviser, manoeuvre_of
from trawl_ros.nodes.workers.worker import Worker

IDLE_S = 0.1
"""Time (s) after which the estimator is asked again whether it is at rest."""


class AdviceWorker(Worker[object]):
    """Worker thread that chooses the next manoeuvre after each window.

    Candidate manoeuvres are solved in a second thread from the beginning on; until the first
    window, with the board as it is believed to be. A choice is made again whenever more of them
    are known.

    Parameters
    ----------
    adviser
        Nobody else may use it, or its predictor, from now on.
    believed
        Coefficients (q,) before the first window.
    share
        Part of a core that solving manoeuvres may take.
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
        super().__init__('advice')
        self._adviser = adviser
        self._believed = believed
        self._share = share
        self._at_rest_elsewhere = at_rest
        self._on_advice = on_advice
        self._fit: Fit | None = None
        self._advice: Advice | None = None
        self._more = True
        self._fresh, self._stopped = Event(), Event()
        # Solving a manoeuvre may take seconds; a new fit must not wait for it.
        self._solving = Thread(target=self._solve_all, name='manoeuvres', daemon=True)

    def fitted(self, fit: Fit) -> None:
        """Hand over the newest fit; one without windows withdraws the advice."""
        self._fit = fit
        self._fresh.set()
        self.put(fit)

    def stop(self) -> None:
        """End both threads, and wait for them."""
        self._stopped.set()
        self._fresh.set()
        super().stop()
        self._solving.join()

    def run(self) -> None:
        """Advise until stopped."""
        self._solving.start()
        super().run()

    def do(self, work: object) -> None:
        """Choose a manoeuvre by the newest fit, once for all that is queued."""
        if self._queue.empty() and not self._stopped.is_set():
            self._telling('advising', self._advise)

    def _advise(self) -> None:
        if self._fit is not None:
            # An error while solving keeps the advice; an error while advising withdraws it.
            self._advice = None
            self._advice = self._adviser.advise(self._fit)
            self._on_advice(self._advice, self._adviser.trouble)

    def _solve_all(self) -> None:
        compiled = False
        while not self._stopped.is_set():
            if not self._at_rest_elsewhere():
                self._stopped.wait(IDLE_S)
                continue
            self._fresh.clear()
            began = time.thread_time()
            if not self._telling('solving', self._solve_next) or not self._more:
                self._fresh.wait()
            elif compiled:
                self._stopped.wait((time.thread_time() - began) * (1.0 / self._share - 1.0))
            # The first one may compile for half a minute, which says nothing of what one costs.
            compiled = True

    def _solve_next(self) -> None:
        fit = self._fit
        if fit is None or not fit.windows:
            self._more = self._adviser.look_up(self._believed)
        else:
            self._more = self._adviser.look_up(fit.coefficients, manoeuvre_of(fit))
        # There is no advice before a fit, and None would end the thread.
        if fit is not None:
            self.put(fit)

    def _telling(self, activity: str, act: Callable[[], None]) -> bool:
        """Attempt an action; an error is only reported, since the node estimates without advice."""
        done = self.attempt(activity, act)
        if not done:
            self._on_advice(self._advice, self.troubles[activity])
        return done
