"""Trial: a tow in which an effect begins, or none, towed by a plant and watched by the monitor."""

import time
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from studies.kept import TrialTask
from studies.onset.known import drawn_knowledge, knowledge_by_tow
from studies.onset.plant import random_course, towed_samples, with_boards
from studies.onset.sizes import STEADY_SIZES, TIMES
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import write_figure
from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.history import WatchedCourse
from trawl_ros.diagnosis.onset.monitor import OnsetMonitor
from trawl_ros.diagnosis.onset.part import LIVE
from trawl_ros.diagnosis.onset.watch import WatchedStretch
from trawl_ros.diagnosis.report.onset_figure import onset_figure
from trawl_ros.effects.base.effect import Effect, Readings, Situation
from trawl_ros.effects.effect_set import NO_EFFECTS, ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.trials.linearised_plant import MeshResolution
from trawl_ros.model.gear_model import GearModel
from trawl_ros.report.style import DPI

EFFECT, CLEAN = 'effect', 'clean'
"""Series of trials."""

COARSEST = 12
"""Meshes around the mouth of the coarsest net there is."""

EARLIEST_MIN, LATEST_MIN = 10.0, 20.0
"""Minutes of a tow between which an effect begins."""

BEHIND_MIN = 10.0
"""Minutes behind its beginning of which it is told how long they were judged."""


@dataclass(frozen=True)
class Beginning(Effect):
    """Effect that is not there before a time of the tow."""

    of: Effect | None = None
    begin_h: float = 0.0

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Apply to inputs from its time on."""
        assert self.of is not None
        return self.of.apply_to_inputs(values, inputs, self._since(at)) if self._on(at) else inputs

    def gear(self, values: FloatArray, model: GearModel, at: Situation) -> GearModel:
        """Gear model, with the effect from its time on."""
        assert self.of is not None
        return self.of.gear(values, model, self._since(at)) if self._on(at) else model

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Apply to sensors from its time on."""
        assert self.of is not None
        if not self._on(at):
            return readings
        return self.of.apply_to_sensors(values, readings, self._since(at))

    def _on(self, at: Situation) -> bool:
        return at.hours >= self.begin_h

    def _since(self, at: Situation) -> Situation:
        return replace(at, hours=at.hours - self.begin_h)


@dataclass(frozen=True)
class OnsetTask(TrialTask):
    """Task of one trial.

    Attributes
    ----------
    minutes
        Of the tow.
    known
        Source of what is known of the boards when the tow begins.
    pictures
        Folder into which the tow is drawn as it was watched; '' for none.
    """

    minutes: float
    known: str
    pictures: str


@dataclass(frozen=True)
class OnsetTrial:
    """Result of a trial.

    Attributes
    ----------
    number
        Of the trial.
    effect, size, begin_s
        Effect that begins, its size, and the time; '' and None in a clean tow.
    raised_s, onset_s, name, alike, rarity
        First finding that is raised: when, its onset, likeliest name at last and others; None or
        empty where there is none. The largest rarity in the tow.
    false
        Findings that were raised before anything began.
    watched_s, unwatched_s
        Time that was compared with the model, and that could not be.
    behind_s
        Time that was judged of the `BEHIND_MIN` behind the beginning of the effect.
    clean_s
        Time that was judged before anything began.
    fallen_s
        Time for which a board of the plant had fallen.
    seconds
        Processor time of the monitor.
    why_not
        Reason for which the trial could not be made.
    known
        Source of what was known of the boards, where it was a tow before.
    reasons
        Time (s) that was not judged, by the reason.
    """

    number: int
    effect: str
    size: float
    begin_s: float | None
    raised_s: float | None = None
    onset_s: float | None = None
    name: str = ''
    alike: list[str] = field(default_factory=list)
    rarity: float = 0.0
    false: int = 0
    watched_s: float = 0.0
    unwatched_s: float = 0.0
    behind_s: float = 0.0
    clean_s: float = 0.0
    fallen_s: float = 0.0
    seconds: float = 0.0
    why_not: str = ''
    known: str = ''
    reasons: dict[str, float] = field(default_factory=dict)
    series: str = ''


def make_trial(task: OnsetTask) -> OnsetTrial:
    """Tow and watch.

    The net is cut as coarsely as may be. The plant has warps and bridles twice as fine, no joined
    meshes, and boards drawn from the file's prior.

    Raises
    ------
    GearError
        If the gear cannot be read, or has no boards.
    """
    number, clean = task.number, task.series == CLEAN
    record = MeshResolution(COARSEST).model(task.gear)
    record.require_boards('whose tow could be watched')
    rng = np.random.default_rng([task.seed, number, int(clean)])
    names = list(STEADY_SIZES)
    effect = '' if clean else names[number % len(names)]
    begin = 60.0 * rng.uniform(EARLIEST_MIN, LATEST_MIN)
    size = 0.0
    acting = NO_EFFECTS
    if effect:
        acting, size = _beginning(catalogue()[effect], begin, rng)
    trial = OnsetTrial(number, effect, size, begin if effect else None, series=task.series)
    if effect == 'floats' and record.floats.buoyancy_n == 0.0:
        return replace(trial, why_not='the gear has no floats')
    raised: list[Finding] = []
    told: list[WatchedStretch] = []
    spent = fallen_s = 0.0
    with TemporaryDirectory() as folder:
        scenario = random_course(Path(folder), record, task.minutes, rng)
        try:
            scenario = with_boards(scenario, rng)
            believed = scenario.gear
            if task.known == 'draw':
                known = drawn_knowledge(record, scenario.plant.board.coefficients.array(), rng)
            else:
                known, by = knowledge_by_tow(Path(folder), scenario, believed, rng)
                trial = replace(trial, known=by)
            # An effect that begins is none of a file: it takes the place of the plant's own.
            vars(scenario)['effect_set'] = acting
            monitor = OnsetMonitor(believed, known, on_stretch=told.append)
            for samples, fallen in towed_samples(scenario, acting):
                fallen_s += fallen / scenario.record.truth_rate_hz
                begun = time.process_time()
                for sample in samples:
                    raised += monitor.feed(sample)
                spent += time.process_time() - begun
        except TrawlError as reason:
            return replace(trial, why_not=str(reason))
    course = WatchedCourse.of(told)
    if task.pictures:
        picture = Path(task.pictures) / f'{task.name.replace(" ", "_")}.png'
        findings = list(monitor.findings.values())
        write_figure(picture, onset_figure(course, findings, monitor.options.limit, 0), DPI)
    first = {found.number: found for found in reversed(raised)}
    reasons = Counter(one.why_not.partition(':')[0] for one in told if one.why_not)
    from_s = np.inf if trial.begin_s is None else trial.begin_s
    early = [one for one in first.values() if one.raised_ns / SECOND < from_s]
    later = [one for one in first.values() if one.raised_ns / SECOND >= from_s]
    trial = replace(
        trial, behind_s=_judged(course, from_s, from_s + 60.0 * BEHIND_MIN),
        clean_s=_judged(course, 0.0, from_s), false=len(early), seconds=spent,
        watched_s=LIVE.stretch_s * monitor.watched,
        unwatched_s=LIVE.stretch_s * monitor.unwatched, fallen_s=fallen_s,
        rarity=float(np.nanmax(course.rarities, initial=0.0)),
        reasons={why: LIVE.stretch_s * number for why, number in reasons.items()},
    )  # fmt: skip
    if not later:
        return trial
    found = min(later, key=lambda one: one.number)
    last = monitor.findings[found.number]
    return replace(
        trial, raised_s=found.raised_ns / SECOND, onset_s=found.onset_ns / SECOND, name=last.name,
        alike=list(last.alike),
    )  # fmt: skip


def clean_marks(gear: str, seed: int, minutes: float) -> list[FloatArray]:
    """Marks (w, r, p) that the candidates would leave in each stretch of a clean tow of the boards
    of the gear file.
    """
    rng = np.random.default_rng(seed)
    found: list[FloatArray] = []
    with TemporaryDirectory() as folder:
        record = MeshResolution(COARSEST).model(gear)
        boards = record.board.coefficients.array()
        scenario = random_course(Path(folder), record, minutes, rng)
        monitor = OnsetMonitor(
            load_gear(Path(folder) / 'gear.yaml'),
            drawn_knowledge(record, boards, rng),
            on_stretch=lambda _: found.append(monitor.watch.marks),
        )
        for samples, _ in towed_samples(scenario, NO_EFFECTS):
            for sample in samples:
                monitor.feed(sample)
    return [marks for marks in found if marks.size]


def _judged(course: WatchedCourse, from_s: float, until_s: float) -> float:
    """Time (s) between two times that was judged."""
    ends = course.ends_ns / SECOND
    between = (ends > from_s) & (ends <= until_s)
    return LIVE.stretch_s * float(np.sum(np.isfinite(course.rarities[between])))


def _beginning(effect: Effect, begin_s: float, rng: np.random.Generator) -> tuple[EffectSet, float]:
    """Effect set of one that begins, and its size."""
    ((name, steady),) = STEADY_SIZES[effect.name].items()
    (place,) = (n for n, own in enumerate(effect.parameters) if own.name == name)
    own = effect.parameters[place]
    sign = rng.choice((-1.0, 1.0))
    if not own.low <= own.neutral + sign * TIMES * steady <= own.high:
        sign = -sign
    size = sign * TIMES * steady
    values = effect.neutral
    values[place] += size
    same = {key: getattr(effect, key) for key in Effect.__dataclass_fields__}
    beginning = Beginning(**same, of=effect, begin_h=begin_s / 3600.0)
    return EffectSet((ActiveEffect(beginning, values),)), float(size)
