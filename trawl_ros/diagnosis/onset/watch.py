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
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.part import LENGTH_NS, SETTLING, WatchedPart, manoeuvres
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence, RatioBank
from trawl_ros.diagnosis.onset.residuals import ResidualRows, residual_rows, unrest_of
from trawl_ros.diagnosis.onset.responses import OnsetResponses, onset_responses
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
    """Stretch as it was watched.

    Attributes
    ----------
    end_ns
        Its end.
    innovations : (k,) array
        Innovations of the watched channels, NaN where there are none.
    why_not
        Reason why nothing was judged; empty where it was.
    rarity
        The largest rarity of all candidates after it; NaN where nothing was judged.
    """

    end_ns: int
    innovations: FloatArray
    why_not: str = ''
    rarity: float = np.nan

    @property
    def compared(self) -> bool:
        """True if readings were compared with the model."""
        return bool(np.isfinite(self.innovations).any())


@dataclass(frozen=True)
class WatchSettings:
    """Settings of a watch.

    Attributes
    ----------
    gear, water
        The gear that is watched, and the water that turns pressure into depth.
    table
        Candidates that may begin.
    known
        Knowledge of the boards and of the sizes of errors.
    window
        Onsets that are examined, in stretches.
    learning
        Stretches through which boards are learned, at least.
    """

    gear: WatchedGear
    water: Water
    table: CandidateTable
    known: Knowledge
    window: int = 60
    learning: int = 0


@dataclass(frozen=True)
class WatchStart:
    """What a watch begins with.

    Attributes
    ----------
    coefficients
        Boards with which the model is towed.
    belief
        Distribution of the lasting parameters.
    compared
        Stretches that were compared before.
    absorbed
        Values that have been found before: column, and stamp (ns) of the onset.
    since_ns
        Stamp (ns) before which no onset is looked for.
    """

    coefficients: FloatArray
    belief: Belief
    compared: int = 0
    absorbed: tuple[tuple[int, int], ...] = ()
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
    part
        The part of the tow.
    away
        Largest change of a channel by the learned boards, in the model's own error, in the newest
        stretch.
    close
        Stretches up to now in which boards were close, up to `REST`.
    compared
        Stretches that were compared up to now.
    evidence
        Evidence for each candidate, the rarest first; none where nothing was judged.
    marks : (w, r, p) array
        What the candidates would leave in the newest innovations, by age.
    lost
        True if the part has ended: another has to begin.
    refused
        True if it has ended because the model cannot be towed along with these boards.
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
        self._manoeuvres: list[bool] = []
        self._chain = Chain(start.belief)
        self._bank = RatioBank(settings.table, settings.window)
        self._counts: list[int] = []
        self.compared, self.away, self.close = start.compared, 0.0, 0
        self.lost = self.refused = self._judged = False
        self.evidence: list[OnsetEvidence] = []
        self.marks = np.zeros((0, 0, 0))

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
    def learned(self) -> FloatArray:
        """Boards by the present belief."""
        known = self._own.known.values
        return np.asarray(known + self.belief().mean[: len(known)], np.float64)

    def belief(self, stretch: int | None = None) -> Belief:
        """Return the belief before a stretch, or after all."""
        return self._chain.belief(None if stretch is None else sum(self._counts[:stretch]))

    def take_along(self, columns: Sequence[int], onset_ns: int, now_ns: int) -> None:
        """Take values as present since an onset (ns), and watch for others from a stamp on."""
        # The oldest make room.
        found = ((column, onset_ns) for column in columns)
        every = (*self.start.absorbed, *found)[-MOST_ABSORBED:]
        self.start = replace(self.start, absorbed=every, since_ns=now_ns)
        # With the next stretch all are appended to a new chain.
        self._chain = Chain(self.start.belief)
        self._bank = RatioBank(self._own.table, self._own.window)
        self._counts.clear()

    def advance(self, most: int | None = None) -> WatchedStretch:
        """Watch the new stretches, of which the last is returned.

        Parameters
        ----------
        most
            Number of stretches along which the model is towed at most.
        """
        self.evidence, self.marks = [], np.zeros((0, 0, 0))
        try:
            return self._advanced(self.part.cut(), most)
        except (NoSteadyState, StepFailed) as reason:
            self.lost = self.refused = True
            return self._not_compared(f'responses of the gear are not known: {reason}')
        except TrawlError as reason:
            self.lost = self.part.number >= FEWEST
            return self._not_compared(str(reason))

    def _not_compared(self, why_not: str) -> WatchedStretch:
        if self.learns:
            # The gear may settle elsewhere: that boards were close before proves nothing.
            self.close = 0
        return WatchedStretch(self.part.end_ns, np.full(len(WATCHED), np.nan), why_not)

    def _advanced(self, tow: MovingTow, most: int | None) -> WatchedStretch:
        """Tow the model on along a tow, and compare the new stretches."""
        own = self._own
        self._lineariser.extend(tow, np.zeros(tow.inputs.number_of_knots), most)
        linear, failed = self._lineariser.linearised(tow), self._lineariser.failed
        towed = linear.towed[: len(self)]
        in_vain = len(self) >= SETTLING + REST and not (self._judged or towed[-REST:].any())
        self.lost = in_vain or bool(failed)
        self.refused = in_vain or failed not in ('', BY_SENSOR)
        if self._responses is None:
            if not towed.any():
                return self._not_compared(failed or JUST_BEGUN)
            self._responses = onset_responses(
                own.gear, self.start.coefficients, tow.inputs.values[0], own.window
            )
        for stretch in range(len(self._lasting), len(self)):
            self._lasting.append(self._by_values(linear, stretch))
        self._manoeuvres += manoeuvres(tow)[len(self._manoeuvres) :]
        unrest = unrest_of(self._manoeuvres)
        rows = residual_rows(
            self._towed, linear, self.start.belief, own.known,
            log_density=self.part.log_density, unrest=unrest,
            absorbed=self._absorbed(len(tow), self._responses),
        )  # fmt: skip
        found = [
            self._appended(rows.of(stretch), linear, stretch, float(unrest[stretch]))
            for stretch in range(len(self._counts), len(self))
        ][-1]
        if found.why_not:
            return found
        self._judged, self.evidence = True, self._bank.best()
        return replace(found, rarity=self.evidence[0].rarity if self.evidence else 0.0)

    def _appended(
        self, rows: ResidualRows, linear: LinearisedTow, stretch: int, unrest: float
    ) -> WatchedStretch:
        """Append the rows (r) of a stretch to the chain, and compare them."""
        assert self._responses is not None
        self._counts.append(len(rows.residual))
        link = self._chain.append(rows.covariance, rows.columns, rows.residual)
        ages, growing = np.arange(self._own.window), self._own.table.growing
        signatures = self._responses.since(self._lasting[stretch], ages, growing)
        self.marks = self._bank.step(link, signatures[:, rows.channels], unrest)
        if not len(rows.residual):
            begin = stretch * linear.tow.stretch_s
            why = (one.why for one in linear.left_out if one.begin <= begin < one.end)
            return self._not_compared(next(why, JUST_BEGUN))
        why_not = LEARNS if self.learns else ''
        end_ns = self.part.begin_ns(stretch + 1)
        if why_not or end_ns <= self.start.since_ns:
            # An onset by boards that were not close is none.
            self._bank.forget()
        self.compared += 1
        by_boards = linear.by['coefficients'][stretch, rows.channels]
        away = by_boards @ (self.learned - self.start.coefficients) / rows.model
        self.away = float(np.max(np.abs(away)))
        if self.learns:
            self.close = min(self.close + 1, REST) if self.away < CLOSE else 0
        innovations = np.full(len(WATCHED), np.nan)
        innovations[rows.channels] = link.innovations
        return WatchedStretch(end_ns, innovations, why_not)

    def _by_values(self, linear: LinearisedTow, stretch: int) -> FloatArray:
        """Return the derivatives (k, p) of a stretch by the values of all effects."""
        at = without_errors(linear.tow.inputs)(float(linear.tow.middles[stretch])).situation
        values, by = np.nan_to_num(linear.values[stretch]), linear.by['examined'][stretch]
        return self._own.gear.by_values(by, values, replace(at, hours=1.0))

    def _absorbed(self, number: int, responses: OnsetResponses) -> FloatArray:
        """Return the signatures (n, k, a) of what has been found before, per prior std."""
        found = np.zeros((number, len(WATCHED), len(self.start.absorbed)))
        begins = np.array([self.part.begin_ns(stretch) for stretch in range(len(self))])
        for place, (column, onset_ns) in enumerate(self.start.absorbed):
            ages = np.rint((begins - onset_ns) / LENGTH_NS).astype(np.int64)
            lasting, growing = np.array(self._lasting), self._own.table.growing
            since = responses.since(lasting, np.maximum(ages, 0), growing)[..., column]
            here = self._own.table.scale[column] * since
            found[: len(self), :, place] = np.where(ages[:, None] >= 0, here, 0.0)
        return found
