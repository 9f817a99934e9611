# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Search for the most informative manoeuvres within a given time.

The design is built by greedy addition and then improved by exchanges, in the manner of Fedorov's
exchange algorithm for optimal designs (1972).
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.laws import WELL_KNOWN, LawQuantities
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.planning.duration import (
    Leg,
    Timetable,
    VesselLimits,
    arranged,
    minutes_of,
    rest_of,
)
from trawl_ros.estimation.planning.information import (
    covariance_from,
    information_before,
    information_of,
)
from trawl_ros.estimation.planning.law_question import LawQuestion
from trawl_ros.estimation.planning.states import Manoeuvre, TowableManoeuvre
from trawl_ros.estimation.planning.windows import TABLE_NOISE, imagined_windows
from trawl_ros.estimation.windows.records import WindowOptions

MIN_GAIN = 1e-9
"""Smallest fall of the shortfall, or relative rise of its rate, that counts; less is rounding."""

MAX_VISITS_PER_STATE = 2
"""Most visits of a trial to a steady state. The information in a state is computed with assumed
coefficients, so a trial that rests on few states would depend too much on this assumption."""


def shortfall(quantities: LawQuantities) -> float:
    """Return the shortfall, the design criterion (nats) to be minimised.

    It is the mean of ½ log(1 + (ratio / `WELL_KNOWN`)²) over the twelve quantities, where ratio is
    std over span. A poorly known quantity counts by the logarithm of its std, as in a D-optimal
    design. The gain levels off once a quantity is well known.
    """
    return float(0.5 * np.mean(np.log1p((quantities.ratio / WELL_KNOWN) ** 2)))


@dataclass(frozen=True)
class DesignProblem(LawQuestion):
    """Problem of optimal design: what to learn, how it is estimated, and the time for it.

    Attributes
    ----------
    law
        Law of the boards.
    coefficients : (q,) array
        Assumed board coefficients.
    prior
        Prior of the coefficients.
    angles
        Mean attack and slip angle (rad) at which the laws are to be known.
    span : (12,) array
        Range of each law, from `law_spans`.
    estimator, windows
        Options of the estimator, and of the steady windows.
    vessel
        Limits of ship and winches.
    minutes
        Time for the trial, min.
    """

    prior: ParameterVector
    estimator: EstimatorOptions
    windows: WindowOptions
    vessel: VesselLimits
    minutes: float


class Designer:
    """Builder of trials from candidate manoeuvres.

    Parameters
    ----------
    problem
        Design problem.
    candidates
        Manoeuvres to choose from.
    noise
        Standard error (SI) of each channel's window mean. Other channels are not measured.
    """

    def __init__(
        self,
        problem: DesignProblem,
        candidates: Iterable[TowableManoeuvre],
        noise: Mapping[str, float] = TABLE_NOISE,
    ) -> None:
        self.problem = problem
        self.candidates = tuple(candidates)
        self.noise = noise
        self.timetable = Timetable(problem.vessel, problem.windows, self.candidates)
        self._number = {
            candidate.manoeuvre: index for index, candidate in enumerate(self.candidates)
        }
        self._before = information_before(problem.prior, problem.estimator)
        # Information matrix of the windows of each candidate.
        self._gained = [
            information_of(self._windows(candidate), problem.prior, problem.estimator)
            for candidate in self.candidates
        ]

    def legs(self, manoeuvres: Sequence[Manoeuvre]) -> tuple[Leg, ...] | None:
        """Order manoeuvres into legs.

        Return None if they do not fit into the time, or visit a state too often.
        """
        if max(Counter(manoeuvres).values(), default=0) > MAX_VISITS_PER_STATE:
            return None
        ordered = arranged(manoeuvres)
        if ordered is None:
            return None
        legs = self.timetable.legs(ordered)
        return legs if minutes_of(legs) <= self.problem.minutes else None

    def _windows(self, candidate: TowableManoeuvre) -> tuple[Linearised, ...]:
        """Predict the steady windows of a candidate."""
        problem = self.problem
        return imagined_windows(
            candidate,
            problem.coefficients,
            state=0,
            number=problem.windows.max_windows_per_state,
            noise=self.noise,
            to_come=rest_of(candidate, problem.windows).to_come(problem.windows),
        )

    def information(self, manoeuvres: Sequence[Manoeuvre], times: float = 1.0) -> FloatArray:
        """Return the information matrix after manoeuvres, each repeated ``times`` times.

        It includes the prior's, and is in units of the prior std. Its first q rows belong to the
        coefficients; those behind them belong to errors that all windows share.
        """
        gained = [self._gained[self._number[manoeuvre]] for manoeuvre in manoeuvres]
        return self._before + times * sum(gained)

    def covariance(self, manoeuvres: Sequence[Manoeuvre]) -> FloatArray:
        """Return the posterior covariance (q, q) of the coefficients after manoeuvres."""
        return covariance_from(self.information(manoeuvres), self.problem.prior)

    def quantities(self, manoeuvres: Sequence[Manoeuvre]) -> LawQuantities:
        """Return value and slope of the laws after manoeuvres."""
        return self.problem.quantities(self.covariance(manoeuvres))

    def shortfall(self, manoeuvres: Sequence[Manoeuvre]) -> float:
        """Return the shortfall after manoeuvres."""
        return shortfall(self.quantities(manoeuvres))

    def best(self) -> tuple[Leg, ...]:
        """Return the legs of the best trial that greedy addition and exchange find.

        First the manoeuvre with the largest gain per minute is added until the time is used up.
        Then each manoeuvre is exchanged for the one with the largest gain, and time that becomes
        free is filled again. The search ends when no exchange gains. Of equal candidates the first
        is taken, so the result is reproducible.
        """
        chosen: list[Manoeuvre] = []
        while True:
            chosen = self._filled(chosen)
            better = self._exchanged(chosen)
            if better is None:
                return self.legs(chosen) or ()
            chosen = better

    def _filled(self, chosen: list[Manoeuvre]) -> list[Manoeuvre]:
        """Add manoeuvres by their gain per minute until none fits or gains."""
        while True:
            now = self.shortfall(chosen)
            minutes = minutes_of(self.legs(chosen) or ())
            best, most = chosen, 0.0
            for candidate in self.candidates:
                trial = [*chosen, candidate.manoeuvre]
                gain = now - self.shortfall(trial)
                if gain <= MIN_GAIN:
                    continue
                legs = self.legs(trial)
                if legs is None:
                    continue
                # A reordered trial may be hardly longer; count at least one minute.
                rate = gain / max(minutes_of(legs) - minutes, 1.0)
                if rate > most * (1.0 + MIN_GAIN):
                    best, most = trial, rate
            if best is chosen:
                return chosen
            chosen = best

    def _exchanged(self, chosen: list[Manoeuvre]) -> list[Manoeuvre] | None:
        """Return the manoeuvres after one round of exchanges, or None if nothing was gained."""
        changed = False
        for place in range(len(chosen)):
            rest = chosen[:place] + chosen[place + 1 :]
            least = self.shortfall(chosen)
            for candidate in self.candidates:
                trial = [*rest[:place], candidate.manoeuvre, *rest[place:]]
                left = self.shortfall(trial)
                if left < least - MIN_GAIN and self.legs(trial) is not None:
                    chosen, least, changed = trial, left, True
        return chosen if changed else None
