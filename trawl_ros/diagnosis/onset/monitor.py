"""Monitor of a tow that goes on: raises a finding minutes after an effect begins."""

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import WATCHED, CandidateTable, candidate_table
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.judging import finding
from trawl_ros.diagnosis.onset.knowledge import Knowledge, of_gear_file
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence, RatioBank
from trawl_ros.diagnosis.onset.responses import OnsetResponses, onset_responses
from trawl_ros.diagnosis.onset.stretches import LIVE, LastStretch, StretchCutter
from trawl_ros.diagnosis.onset.towing import ModelTow, TowedStretch, WatchedGear, measured
from trawl_ros.diagnosis.onset.whitening import MOST_ABSORBED, Whitened, WhiteningFilter, states_for
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.estimation.motion.stretches import FEWEST
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import Sample
from trawl_ros.solver.stepper import StepFailed

MOVED = 4.0
"""Change of a channel by what coefficients were learned to be, in the model's own error, beyond
which the tow is linearised anew: a tenth of it may be wrong, or more."""

CLOSE = 8.0
"""The same within which boards are found once, through `REST` stretches, before anything is judged:
derivatives of boards farther off are of another gear. Beyond it an effect may lead later."""

LEARNING, REST, AT_REST = 20, 4, 5.0
"""Stretches in which the watch begins anew with what is linearised anew, and longer until boards
are close; stretches between two such changes; rarity beyond which it does not, for something may
have begun."""

LEARNS = 'boards are learned first, for they are far from those that the model is towed with'
"""Reason for which nothing is judged."""

BEFORE, QUIET = FEWEST - 1, 8
"""Stretches up to the newest, behind the first that a model begun anew with the next is towed
along; and the last of those before, that first among them, in which nothing may have moved."""

WHITE_LIMIT, MARGIN = 6.33, 1.42
"""Rarity that white innovations exceed once in 230 h, over all candidates and onsets, by
``trawl study onset --limit 200 --seed 7100``; and the factor on it for what is not quite white, by
hand. docs/studies/onset.md has how rare innovations of clean tows are."""


@dataclass(frozen=True)
class OnsetOptions:
    """Options of the monitor.

    Attributes
    ----------
    window
        Onsets that are looked at, in stretches.
    settled
        Stretches since its onset after which a finding stays as it is.
    limit
        Rarity beyond which a finding is raised: `MARGIN` times `WHITE_LIMIT`.
    inflation
        Factor on the std of errors that are stated, as for steady windows.
    """

    window: int = 60
    settled: int = 50
    limit: float = round(MARGIN * WHITE_LIMIT, 1)
    inflation: float = 1.2


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


@dataclass
class _Absorbed:
    """Value that has been found before and is taken along: its column, and when it began."""

    column: int
    onset: int
    place: int


@dataclass
class _Watch:
    """State of a tow under watch; ``since`` counts stretches since it was linearised last,
    ``learned`` those before, and ``close`` those up to now in which boards were close.
    """

    model: ModelTow
    bank: RatioBank
    known: Knowledge
    filter: WhiteningFilter | None = None
    responses: OnsetResponses | None = None
    absorbed: list[_Absorbed] = field(default_factory=list)
    taken: int = 0
    since: int = 0
    learned: int = 0
    close: int = 0
    moving: tuple[bool, bool] = (False, False)
    moved: deque[bool] = field(default_factory=lambda: deque(maxlen=QUIET + BEFORE))


class OnsetMonitor:
    """Monitor of one tow after another, from samples to findings.

    Parameters
    ----------
    gear
        The gear as it is believed.
    knowledge
        Of its boards and of errors; by default the prior of the gear file, and as stated.
    options
        Of the monitor.
    effects
        The catalogue, where not all of it.
    on_stretch
        Called after each stretch.
    last_number
        Number of the last finding before.

    Attributes
    ----------
    findings
        All of them, by number; the newest may still be open.
    watched, unwatched
        Numbers of stretches that were judged, and that could not be.
    why_not
        Reason why the newest stretch was not judged; empty where it was.
    """

    def __init__(
        self,
        gear: GearRecord,
        knowledge: Knowledge | None = None,
        options: OnsetOptions | None = None,
        effects: Mapping[str, Effect] | None = None,
        on_stretch: Callable[[WatchedStretch], None] = lambda stretch: None,
        last_number: int = 0,
    ) -> None:
        gear.require_boards('whose tow could be watched')
        self.options = options or OnsetOptions()
        self._known = knowledge or of_gear_file(gear)
        self.table: CandidateTable = candidate_table(effects)
        self._gear = WatchedGear(build_model(gear), effects_of(gear), self.table.at_one_hour())
        self._growing = self.table.growing.astype(float)
        self._depth = build_water(gear).depth
        self._on_stretch = on_stretch
        self.why_not = ''
        self.findings: dict[int, Finding] = {}
        self._newest = last_number
        self.reset()

    def reset(self) -> None:
        """Begin anew with no tow; findings so far stay as they are."""
        if (left := self.open) is not None:
            self._put(replace(left, state='settled'))
        self._cutter = StretchCutter(self._depth)
        self._watch = self._new_watch()
        self._last_number = 0
        self.watched = self.unwatched = 0
        self.why_not = 'the tow has just begun'

    def _new_watch(self) -> _Watch:
        model = ModelTow(self._gear, self._known.values)
        size = states_for(len(self._known.values))
        return _Watch(model, RatioBank(self.table, self.options.window, size), self._known)

    def feed(self, sample: Sample) -> list[Finding]:
        """Take a sample; return findings that are new or have changed."""
        return [found for last in self._cutter.feed(sample) for found in self._take(last)]

    def dismiss(self, number: int) -> Finding | None:
        """Take a finding for what is no effect; None where there is no such open one."""
        found = self.findings.get(number)
        if found is None or found.state not in ('raised', 'settled'):
            return None
        if found.open:
            self._take_along(found)
        return self._put(replace(found, state='dismissed'))

    @property
    def open(self) -> Finding | None:
        """Finding that may still change."""
        newest = self.findings.get(self._newest)
        return newest if newest is not None and newest.open else None

    def _put(self, found: Finding) -> Finding:
        self.findings[found.number] = found
        return found

    def _take(self, last: LastStretch) -> Iterator[Finding]:
        watch = self._watch
        towed = watch.model.advance(last)
        if isinstance(towed, TowedStretch) and watch.responses is None:
            try:
                self._begin_watch(watch)
            except (NoSteadyState, StepFailed) as reason:
                towed = f'responses of the gear are not known: {reason}'
        self.why_not = towed if isinstance(towed, str) else ''
        means, noise = measured(last)
        model = towed if isinstance(towed, TowedStretch) else None
        if watch.filter is None or watch.responses is None:
            self._tell(last, means, None, None, None, ())
            return
        if any(now and not was for now, was in zip(last.moves, watch.moving, strict=True)):
            watch.filter.begin_state()
        watch.moving = last.moves
        watch.moved.append(any(last.moves))
        lasting = None if model is None else model.by_values
        white = watch.filter.step(
            means, noise, model, watch.model.coefficients, last,
            self._taken_along(lasting, last.number),
        )  # fmt: skip
        signatures = None
        if lasting is not None:
            ages = np.arange(self.options.window)
            signatures = watch.responses.since(lasting, ages, self._growing)
        marks = watch.bank.step(watch.filter, white, signatures)
        evidence: tuple[OnsetEvidence, ...] = ()
        if white is not None and self._learns:
            self.why_not = LEARNS
        elif white is not None:
            evidence = tuple(watch.bank.best())
        self._tell(last, means, model, white, marks, evidence)
        if evidence:
            yield from self._judge(last, evidence)
        watch.since += white is not None
        if model is not None and white is not None and watch.close < REST:
            watch.close = watch.close + 1 if self._away(model) < CLOSE else 0
        if model is not None and self._has_moved(model, evidence):
            self._linearise(watch)

    def _begin_watch(self, watch: _Watch) -> None:
        steady = watch.model.steady
        assert steady is not None
        oldest = self.options.window
        watch.responses = onset_responses(self._gear, watch.model.coefficients, steady, oldest)
        if watch.filter is None:
            watch.filter = WhiteningFilter(watch.known, watch.responses, self.options.inflation)

    def _has_moved(self, towed: TowedStretch, evidence: Sequence[OnsetEvidence]) -> bool:
        watch = self._watch
        rarest = evidence[0].rarity if evidence else 0.0
        if watch.filter is None or watch.since < REST or self.open is not None:
            return False
        anew = self._may_begin_anew
        if anew and rarest > AT_REST and not self._learns:
            return False
        # The model would begin in an equilibrium while the gear was on its way to one.
        rests = not any(list(watch.moved)[:-BEFORE])
        return self._far(towed) and (rests or not anew)

    @property
    def _may_begin_anew(self) -> bool:
        watch = self._watch
        early = watch.learned + watch.since <= LEARNING or self._learns
        return early and not watch.absorbed

    @property
    def _learns(self) -> bool:
        """True until boards have been close to those that derivatives are of."""
        return self._watch.close < REST

    def _far(self, towed: TowedStretch) -> bool:
        return self._away(towed) > MOVED

    def _away(self, towed: TowedStretch) -> float:
        """Largest change of a channel by what boards were learned to be, in the model's error."""
        watch = self._watch
        if watch.filter is None:
            return 0.0
        moved = watch.filter.coefficients - watch.model.coefficients
        return float(np.max(np.abs(towed.by_coefficients @ moved) / towed.model_error))

    def _linearise(self, watch: _Watch) -> None:
        """Tow anew with the coefficients as they were learned."""
        assert watch.filter is not None
        learned = watch.filter.coefficients
        if self._may_begin_anew:
            # Estimates of all else came with derivatives from far off.
            watch.filter.doubt(learned - watch.model.coefficients)
            watch.known = replace(watch.known, values=learned, covariance=watch.filter.covariance)
            watch.filter = watch.responses = None
            watch.bank.forget()
            watch.model.begin_anew(learned)
        else:
            watch.filter.doubt(learned - watch.model.coefficients)
            watch.model.go_on_with(learned)
        watch.learned, watch.since = watch.learned + watch.since, 0

    def _tell(
        self, last: LastStretch, means: FloatArray, towed: TowedStretch | None,
        white: Whitened | None, marks: FloatArray | None,
        evidence: tuple[OnsetEvidence, ...],
    ) -> None:  # fmt: skip
        if white is None or self.why_not:
            self.unwatched += 1
        else:
            self.watched += 1
        self._on_stretch(
            WatchedStretch(last.end_ns, means, towed, white, marks, evidence, self.why_not)
        )

    def _judge(self, last: LastStretch, evidence: Sequence[OnsetEvidence]) -> Iterator[Finding]:
        before, limit = self.open, self.options.limit
        rarest = evidence[0]
        if before is None:
            if rarest.rarity > limit:
                yield self._raise(last, evidence)
            return
        if rarest.rarity < 0.5 * limit:
            yield self._put(replace(before, state='withdrawn', updated_ns=last.end_ns))
            return
        found = finding(self.table, before.number, last.end_ns, evidence, before.raised_ns, limit)
        if found.onset_ns >= before.raised_ns:
            # An onset after the finding was raised is that of another one.
            yield self._put(replace(before, state='withdrawn', updated_ns=last.end_ns))
            if rarest.rarity > limit:
                yield self._raise(last, evidence)
            return
        age = (last.end_ns - before.onset_ns) / (LIVE.stretch_s * SECOND)
        if age >= self.options.settled:
            found = replace(found, state='settled')
            self._take_along(found)
        yield self._put(found)

    def _raise(self, last: LastStretch, evidence: Sequence[OnsetEvidence]) -> Finding:
        self._newest += 1
        now, limit = last.end_ns, self.options.limit
        return self._put(finding(self.table, self._newest, now, evidence, now, limit))

    def _take_along(self, found: Finding) -> None:
        """Take what was found along as known to be there, and watch for what comes beside it."""
        watch = self._watch
        assert watch.filter is not None
        (candidate,) = (one for one in self.table.candidates if one.name == found.name)
        first = round((found.updated_ns - found.onset_ns) / (LIVE.stretch_s * SECOND))
        number = self._last_number - first + 1
        for column in candidate.columns:
            # The oldest makes room.
            place = watch.taken % MOST_ABSORBED
            watch.taken += 1
            watch.absorbed = [one for one in watch.absorbed if one.place != place]
            watch.filter.absorb(place, float(self.table.scale[column]))
            watch.absorbed.append(_Absorbed(column, number, place))
        watch.filter.loosen()
        watch.bank.forget()

    def _taken_along(self, lasting: FloatArray | None, number: int) -> FloatArray:
        """Signatures (k, `MOST_ABSORBED`) of what is taken along, in a stretch."""
        self._last_number = number
        found = np.zeros((len(WATCHED), MOST_ABSORBED))
        watch = self._watch
        if lasting is None or watch.responses is None:
            return found
        for one in watch.absorbed:
            own = [one.column]
            ages = np.array([max(number - one.onset, 0)])
            known = watch.responses.only(own).since(lasting[:, own], ages, self._growing[own])
            found[:, one.place] = known[0, :, 0]
        return found
