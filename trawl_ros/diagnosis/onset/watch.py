# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Watch over a part of a tow: the estimator's linearisation, its innovations, and the evidence."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState, TrawlError
from trawl_ros.diagnosis.onset.candidates import WATCHED, CandidateTable
from trawl_ros.diagnosis.onset.chain import Belief, Chain
from trawl_ros.diagnosis.onset.gear import WatchedGear
from trawl_ros.diagnosis.onset.part import LENGTH_NS, SETTLING, WatchedPart, manoeuvres
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence, RatioBank
from trawl_ros.diagnosis.onset.residuals import (
    ErrorModel,
    ResidualRows,
    residual_rows,
    unrest_of,
)
from trawl_ros.diagnosis.onset.responses import OnsetResponses, onset_responses
from trawl_ros.estimation.motion.nuisances import layout_of
from trawl_ros.estimation.motion.stretches import FEWEST
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS, without_errors
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.lineariser import BY_SENSOR, TowLineariser
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedPoint
from trawl_ros.model.water import Water
from trawl_ros.records.samples import Sample
from trawl_ros.solver.stepper import StepFailed

CLOSE, REST = 6.0, 4
"""Change of a channel by the learned coefficients, in the model's own error, within which boards
have to be found, through so many stretches in a row, before anything is judged: the derivatives of
boards farther off are of another gear."""

LEARNS = 'boards are learned first, for what is known of them is too far off, or too little'
"""Reason for which nothing is judged."""

JUST_BEGUN = 'the tow has just begun'
"""Reason for which nothing is compared."""

MOST_ABSORBED = 6
"""Largest number of values that are taken as present."""


@dataclass(frozen=True)
class WatchedStretch:
    """Stretch as it was watched, and the evidence after it.

    Attributes
    ----------
    end_ns
        Its end.
    innovations : (k,) array
        Innovations of the watched channels, NaN where there are none.
    std : (k,) array
        Std of their residuals, given all stretches before.
    marks : (w, r, p) array
        What the candidates would leave in the innovations, by age; None without innovations.
    evidence
        Evidence for each candidate, the rarest first; none where nothing was judged.
    why_not
        Reason why nothing was judged; empty where it was.
    """

    end_ns: int
    innovations: FloatArray
    std: FloatArray
    marks: FloatArray | None
    evidence: tuple[OnsetEvidence, ...]
    why_not: str = ''

    @property
    def compared(self) -> bool:
        """True if readings were compared with the model."""
        return self.marks is not None

    @property
    def rarity(self) -> float:
        """The largest rarity of all candidates, 0 where there is none."""
        return self.evidence[0].rarity if self.evidence else 0.0


@dataclass(frozen=True)
class WatchSettings:
    """Settings of a watch.

    Attributes
    ----------
    gear, water
        The gear that is watched, and the water that turns pressure into depth.
    table
        Candidates that may begin.
    errors
        Errors of readings and model.
    window
        Onsets that are examined, in stretches.
    learning
        Stretches through which boards are learned, at least.
    """

    gear: WatchedGear
    water: Water
    table: CandidateTable
    errors: ErrorModel
    window: int
    learning: int = 0


@dataclass(frozen=True)
class Absorbed:
    """Value that has been found before: its column, and the stamp (ns) of its onset."""

    column: int
    onset_ns: int


@dataclass(frozen=True)
class WatchStart:
    """What a watch begins with.

    Attributes
    ----------
    coefficients
        Boards with which the model is towed.
    belief
        Distribution of the lasting parameters; by what is known where None.
    compared
        Stretches that were compared before.
    absorbed
        Values that have been found before.
    since_ns
        Stamp (ns) before which no onset is looked for.
    """

    coefficients: FloatArray
    belief: Belief | None = None
    compared: int = 0
    absorbed: tuple[Absorbed, ...] = ()
    since_ns: int = 0


class Watch:
    """Watch over a part of a tow, with the model linearised at some boards.

    Parameters
    ----------
    settings
        Of the watch.
    start
        What it begins with.

    Attributes
    ----------
    away
        Largest change of a channel by the learned boards, in the model's own error, in the newest
        stretch.
    close
        Stretches up to now in which boards were close, up to `REST`.
    lost
        True if the part has ended: another has to begin.
    refused
        True if it has ended because the model cannot be towed along with these boards.
    judged
        True if anything was ever judged.
    """

    def __init__(self, settings: WatchSettings, start: WatchStart) -> None:
        self._own, self.start = settings, start
        self.part = WatchedPart(settings.water.depth)
        self._towed = settings.gear.towed
        none = np.zeros(len(INPUT_ERRORS)), np.zeros(0)
        point = TowedPoint(start.coefficients, 0.0, *none)
        self._lineariser = TowLineariser(self._towed, WATCHED, point)
        self._responses: OnsetResponses | None = None
        self._lasting: list[FloatArray] = []
        self._manoeuvres: list[tuple[bool, bool]] = []
        self._growing = settings.table.growing.astype(float)
        self._belief = start.belief
        self._chain: Chain | None = None
        self._bank = RatioBank(settings.table, settings.window)
        self._counts: list[int] = []
        self.compared, self.away, self.close = start.compared, 0.0, 0
        self.lost = self.refused = self.judged = False

    def __len__(self) -> int:
        """Return the number of stretches along which the model was towed."""
        return len(self._lineariser)

    def feed(self, sample: Sample) -> bool:
        """Take a sample; return True if a stretch has ended by it."""
        return self.part.feed(sample)

    @property
    def learns(self) -> bool:
        """True until boards have been close to those that derivatives are of."""
        return self.close < REST or self.compared < self._own.learning

    @property
    def learned(self) -> FloatArray | None:
        """Boards by the present belief; None where nothing was compared."""
        belief = self.belief()
        if belief is None:
            return None
        known = self._own.errors.known.values
        return np.asarray(known + belief.mean[: len(known)], np.float64)

    def belief(self, stretch: int | None = None) -> Belief | None:
        """Return the belief before a stretch, or after all; None where nothing was compared."""
        if self._chain is None:
            return self._belief
        return self._chain.belief(None if stretch is None else sum(self._counts[:stretch]))

    def take_along(self, absorbed: Sequence[Absorbed], now_ns: int) -> None:
        """Take values as present, and watch for further onsets from a stamp (ns) on."""
        # The oldest make room.
        every = (*self.start.absorbed, *absorbed)[-MOST_ABSORBED:]
        self.start = replace(self.start, absorbed=every, since_ns=now_ns)
        # With the next stretch all are appended to a new chain.
        self._chain, self._bank = None, RatioBank(self._own.table, self._own.window)
        self._counts.clear()

    def advance(self, most: int | None = None) -> WatchedStretch:
        """Watch the new stretches, of which the last is returned.

        Parameters
        ----------
        most
            Number of stretches along which the model is towed at most.
        """
        try:
            tow = self.part.cut()
        except TrawlError as reason:
            self.lost = self.part.number >= FEWEST
            return self._not_compared(str(reason))
        self._lineariser.extend(tow, np.zeros(tow.inputs.number_of_knots), most)
        linear = self._lineariser.linearised(tow)
        failed, done = self._lineariser.failed, len(self)
        self.lost, self.refused = bool(failed), failed not in ('', BY_SENSOR)
        if not self.judged and done >= SETTLING + REST:
            in_vain = not linear.towed[done - REST : done].any()
            self.lost, self.refused = self.lost or in_vain, self.refused or in_vain
        if self._responses is None and linear.towed.any():
            own, first = self._own, tow.inputs.values[0]
            try:
                self._responses = onset_responses(
                    own.gear, self.start.coefficients, first, own.window
                )
            except (NoSteadyState, StepFailed) as reason:
                self.lost = self.refused = True
                return self._not_compared(f'responses of the gear are not known: {reason}')
        if self._responses is None:
            return self._not_compared(failed or JUST_BEGUN)
        return self._appended(linear, self._responses)

    def _not_compared(self, why_not: str) -> WatchedStretch:
        if self.learns:
            # The gear may settle elsewhere: that boards were close before proves nothing.
            self.close = 0
        none = np.full(len(WATCHED), np.nan)
        return WatchedStretch(self.part.end_ns, none, none, None, (), why_not)

    def _appended(self, linear: LinearisedTow, responses: OnsetResponses) -> WatchedStretch:
        """Append the new stretches to the chain."""
        tow, errors = linear.tow, self._own.errors
        self._lasting += [
            self._by_values(linear, stretch)
            for stretch in range(len(self._lasting), len(self._lineariser))
        ]
        if self._belief is None:
            self._belief = errors.belief(layout_of(tow, self._towed, 1.0))
        if self._chain is None:
            self._chain = Chain(self._belief)
        # Readings are smoothed again, but stretches that were judged stay as they are.
        self._manoeuvres += manoeuvres(tow)[len(self._manoeuvres) :]
        unrest = unrest_of(self._manoeuvres)
        rows = residual_rows(
            self._towed, linear, self._belief, errors,
            log_factor=errors.log_factor(self.part.log), unrest=unrest,
            absorbed=self._absorbed(tow, responses),
        )  # fmt: skip
        why_not = {round(one.begin / tow.stretch_s): one.why for one in linear.left_out}
        found = self._not_compared(JUST_BEGUN) if not self._counts else None
        for stretch in range(len(self._counts), len(self._lineariser)):
            own = rows.stretches == stretch
            self._counts.append(int(own.sum()))
            if own.any():
                moved = linear.by['coefficients'][stretch, rows.channels[own]]
                found = self._compare(rows.of(own), stretch, float(unrest[stretch]), moved)
            else:
                self._bank.step(None, np.zeros(0), float(unrest[stretch]))
                found = self._not_compared(why_not.get(stretch, JUST_BEGUN))
        assert found is not None
        if found.why_not:
            return found
        self.judged = True
        return replace(found, evidence=tuple(self._bank.best()))

    def _compare(
        self, rows: ResidualRows, stretch: int, unrest: float, moved: FloatArray
    ) -> WatchedStretch:
        """Compare the rows (r) of a stretch; ``moved`` (r, 12) are derivatives by coefficients."""
        assert self._chain is not None
        assert self._responses is not None
        link = self._chain.append(rows.covariance, rows.columns, rows.residual)
        ages = np.arange(self._own.window)
        signatures = self._responses.since(self._lasting[stretch], ages, self._growing)
        marks = self._bank.step(link, signatures[:, rows.channels], unrest)
        why_not = LEARNS if self.learns else ''
        end_ns = self.part.begin_ns(stretch + 1)
        if why_not or end_ns <= self.start.since_ns:
            # An onset by boards that were not close is none.
            self._bank.forget()
        self.compared += 1
        learned = self.learned
        assert learned is not None
        away = moved @ (learned - self.start.coefficients)
        self.away = float(np.max(np.abs(away) / rows.model))
        if self.learns:
            self.close = min(self.close + 1, REST) if self.away < CLOSE else 0
        innovations, std = np.full((2, len(WATCHED)), np.nan)
        innovations[rows.channels] = link.innovations
        std[rows.channels] = np.linalg.norm(link.root, axis=1)
        return WatchedStretch(end_ns, innovations, std, marks, (), why_not)

    def _by_values(self, linear: LinearisedTow, stretch: int) -> FloatArray:
        """Return the derivatives (k, p) of a stretch by the values of all effects."""
        tow = linear.tow
        at = without_errors(tow.inputs)(float(tow.middles[stretch])).situation
        values, by = np.nan_to_num(linear.values[stretch]), linear.by['examined'][stretch]
        return self._own.gear.by_values(by, values, replace(at, hours=1.0))

    def _absorbed(self, tow: MovingTow, responses: OnsetResponses) -> FloatArray:
        """Return the signatures (n, k, a) of what has been found before, per prior std."""
        found = np.zeros((*tow.means.shape, len(self.start.absorbed)))
        scale = self._own.table.scale
        for place, one in enumerate(self.start.absorbed):
            own, known = [one.column], responses.only([one.column])
            for stretch, lasting in enumerate(self._lasting):
                age = round((self.part.begin_ns(stretch) - one.onset_ns) / LENGTH_NS)
                if age >= 0:
                    ages, growing = np.array([age]), self._growing[own]
                    since = known.since(lasting[:, own], ages, growing)
                    found[stretch, :, place] = scale[one.column] * since[0, :, 0]
        return found
