# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sweep of the paper's trial: warp lengths out and back at one speed."""

from dataclasses import dataclass
from itertools import chain, count

from trawl_ros.estimation.fit.laws import LawQuantities
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.planning.duration import Leg, minutes_of
from trawl_ros.estimation.planning.search import Designer
from trawl_ros.estimation.planning.states import Manoeuvre
from trawl_ros.estimation.planning.windows import TABLE_NOISE
from trawl_ros.records.channels import INPUTS


@dataclass(frozen=True)
class SweepTrial:
    """Trial: its legs and the quantities known after them.

    ``known`` is that with the board as it is believed to be, ``by_data`` the same without what
    was known before, and ``as_filed`` that with the board as the gear file has it.
    """

    name: str
    legs: tuple[Leg, ...]
    known: LawQuantities
    by_data: LawQuantities
    as_filed: LawQuantities

    @property
    def manoeuvres(self) -> tuple[Manoeuvre, ...]:
        """Manoeuvres of its legs."""
        return tuple(leg.manoeuvre for leg in self.legs)

    @property
    def minutes(self) -> float:
        """Duration, min."""
        return minutes_of(self.legs)


def paper_noise() -> dict[str, float]:
    """Standard errors of the measurements in the paper's trial, with the inputs'."""
    heard = {name for channel in PAPER_CHANNELS for name in channel.observables} | set(INPUTS)
    return {name: value for name, value in TABLE_NOISE.items() if name in heard}


def best_sweep(designer: Designer) -> tuple[Leg, ...]:
    """Sweep over all lengths out and back, repeated until the time is up.

    Of all speeds, the one is taken at which this teaches most.
    """
    speeds = sorted(
        {
            candidate.manoeuvre.speed
            for candidate in designer.candidates
            if candidate.manoeuvre.equal
        }
    )
    sweeps = [_sweep(designer, speed) for speed in speeds]
    return min(sweeps, key=lambda legs: designer.shortfall([leg.manoeuvre for leg in legs]))


def _sweep(designer: Designer, speed: float) -> tuple[Leg, ...]:
    out = sorted(
        candidate.manoeuvre
        for candidate in designer.candidates
        if candidate.manoeuvre.equal and candidate.manoeuvre.speed == speed
    )
    legs: tuple[Leg, ...] = ()
    done: list[Manoeuvre] = []
    for manoeuvre in chain.from_iterable((*out, *out[-2:0:-1]) for _ in count()):
        # One length alone is one state, however long it is held.
        if done and manoeuvre == done[-1]:
            return legs
        longer = designer.timetable.legs([*done, manoeuvre])
        if minutes_of(longer) > designer.problem.minutes:
            return legs
        legs, done = longer, [*done, manoeuvre]
    return legs
