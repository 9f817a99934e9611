# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Advice on the next manoeuvre, and the ranking behind it."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.estimation.fit.laws import QUANTITIES, WELL_KNOWN, LawQuantities
from trawl_ros.estimation.planning.states import Manoeuvre


@dataclass(frozen=True)
class RankedManoeuvre:
    """Ranked manoeuvre: one that could come next, with what it teaches and what it loads.

    Attributes
    ----------
    manoeuvre
        Warp lengths and speed.
    minutes
        From now until its windows are taken.
    nats
        Information gained, by the estimator's account before the windows are weighed.
    rate
        Fall of the plan's shortfall per minute, by which manoeuvres are ranked.
    tension
        Predicted tension (N) of the tauter warp.
    deepest
        Predicted depth (m) of the gear's deepest point.
    """

    manoeuvre: Manoeuvre
    minutes: float
    nats: float
    rate: float
    tension: float
    deepest: float


@dataclass(frozen=True)
class Advice:
    """Advice: the next manoeuvre and its gain.

    Attributes
    ----------
    manoeuvre
        Warp lengths and speed; the ship goes straight ahead.
    minutes
        From now until its windows are taken.
    before, after
        Quantities of the laws now, and then.
    nats
        Information gained: half the fall of the covariance's log determinant.
    looked_up
        Part of all manoeuvres among which was chosen; the others are not looked up yet.
    windows
        Number of windows of the fit that was asked.
    ranking
        All manoeuvres among which was chosen, the best one first.
    """

    manoeuvre: Manoeuvre
    minutes: float
    before: LawQuantities
    after: LawQuantities
    nats: float
    looked_up: float
    windows: int
    ranking: tuple[RankedManoeuvre, ...] = ()

    @property
    def helped(self) -> int:
        """Index into `QUANTITIES` of the quantity that improves most."""
        terms = [np.log1p((known.ratio / WELL_KNOWN) ** 2) for known in (self.before, self.after)]
        return int(np.argmax(terms[0] - terms[1]))

    def __str__(self) -> str:
        at = self.helped
        return (
            f'{self.manoeuvre}, {self.minutes:g} min: {QUANTITIES[at]} from '
            f'{100 * self.before.ratio[at]:.0f} to {100 * self.after.ratio[at]:.0f} % of its span, '
            f'{self.before.well_known.sum()} to {self.after.well_known.sum()} of '
            f'{len(QUANTITIES)} well known'
        )
