# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Watch over a tow: the model towed along with it, its innovations, and the evidence in them."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.onset.candidates import WATCHED, CandidateTable
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence, RatioBank
from trawl_ros.diagnosis.onset.responses import OnsetResponses, onset_responses
from trawl_ros.diagnosis.onset.stretches import LastStretch
from trawl_ros.diagnosis.onset.towing import ModelTow, TowedStretch, WatchedGear, measured
from trawl_ros.diagnosis.onset.whitening import (
    MOST_ABSORBED,
    FilterState,
    Whitened,
    WhiteningFilter,
    states_for,
)
from trawl_ros.solver.stepper import StepFailed

CLOSE, REST = 6.0, 4
"""Change of a channel by what coefficients were learned to be, in the model's own error, within
which boards are found once, through so many stretches in a row, before anything is judged:
derivatives of boards farther off are of another gear. Beyond it an effect may lead later; what is
found then has to be so by the boards as they were learned too."""

LEARNS = 'boards are learned first, for what is known of them is too far off, or too little'
"""Reason for which nothing is judged."""


@dataclass(frozen=True)
class WatchedStretch:
    """Stretch as it was watched: the readings beside the model's, and the evidence after it.

    ``marks`` (w, r, p) are what the candidates would leave in the innovations, by age.
    ``why_not`` is the reason where nothing was judged.
    """

    end_ns: int
    means: FloatArray
    towed: TowedStretch | None
    white: Whitened | None
    marks: FloatArray | None
    evidence: tuple[OnsetEvidence, ...]
    why_not: str = ''

    @property
    def rarity(self) -> float:
        """The largest rarity of all candidates, 0 where there is none."""
        return self.evidence[0].rarity if self.evidence else 0.0


@dataclass(frozen=True)
class WatchSettings:
    """Settings of a watch: what may begin in which gear, how many onsets are looked at, the factor
    on the std of errors that are stated, and stretches through which boards are learned at least.
    """

    gear: WatchedGear
    table: CandidateTable
    window: int
    inflation: float
    learning: int = 0


@dataclass(frozen=True)
class _Absorbed:
    """Value that has been found before and is taken along: its column, and when it began."""

    column: int
    onset: int
    place: int


@dataclass(frozen=True)
class WatchState:
    """State between two stretches, from which a tow may be watched again by other boards."""

    filter: FilterState | None = None
    absorbed: tuple[_Absorbed, ...] = ()
    taken: int = 0
    close: int = 0
    compared: int = 0


@dataclass
class Watch:
    """Watch with the model linearised at some boards.

    Attributes
    ----------
    settings
        Of the watch.
    known
        Knowledge before the tow.
    coefficients
        Boards (q,) that the model is towed with.
    begin
        State that it begins in.
    away
        Largest change of a channel by what boards were learned to be, in the model's own error,
        when the model was towed last.
    number
        Of the stretch that was watched last.
    close, compared
        Stretches up to now in which boards were close, up to `REST`; and that were compared.
    refused
        True if nothing was ever judged, and the model has no such tow with these boards: it ends
        with the newest stretch, or none was compared through `REST` of them.
    """

    settings: WatchSettings
    known: Knowledge
    coefficients: FloatArray
    begin: WatchState = field(default_factory=WatchState)
    away: float = 0.0
    number: int = -1

    def __post_init__(self) -> None:
        self._model = ModelTow(self.settings.gear, self.coefficients)
        size = states_for(len(self.known.values))
        self._bank = RatioBank(self.settings.table, self.settings.window, size)
        self._growing = self.settings.table.growing.astype(float)
        self._filter: WhiteningFilter | None = None
        self._responses: OnsetResponses | None = None
        self._absorbed, self._taken = self.begin.absorbed, self.begin.taken
        self.close, self.compared = self.begin.close, self.begin.compared
        self._moving, self.refused = (False, False), False
        # Stretches without a prediction, though the model is towed along them.
        self._judged, self._vain = not self.learns, 0

    @property
    def state(self) -> WatchState:
        """State after the stretches so far."""
        known = self.begin.filter if self._filter is None else self._filter.state
        return WatchState(known, self._absorbed, self._taken, self.close, self.compared)

    @property
    def learned(self) -> FloatArray | None:
        """Boards (q,) by the present estimate; None where nothing was compared."""
        return None if self._filter is None else self._filter.coefficients

    @property
    def learns(self) -> bool:
        """True until boards have been close to those that derivatives are of."""
        return self.close < REST or self.compared < self.settings.learning

    def advance(self, last: LastStretch) -> WatchedStretch:
        """Watch the next stretch."""
        self.number = last.number
        towed = self._model.advance(last)
        self._vain = self._vain + 1 if isinstance(towed, str) and self._model.under_way else 0
        in_vain = self._vain >= REST and not last.fell
        self.refused = not self._judged and (in_vain or self._model.stopped == last.number)
        if isinstance(towed, TowedStretch) and self._responses is None:
            try:
                self._begin()
            except (NoSteadyState, StepFailed) as reason:
                towed, self.refused = f'responses of the gear are not known: {reason}', True
        why_not = towed if isinstance(towed, str) else ''
        means, noise = measured(last)
        if self._filter is None or self._responses is None:
            return WatchedStretch(last.end_ns, means, None, None, None, (), why_not)
        if any(now and not was for now, was in zip(last.moves, self._moving, strict=True)):
            self._filter.begin_state()
        self._moving = last.moves
        model = towed if isinstance(towed, TowedStretch) else None
        lasting = None if model is None else model.by_values
        white = self._filter.step(
            means, noise, model, self.coefficients, last, self._taken_along(lasting, last.number)
        )
        signatures = None
        if lasting is not None:
            ages = np.arange(self.settings.window)
            signatures = self._responses.since(lasting, ages, self._growing)
        marks = self._bank.step(self._filter, white, signatures)
        evidence: tuple[OnsetEvidence, ...] = ()
        if white is not None and self.learns:
            # An onset that was seen by other boards is none.
            self._bank.forget()
            why_not = LEARNS
        elif white is not None:
            self._judged = True
            evidence = tuple(self._bank.best())
        if model is not None and white is not None:
            self.compared += 1
            moved = model.by_coefficients @ (self._filter.coefficients - self.coefficients)
            self.away = float(np.max(np.abs(moved) / model.model_error))
            if self.learns:
                self.close = min(self.close + 1, REST) if self.away < CLOSE else 0
        elif self.learns or self._model.stopped == last.number:
            # The model may come to rest elsewhere: that boards were close before proves nothing.
            self.close = 0
        return WatchedStretch(last.end_ns, means, model, white, marks, evidence, why_not)

    def _begin(self) -> None:
        steady, own = self._model.steady, self.settings
        assert steady is not None
        self._responses = onset_responses(own.gear, self.coefficients, steady, own.window)
        self._filter = WhiteningFilter(
            self.known, self._responses, own.inflation, self.begin.filter
        )

    def take_along(self, columns: Sequence[int], onset: int) -> None:
        """Take values along as known to be there since a stretch, and watch for what comes beside
        them.
        """
        assert self._filter is not None
        for column in columns:
            # The oldest makes room.
            place = self._taken % MOST_ABSORBED
            self._taken += 1
            self._filter.absorb(place, float(self.settings.table.scale[column]))
            kept = (one for one in self._absorbed if one.place != place)
            self._absorbed = (*kept, _Absorbed(column, onset, place))
        self._filter.loosen()
        self._bank.forget()

    def _taken_along(self, lasting: FloatArray | None, number: int) -> FloatArray:
        """Signatures (k, `MOST_ABSORBED`) of what is taken along, in a stretch."""
        found = np.zeros((len(WATCHED), MOST_ABSORBED))
        if lasting is None or self._responses is None:
            return found
        for one in self._absorbed:
            own = [one.column]
            ages = np.array([max(number - one.onset, 0)])
            known = self._responses.only(own).since(lasting[:, own], ages, self._growing[own])
            found[:, one.place] = known[0, :, 0]
        return found
