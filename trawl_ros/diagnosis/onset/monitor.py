# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Monitor of a tow that goes on: raises a finding minutes after an effect begins.

The model is towed along each stretch once, as it comes. Where boards are learned to be others than
those that it is towed with, the last of the tow is watched again with these, some stretches with
each new one, and that watch takes the place of the first.
"""

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import CandidateTable, candidate_table
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.judging import finding
from trawl_ros.diagnosis.onset.knowledge import Knowledge, of_gear_file
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence
from trawl_ros.diagnosis.onset.stretches import LIVE, LastStretch, StretchCutter
from trawl_ros.diagnosis.onset.towing import SETTLING_S, WatchedGear
from trawl_ros.diagnosis.onset.watch import (
    CLOSE,
    REST,
    Watch,
    WatchedStretch,
    WatchSettings,
    WatchState,
)
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.stretches import FEWEST
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import Sample

NOT_CLOSE = 'something may have begun, or boards are others: the tow is watched again first'
"""Reason for which no finding is raised of evidence beyond the limit."""

BEFORE, QUIET = FEWEST - 1, 8
"""Stretches up to the newest, behind the first that a model begun again with the next is towed
along; and the last of those before, that first among them, in which nothing may have moved: the
model would begin in an equilibrium while the gear was on its way to one."""

AGAIN, MOST_KEPT, AHEAD, HURRIED = 60, 120, 4, 8
"""Stretches that are watched again, at least where the tow is that long; that are kept, at most;
and that are watched again with each new one, and while boards are learned first."""

SHORTEST, WAITS = 0.2, 20
"""Part of a change of boards below which it is not tried; stretches until all of it is tried
again."""

NEARER = 0.1, 0.2, 0.3, 0.4
"""Parts of the way from the known boards to those of the gear file. Where the model cannot be
towed, they are tried in turn. The model is linearised there first; what is known stays so."""

POORLY, LEARNING = 0.5, 20
"""Std of boards, in that of the gear file's prior (geometric mean), beyond which they are known too
poorly to tell one state of the gear by another; and stretches through which they are learned then,
at least."""

WHITE_LIMIT, MARGIN = 6.41, 1.4
"""Rarity that white innovations exceed once in 230 h, over all candidates and onsets, by
``make study NAME=onset ARGS='--limit 200 --seed 7100'``; and the factor on it for what is not
quite white, by hand. docs/studies/onset.md has how rare innovations of clean tows are."""


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
class _Kept:
    """Stretch that may be watched again, with the state before it.

    ``rests`` is true where the model may begin with it, ``predicted`` where it was towed along it.
    """

    last: LastStretch
    before: WatchState
    rests: bool
    predicted: bool


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
    withheld
        Reason why evidence beyond the limit raises nothing yet; empty where there is none.
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
        watched = WatchedGear(build_model(gear), effects_of(gear), self.table.at_one_hour())
        own, prior = self.options, board_prior(gear)
        self._usual = prior.start
        known = np.sqrt(np.diag(self._known.covariance)) / prior.std
        learning = LEARNING if np.exp(np.mean(np.log(known))) > POORLY else 0
        self._settings = WatchSettings(watched, self.table, own.window, own.inflation, learning)
        self._depth = build_water(gear).depth
        self._on_stretch = on_stretch
        self.why_not = self.withheld = ''
        self.findings: dict[int, Finding] = {}
        self._newest = last_number
        self.reset()

    def reset(self) -> None:
        """Begin again with no tow; findings so far stay as they are."""
        if (left := self.open) is not None:
            self._put(replace(left, state='settled'))
        self._cutter = StretchCutter(self._depth)
        self._watch = Watch(self._settings, self._known, self._known.values)
        self._tried = 0
        self._next: Watch | None = None
        self._kept: deque[_Kept] = deque(maxlen=MOST_KEPT)
        self._moved: deque[bool] = deque(maxlen=QUIET + BEFORE)
        self._rarity, self._part, self._not_before = 0.0, 1.0, 0
        self._owed = self._confirmed = False
        self.watched = self.unwatched = 0
        self.why_not, self.withheld = 'the tow has just begun', ''

    def feed(self, sample: Sample) -> list[Finding]:
        """Take a sample; return findings that are new or have changed."""
        # Told before the rest of the work is done: whoever asked has it meanwhile.
        if self._owed:
            self._owed = False
            self._catch_up()
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
        before = self._watch.state
        stretch = self._watch.advance(last)
        self._keep(last, before, stretch)
        self.why_not, self.withheld, self._rarity = stretch.why_not, '', stretch.rarity
        if stretch.white is None or stretch.why_not:
            self.unwatched += 1
        else:
            self.watched += 1
        self._on_stretch(stretch)
        if stretch.evidence:
            yield from self._judge(last, stretch.evidence)
        if self._watch.refused:
            self._try_others(last.number)
        self._owed = True

    def _try_others(self, number: int) -> None:
        """Watch with other boards from the next stretch on.

        After the last of `NEARER` the watch waits as after any stop, and then tries all again.
        """
        way, turn = self._usual - self._known.values, self._tried % (len(NEARER) + 1)
        self._tried += 1
        if turn < len(NEARER) and np.any(way):
            boards = self._known.values + NEARER[turn] * way
            self._watch = Watch(self._settings, self._known, boards, number=number)

    def _keep(self, last: LastStretch, before: WatchState, stretch: WatchedStretch) -> None:
        # The model begins some minutes before the first stretch that it is towed along.
        begins = last.tow is not None and last.place * LIVE.stretch_s >= SETTLING_S - 1e-6
        self._moved.append(any(last.moves))
        rests = begins and not last.fell and not any(list(self._moved)[:-BEFORE])
        self._kept.append(_Kept(last, before, rests, stretch.towed is not None))

    def _catch_up(self) -> None:
        """Watch a part of what was watched again, with other boards, where there is reason to."""
        if self.open is not None:
            # A finding is followed by the watch that made it.
            self._next = None
            return
        if self._next is None:
            self._next = self._again()
        if self._next is None:
            return
        behind = [kept for kept in self._kept if kept.last.number > self._next.number]
        limit, rarity = self.options.limit, 0.0
        pace = HURRIED if self._watch.learns or self._rarity > limit else AHEAD
        for kept in behind[:pace]:
            stretch = self._next.advance(kept.last)
            rarity = stretch.rarity
            if kept.predicted and stretch.towed is None:
                self._refuse()
                return
        if len(behind) <= pace:
            # Of boards a part of the way to those as learned the same evidence proves nothing.
            self._confirmed = rarity > limit and self._part == 1.0
            self._compare(self._next)

    def _again(self) -> Watch | None:
        """Watch with the boards as they were learned; None where there is no reason for one."""
        watch, learned = self._watch, self._watch.learned
        if learned is None or watch.away < CLOSE or watch.number < self._not_before:
            return None
        resting = [place for place, kept in enumerate(self._kept) if kept.rests]
        enough = [place for place in resting if place <= len(self._kept) - AGAIN]
        if not resting:
            return None
        first = self._kept[enough[-1] if enough else resting[0]]
        boards = watch.coefficients + self._part * (learned - watch.coefficients)
        own = self._settings, self._known, boards, first.before
        return Watch(*own, number=first.last.number - 1)

    def _refuse(self) -> None:
        """Go on with the watch as it is, and try a smaller change of boards."""
        self._next = None
        self._part *= 0.5
        if self._part < SHORTEST:
            self._settle(self._watch, WAITS)

    def _compare(self, other: Watch) -> None:
        """Take another watch where its boards are closer to what is learned with them."""
        if self._kept[-1].predicted and other.away >= self._watch.away:
            self._refuse()
            return
        hurried = self._watch.learns and not self._settings.learning
        if self._watch.learns:
            # That boards are close to what they were learned from proves nothing.
            other.close = 0
        self._watch, self._next = other, None
        self._settle(other, 0 if hurried else REST)

    def _settle(self, watch: Watch, waits: int) -> None:
        """Stay with a watch for so many stretches."""
        self._part, self._not_before = 1.0, watch.number + waits

    def _judge(self, last: LastStretch, evidence: Sequence[OnsetEvidence]) -> Iterator[Finding]:
        before, limit = self.open, self.options.limit
        rarest = evidence[0]
        if before is None:
            yield from self._raise(last, evidence)
            return
        if rarest.rarity < 0.5 * limit:
            yield self._put(replace(before, state='withdrawn', updated_ns=last.end_ns))
            return
        found = finding(self.table, before.number, last.end_ns, evidence, before.raised_ns, limit)
        if found.onset_ns >= before.raised_ns:
            # An onset after the finding was raised is that of another one.
            yield self._put(replace(before, state='withdrawn', updated_ns=last.end_ns))
            yield from self._raise(last, evidence)
            return
        age = (last.end_ns - before.onset_ns) / (LIVE.stretch_s * SECOND)
        if age >= self.options.settled:
            found = replace(found, state='settled')
            self._take_along(found)
        yield self._put(found)

    def _raise(self, last: LastStretch, evidence: Sequence[OnsetEvidence]) -> Iterator[Finding]:
        now, limit = last.end_ns, self.options.limit
        if evidence[0].rarity <= limit:
            self._confirmed = False
            return
        if self._watch.away >= CLOSE and not self._confirmed:
            # Where the gear of other boards would go on is as much evidence.
            self.withheld = NOT_CLOSE
            return
        self._newest, self._confirmed = self._newest + 1, False
        yield self._put(finding(self.table, self._newest, now, evidence, now, limit))

    def _take_along(self, found: Finding) -> None:
        """Take what was found along as known to be there, and watch for what comes beside it."""
        (candidate,) = (one for one in self.table.candidates if one.name == found.name)
        since = round((found.updated_ns - found.onset_ns) / (LIVE.stretch_s * SECOND))
        self._watch.take_along(candidate.columns, self._watch.number - since + 1)
        # A watch that begins before would not know of it.
        self._kept.clear()
        self._next = None
