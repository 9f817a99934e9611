# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Search for the most informative manoeuvres within a given time."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.laws import WELL_KNOWN, LawQuantities, WorkingAngles, law_quantities
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.planning.duration import (
    Ability,
    Leg,
    Timetable,
    arranged,
    minutes_of,
    rest_of,
)
from trawl_ros.estimation.planning.information import (
    covariance_from,
    fitted_covariance,
    information_before,
    information_of,
)
from trawl_ros.estimation.planning.states import Manoeuvre, TowableManoeuvre
from trawl_ros.estimation.planning.windows import TABLE_NOISE, imagined_windows
from trawl_ros.estimation.windows.records import WindowOptions

LEAST_GAIN = 1e-9
"""A gain below this is none: what rounding may give must not decide."""


def shortfall(quantities: LawQuantities) -> float:
    """Shortfall: design criterion of the twelve quantities' std, to be minimised.

    Mean of log(1 + (ratio / 0.2)²) / 2: of a quantity that is hardly known the logarithm of its
    std counts, and little is won by knowing better what is well known.
    """
    return float(0.5 * np.mean(np.log1p((quantities.ratio / WELL_KNOWN) ** 2)))


@dataclass(frozen=True)
class Question:
    """Design question: the laws of this board, their spans, and the time for the trial.

    ``coefficients`` (12,) as they are believed to be, ``span`` (12,) from `law_spans`.
    """

    coefficients: FloatArray
    prior: ParameterVector
    angles: WorkingAngles
    span: FloatArray
    estimator: EstimatorOptions
    windows: WindowOptions
    ability: Ability
    minutes: float

    def quantities(self, covariance: FloatArray) -> LawQuantities:
        """Quantities of the laws with a covariance (12, 12) of the coefficients."""
        return law_quantities(self.coefficients, covariance, self.angles, self.span)


MOST_VISITS = 2
"""Most visits of a trial to a steady state. The information in a state is computed with the
board as it is believed to be; a trial that rests on few states is as good as this belief."""


class Designer:
    """Builder of trials from candidates.

    Parameters
    ----------
    question
        The question of the plan.
    candidates
        Manoeuvres to choose from.
    noise
        Standard error of each channel's mean; channels that are not in it are not heard.
    """

    def __init__(
        self,
        question: Question,
        candidates: Iterable[TowableManoeuvre],
        noise: Mapping[str, float] = TABLE_NOISE,
    ) -> None:
        self.question = question
        self.candidates = tuple(candidates)
        self.noise = noise
        self.timetable = Timetable(question.ability, question.windows, self.candidates)
        self._number = {
            candidate.manoeuvre: index for index, candidate in enumerate(self.candidates)
        }
        self._before = information_before(question.prior, question.estimator)
        self._taught = [
            information_of(self._windows(candidate, 0), question.prior, question.estimator)
            for candidate in self.candidates
        ]

    def legs(self, manoeuvres: Sequence[Manoeuvre]) -> tuple[Leg, ...] | None:
        """Order manoeuvres into legs; None where they do not fit into the time."""
        if max(Counter(manoeuvres).values(), default=0) > MOST_VISITS:
            return None
        ordered = arranged(manoeuvres)
        if ordered is None:
            return None
        legs = self.timetable.legs(ordered)
        return legs if minutes_of(legs) <= self.question.minutes else None

    def _windows(self, candidate: TowableManoeuvre, state: int) -> tuple[Linearised, ...]:
        question = self.question
        return imagined_windows(
            candidate,
            question.coefficients,
            state=state,
            number=question.windows.max_windows_per_state,
            noise=self.noise,
            to_come=rest_of(candidate, question.windows).to_come(question.windows),
        )

    def information(self, manoeuvres: Sequence[Manoeuvre], times: float = 1.0) -> FloatArray:
        """Information matrix after manoeuvres, each repeated ``times`` times."""
        taught = [self._taught[self._number[manoeuvre]] for manoeuvre in manoeuvres]
        return self._before + times * sum(taught)

    def covariance(self, manoeuvres: Sequence[Manoeuvre]) -> FloatArray:
        """Posterior covariance (12, 12) of the coefficients after manoeuvres."""
        return covariance_from(self.information(manoeuvres), self.question.prior)

    def fitted(self, manoeuvres: Sequence[Manoeuvre]) -> FloatArray:
        """Posterior covariance (12, 12) as the estimator itself gives it."""
        question = self.question
        windows = [
            linear
            for state, manoeuvre in enumerate(manoeuvres)
            for linear in self._windows(self.candidates[self._number[manoeuvre]], state)
        ]
        return fitted_covariance(windows, question.coefficients, question.prior, question.estimator)

    def quantities(self, manoeuvres: Sequence[Manoeuvre]) -> LawQuantities:
        """Quantities of the laws after manoeuvres."""
        return self.question.quantities(self.covariance(manoeuvres))

    def shortfall(self, manoeuvres: Sequence[Manoeuvre]) -> float:
        """Shortfall of the quantities after manoeuvres."""
        return shortfall(self.quantities(manoeuvres))

    def best(self) -> tuple[Leg, ...]:
        """Return the trial of least shortfall that greedy addition and exchange find.

        Manoeuvres are added by what they gain per minute until the time is up; then each is
        exchanged for whatever gains most, and what has become free is filled, until nothing
        gains. Ties fall to the first candidate, so that the result is always the same.
        """
        chosen: list[Manoeuvre] = []
        while True:
            chosen = self._filled(chosen)
            better = self._exchanged(chosen)
            if better is None:
                return self.legs(chosen) or ()
            chosen = better

    def _filled(self, chosen: list[Manoeuvre]) -> list[Manoeuvre]:
        while True:
            now = self.shortfall(chosen)
            minutes = minutes_of(self.legs(chosen) or ())
            best, most = chosen, 0.0
            for candidate in self.candidates:
                trial = [*chosen, candidate.manoeuvre]
                gain = now - self.shortfall(trial)
                if gain <= LEAST_GAIN:
                    continue
                legs = self.legs(trial)
                if legs is None:
                    continue
                rate = gain / max(minutes_of(legs) - minutes, 1.0)
                if rate > most * (1.0 + LEAST_GAIN):
                    best, most = trial, rate
            if best is chosen:
                return chosen
            chosen = best

    def _exchanged(self, chosen: list[Manoeuvre]) -> list[Manoeuvre] | None:
        """Return the result of one round of exchanges; None where nothing was gained."""
        changed = False
        for place in range(len(chosen)):
            rest = chosen[:place] + chosen[place + 1 :]
            least = self.shortfall(chosen)
            for candidate in self.candidates:
                trial = [*rest[:place], candidate.manoeuvre, *rest[place:]]
                left = self.shortfall(trial)
                if left < least - LEAST_GAIN and self.legs(trial) is not None:
                    chosen, least, changed = trial, left, True
        return chosen if changed else None
