# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fit of tows that grow: solved again with each stretch, linearised again where it has moved.

The model is towed along each stretch of the tows once, as it comes, and what is linearised so far
is solved again. Where the estimate has moved from the place of that linearisation, all so far is
towed again there, some stretches with each new one, so that no estimate waits for it. At the end
of the tows a fit from beginning to end (`fit`) has the last word.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.descent import Damping, Rest
from trawl_ros.estimation.least_squares.linear_problem import Place
from trawl_ros.estimation.motion.fit import NEAR
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.growing import GrowingLinearisation
from trawl_ros.estimation.motion.nuisances import layout_of, place_at
from trawl_ros.estimation.motion.processes import ErrorSizes
from trawl_ros.estimation.motion.search import (
    COOLING_FACTOR,
    MotionSearch,
    is_lost,
    towed_flags,
)
from trawl_ros.estimation.motion.steps import linear_problem, misfit
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear

AHEAD = 16
"""Stretches that are towed along again, at most, with each new one."""

HOLDS, FAR = 0.5, 1.0
"""Parts of every std from the place of the linearisation within which an estimate begins to hold,
and beyond which it ends to."""

GROWN = 1.5
"""Factor by which a tow grows before sizes of the errors are found again, or a step is tried again
that was refused."""

MOST_FOUND = 240
"""Stretches of a tow for which sizes are found, at most: it takes the longer the more these are."""


@dataclass(frozen=True)
class TrackedFit:
    """Fit of tows as they are so far.

    Attributes
    ----------
    fit
        Linearised where the model was towed last; converged where it holds.
    moved
        Largest distance of a coefficient from there, in std.
    towings
        Number of times that the model was towed along the tows.
    """

    fit: MotionFit
    moved: float
    towings: int


class MotionTracker:
    """Fit of tows that grow.

    Parameters
    ----------
    gear, prior
        The gear that is towed, and the prior of its coefficients.
    options
        Of the fit.
    """

    def __init__(self, gear: TowedGear, prior: ParameterVector, options: MotionOptions) -> None:
        self._towed, self._prior, self._options = gear, prior, options
        self._here: GrowingLinearisation | None = None
        self._next: GrowingLinearisation | None = None
        self._newest: MotionSearch | None = None
        self._found: TrackedFit | None = None
        self._sizes, self._temper = options.sizes, np.inf
        self._weights: dict[int, FloatArray] = {}
        self._damping, self._refused, self._again = Damping(), 0, 0.0
        self._found_at, self._started_with = 0, 0
        self._towings, self._held = 0, False

    def update(self, tows: Sequence[MovingTow]) -> TrackedFit | None:
        """Solve for tows as they are now.

        Returns
        -------
        TrackedFit or None
            None as long as the model is towed along them for the first time.
        """
        self._newest = self._search(tows)
        self._found = self._solved(self._newest)
        return self._found

    def catch_up(self, windows: Estimate | None) -> None:
        """Do a part of the work on another linearisation, behind an update.

        Parameters
        ----------
        windows
            Estimate of the steady windows, where there is one.
        """
        search = self._newest
        if search is None:
            return
        if self._next is None:
            self._next = self._candidate(search, self._found, windows)
        if self._next is not None and self._next.extend(search.tows, AHEAD):
            self._compare(search, self._next)
            self._next = None

    def _search(self, tows: Sequence[MovingTow]) -> MotionSearch:
        """Search with the linearisation as it is, where there is one."""
        layouts = tuple(layout_of(tow, self._towed, self._options.model) for tow in tows)
        search = MotionSearch(
            self._towed, tows, layouts, self._prior, self._options, lambda *_: None,
            [np.zeros(len(layout)) for layout in layouts],
        )  # fmt: skip
        search.noise = tuple(self._weighted(tow) for tow in tows)
        if self._here is not None:
            self._here.extend(tows)
            self._take(search, self._here)
        return search

    @staticmethod
    def _take(search: MotionSearch, linearisation: GrowingLinearisation) -> None:
        search.linear = linearisation.linearised(search.tows)
        search.here = linearisation.place(search.tows, search.layouts)

    def _weighted(self, tow: MovingTow) -> FloatArray:
        """Noise (n, k) of a tow's means by the weights that were found last."""
        known, noise = self._weights.get(tow.start_ns), np.array(tow.noise)
        if known is not None and known.shape[1] == noise.shape[1]:
            rows = min(len(known), len(noise))
            noise[:rows] *= known[:rows]
        return noise

    def _solved(self, search: MotionSearch) -> TrackedFit | None:
        """Fit where the tows are linearised, and how far from there it leads."""
        if self._here is None:
            return None
        sizes = self._sized(search).tempered(self._temper)
        place = search.target(sizes)
        fit = search.fit(sizes, place, Rest(False, '', self._towings, np.inf))
        if not fit.readings:
            return None
        away = self._prior.std * np.abs((place[0] - search.here[0])[: len(self._prior)])
        moved = float(np.max(away / np.sqrt(np.diag(fit.covariance))))
        self._held = self._temper == 1.0 and moved < (FAR if self._held else HOLDS)
        reason = f'{moved:.2g} std from where the model was towed'
        if self._temper > 1.0:
            reason += f', all errors taken for {self._temper:.2g} times as large'
        fit = replace(fit, converged=self._held, reason=reason)
        return TrackedFit(fit, moved, self._towings)

    def _sized(self, search: MotionSearch) -> ErrorSizes:
        """Sizes of the errors, found again where the tow has grown."""
        stretches = sum(map(len, search.tows))
        grown = stretches > GROWN * self._found_at and stretches <= MOST_FOUND
        if self._temper == 1.0 and grown:
            self._found_at = stretches
            self._sizes = search.find(self._sizes)
            for tow, noise in zip(search.tows, search.noise, strict=True):
                self._weights[tow.start_ns] = np.nan_to_num(noise / tow.noise, nan=1.0)
        return self._sizes

    def _candidate(
        self,
        search: MotionSearch,
        found: TrackedFit | None,
        windows: Estimate | None,
    ) -> GrowingLinearisation | None:
        """Place to tow all of it along again at, if there is reason to."""
        known = 0 if windows is None else windows.windows
        waits = found is None or sum(map(len, search.tows)) < self._again
        # Windows are no place to go back to, but where there is no other way on.
        lost = not self._held and known > self._started_with and (waits or not self._started_with)
        if self._here is None or lost:
            self._started_with = known
            return self._linearisation(search, self._start(search, windows))
        if found is None or waits:
            return None
        if found.moved < NEAR:
            self._cool(COOLING_FACTOR * self._temper)
            return None
        problem = search.problem(self._sizes.tempered(self._temper))
        there = problem.target(self._damping.value)
        return self._linearisation(search, there)

    def _linearisation(self, search: MotionSearch, place: Place) -> GrowingLinearisation:
        return GrowingLinearisation(
            self._towed, self._prior, search.tows, search.layouts, list(place)
        )

    def _start(self, search: MotionSearch, windows: Estimate | None) -> Place:
        if windows is None:
            return search.here
        return place_at(windows.values, self._prior, search.layouts)

    def _compare(self, search: MotionSearch, tried: GrowingLinearisation) -> None:
        """Take a linearisation for that in use if its cost is lower."""
        self._towings += 1
        sizes = self._sizes.tempered(self._temper)
        linear, there = tried.linearised(search.tows), tried.place(search.tows, search.layouts)
        free = _none_of_the_gear(search)
        if self._here is not None and (
            is_lost(towed_flags(linear), towed_flags(search.linear))
            or not search.is_lower(linear, there, sizes, free)
        ):
            self._refused += 1
            self._damping.refuse()
            if self._refused >= self._options.attempts:
                self._refused, self._damping = 0, Damping()
                self._cool(COOLING_FACTOR * self._temper)
                self._again = GROWN * sum(map(len, search.tows))
            return
        self._here, self._refused = tried, 0
        self._damping.accept()
        data = search.data(linear, there)
        problem = linear_problem(data, there, self._prior, self._sizes, self._options.largest_step)
        rest = misfit(data, problem, problem.projected(there, free))
        self._cool(min(COOLING_FACTOR * self._temper, rest))

    def _cool(self, temper: float) -> None:
        """Take errors of stretches for so many times as large, and no less than at the end."""
        self._temper = max(1.0, temper)


def _none_of_the_gear(search: MotionSearch) -> list[BoolArray]:
    """Flags (p,) of the parameters of each tow that are none of the gear itself.

    Stretches that came after a linearisation began were towed without errors of their own.
    """
    return [np.arange(len(layout)) >= layout.of_gear for layout in search.layouts]
