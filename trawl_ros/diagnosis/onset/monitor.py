# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Monitor of a tow that goes on: raises a finding minutes after an effect begins.

The model is towed along each stretch once, as it comes. Where boards are learned to be others than
those that it is towed with, the last of the tow is watched again with these, some stretches with
each new one, and that watch takes the place of the first.
"""

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.diagnosis.onset.candidates import candidate_table
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.gear import WatchedGear
from trawl_ros.diagnosis.onset.judging import finding
from trawl_ros.diagnosis.onset.knowledge import Knowledge, of_gear_file
from trawl_ros.diagnosis.onset.part import LENGTH_NS, SETTLING
from trawl_ros.diagnosis.onset.residuals import belief_of
from trawl_ros.diagnosis.onset.watch import (
    CLOSE,
    JUST_BEGUN,
    REST,
    Watch,
    WatchedStretch,
    WatchSettings,
    WatchStart,
)
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import Sample

NOT_CLOSE = 'something may have begun, or boards are others: the tow is watched again first'
"""Reason why evidence beyond the limit raises no finding."""

BOARDS_TRIED = 16
"""Number of boards drawn from what is known that are tried in turn where the model cannot be towed.
The model is linearised there first; what is known stays so. A gear file's own boards fell on the
fastening points of 5 of 8 drawn plants. After the last of them the next part begins."""

WHITE_LIMIT, MARGIN = 6.41, 1.4
"""Rarity that white innovations exceed once in 230 h, over all candidates and onsets, by
``make study NAME=onset ARGS='--limit 200 --seed 7100'``; and the factor on it for what is not
quite white, by hand. docs/studies/onset.md has how rare innovations of clean tows are."""


@dataclass(frozen=True)
class OnsetOptions:
    """Options of the monitor; times are in stretches of 30 s.

    Attributes
    ----------
    settled
        Stretches since its onset after which a finding stays as it is.
    limit
        Rarity beyond which a finding is raised: `MARGIN` times `WHITE_LIMIT`.
    again, longest
        Stretches that are watched again with other boards, at least where the tow is that long;
        and after which the watch begins with these, for its memory grows with their square.
    pace, hurried_pace
        Stretches that are watched again with each new one; and while boards are learned first, or
        where something may have begun.
    smallest_change
        Part of a change of boards below which it is not tried.
    pause
        Stretches until all of a change is tried again.
    poorly_known, learning
        Std of boards, in that of the gear file's prior (geometric mean), beyond which the states
        of the gear look alike; and stretches in which boards are learned after that.
    """

    settled: int = 50
    limit: float = round(MARGIN * WHITE_LIMIT, 1)
    again: int = 60
    longest: int = 180
    pace: int = 4
    hurried_pace: int = 16
    smallest_change: float = 0.2
    pause: int = 20
    poorly_known: float = 0.5
    learning: int = 20


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
    watch
        Watch over the part of the tow that goes on.
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
        self.options = own = options or OnsetOptions()
        self._known = known = knowledge or of_gear_file(gear)
        prior, self.table = board_prior(gear), candidate_table(effects)
        std = np.sqrt(np.diag(known.covariance)) / prior.std
        learning = own.learning if np.exp(np.mean(np.log(std))) > own.poorly_known else 0
        watched = WatchedGear(build_model(gear), effects_of(gear), self.table.at_one_hour())
        water = build_water(gear)
        self._settings = WatchSettings(watched, water, self.table, known, learning=learning)
        self._low, self._high, self._on_stretch = prior.low, prior.high, on_stretch
        self.findings: dict[int, Finding] = {}
        self._newest = last_number
        self.reset()

    def reset(self) -> None:
        """Begin a new tow; findings stay."""
        known = self._known
        self.watch = Watch(self._settings, WatchStart(known.values, belief_of(known)))
        self._samples: deque[Sample] = deque()
        self._next: Watch | None = None
        self._rarity, self._part, self._not_before_ns, self._told_ns = 0.0, 1.0, 0, 0
        self._owed = self._confirmed = False
        self._tried = self.watched = self.unwatched = 0
        self._draws = np.random.default_rng(1)
        self.why_not, self.withheld = JUST_BEGUN, ''

    def feed(self, sample: Sample) -> list[Finding]:
        """Take a sample; return findings that are new or have changed."""
        # Findings go out before the rest of the work is done.
        if self._owed:
            self._owed = False
            self._catch_up()
        self._samples.append(sample)
        if self._next is not None:
            self._next.feed(sample)
        return list(self._take()) if self.watch.feed(sample) else []

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

    def _take(self) -> Iterator[Finding]:
        stretch = self.watch.advance()
        self.why_not, self.withheld, self._rarity = stretch.why_not, '', stretch.rarity
        if stretch.end_ns > self._told_ns:
            # Along one stretch several boards may be tried in turn.
            self._told_ns = stretch.end_ns
            self.unwatched += bool(stretch.why_not)
            self.watched += not stretch.why_not
            self._on_stretch(stretch)
        if self.watch.evidence:
            yield from self._judge(stretch.end_ns)
        if self.watch.lost or len(self.watch) > 2 * self.options.longest:
            self._begin_again()
        oldest_ns = self.watch.part.begin_ns(0)
        while self._samples and self._samples[0].stamp < oldest_ns:
            self._samples.popleft()
        self._owed = True

    def _watch_from(self, begin_ns: int, start: WatchStart) -> Watch:
        """Return a watch that begins at a stamp."""
        watch = Watch(self._settings, start)
        for sample in self._samples:
            if sample.stamp >= begin_ns:
                watch.feed(sample)
        return watch

    def _begin_again(self) -> None:
        """Begin another part behind the newest stretch.

        Where the model was never towed, other boards that are as likely are tried first.
        """
        watch, begin_ns, belief = self.watch, self.watch.part.end_ns, self.watch.belief()
        start = replace(watch.start, belief=belief, compared=watch.compared)
        if watch.refused and not self.watched:
            boards, self._tried = self._known.values, self._tried + 1
            if self._tried % (BOARDS_TRIED + 1):
                away = belief.root @ self._draws.standard_normal(len(belief.mean))
                boards = np.clip(watch.learned + away[: len(boards)], self._low, self._high)
                begin_ns = watch.part.begin_ns(0)
            start = replace(start, coefficients=boards)
        self.watch, self._next = self._watch_from(begin_ns, start), None

    def _catch_up(self) -> None:
        """Watch a part of the tow again with other boards, where there is reason to.

        That watch is taken where its boards are closer to what is learned with them; otherwise a
        smaller change of boards is tried.
        """
        if self.open is not None:
            # A finding is followed by the watch that made it.
            self._next = None
            return
        if self._next is None:
            self._next = self._again()
        other, watch, own = self._next, self.watch, self.options
        if other is None:
            return
        hurry = watch.learns or self._rarity > own.limit
        stretch = other.advance(own.hurried_pace if hurry else own.pace)
        if not other.lost and len(other) < other.part.number:
            return
        self._next = None
        if not other.lost:
            # Of boards a part of the way to those as learned the same evidence proves nothing.
            self._confirmed = stretch.rarity > own.limit and self._part == 1.0
        if other.lost or (other.away >= watch.away and len(watch) <= own.longest):
            self._part *= 0.5
            if self._part < own.smallest_change:
                self._settle(own.pause)
            return
        if watch.learns:
            # That boards are close to what they were learned from proves nothing.
            other.close = 0
        self.watch = other
        self._settle(0 if watch.learns and not self._settings.learning else REST)

    def _again(self) -> Watch | None:
        """Return a watch with the boards as they were learned; None without a reason for one."""
        watch, own = self.watch, self.options
        far = watch.away >= CLOSE and watch.part.end_ns >= self._not_before_ns
        if not (far or len(watch) > own.longest):
            return None
        first = max(len(watch) - own.again - SETTLING, 0)
        at, belief = watch.start.coefficients, watch.belief(first + SETTLING)
        there = at + self._part * (watch.learned - at)
        start = replace(watch.start, coefficients=there, belief=belief)
        return self._watch_from(watch.part.begin_ns(first), start)

    def _settle(self, waits: int) -> None:
        """Stay with the watch for so many stretches."""
        self._part, self._not_before_ns = 1.0, self.watch.part.end_ns + waits * LENGTH_NS

    def _judge(self, now_ns: int) -> Iterator[Finding]:
        before, limit = self.open, self.options.limit
        found = finding(self.table, self.watch.evidence, now_ns, limit)
        if before is not None:
            if found.rarity >= 0.5 * limit and found.onset_ns < before.raised_ns:
                found = replace(found, number=before.number, raised_ns=before.raised_ns)
                if now_ns - before.onset_ns >= self.options.settled * LENGTH_NS:
                    found = replace(found, state='settled')
                    self._take_along(found)
                yield self._put(found)
                return
            # An onset after the finding was raised is that of another one.
            yield self._put(replace(before, state='withdrawn', updated_ns=now_ns))
        if found.rarity <= limit:
            self._confirmed = False
        elif self.watch.away >= CLOSE and not self._confirmed:
            # Where the gear of other boards would go on is as much evidence.
            self.withheld = NOT_CLOSE
        else:
            self._newest, self._confirmed = self._newest + 1, False
            yield self._put(replace(found, number=self._newest))

    def _take_along(self, found: Finding) -> None:
        """Take what was found as present, and watch for what begins beside it."""
        (columns,) = (one.columns for one in self.table.candidates if one.name == found.name)
        self.watch.take_along(columns, found.onset_ns, found.updated_ns)
        self._next = None
