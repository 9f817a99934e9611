"""Trial: a tow in which an effect begins, or none, towed by a plant and watched by the monitor."""

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import yaml

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import write_figure, write_text
from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.history import CourseKeeper
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.monitor import OnsetMonitor
from trawl_ros.diagnosis.onset.watch import WatchedStretch
from trawl_ros.diagnosis.report.onset_figure import onset_figure
from trawl_ros.effects.base.effect import Effect, Readings, Situation
from trawl_ros.effects.effect_set import NO_EFFECTS, ActiveEffect, EffectSet
from trawl_ros.effects.registry import catalogue
from trawl_ros.effects.sensor_effects import SensorEffects
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.suite import InstrumentSuite
from trawl_ros.lab.studies.onset.sizes import STEADY_SIZES, TIMES
from trawl_ros.lab.studies.soak.long_tow import coarse_gear
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import Sample
from trawl_ros.report.style import DPI
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import Scenario, load_scenario

KNOWN = 0.2
"""Std of the boards as they are known when the tow begins, in that of the gear file's prior: five
steady states tell as much."""

EARLIEST_MIN, LATEST_MIN = 10.0, 20.0
"""Minutes of a tow between which an effect begins."""

LENGTHS_M, SPEEDS_M_S = (320.0, 480.0), (2.1, 2.45)
LEG_MIN = (3.0, 9.0)


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
    seconds
        Processor time of the monitor.
    why_not
        Reason for which the trial could not be made.
    """

    number: int
    effect: str
    size: float
    begin_s: float | None
    raised_s: float | None = None
    onset_s: float | None = None
    name: str = ''
    alike: tuple[str, ...] = ()
    rarity: float = 0.0
    false: int = 0
    watched_s: float = 0.0
    unwatched_s: float = 0.0
    seconds: float = 0.0
    why_not: str = ''

    def record(self) -> dict[str, object]:
        """Record for JSON."""
        return asdict(self) | {'alike': list(self.alike)}


def make_trial(
    gear: str, seed: int, number: int, minutes: float, clean: bool, picture: Path | None = None
) -> OnsetTrial:
    """Tow and watch.

    Parameters
    ----------
    gear
        File or name; its net is cut as coarsely as may be, and the plant has warps and bridles
        twice as fine and no joined meshes.
    seed, number, clean
        Of the study, and of the trial, which decide on the course, the effect and the readings.
    minutes
        Of the tow.
    picture
        PNG file into which the tow is drawn as it was watched; None for none.
    """
    chance = np.random.default_rng([seed, number, int(clean)])
    names = list(STEADY_SIZES)
    effect = '' if clean else names[number % len(names)]
    begin = 60.0 * chance.uniform(EARLIEST_MIN, LATEST_MIN)
    size = 0.0
    acting = NO_EFFECTS
    if effect:
        acting, size = _beginning(catalogue()[effect], begin, chance)
    trial = OnsetTrial(number, effect, size, begin if effect else None)
    with TemporaryDirectory() as folder:
        record = coarse_gear(gear)
        scenario = _scenario(Path(folder), record, minutes, chance)
        # An effect that begins is none of a file: it takes the place of the plant's own.
        vars(scenario)['effect_set'] = acting
        raised: list[Finding] = []
        keeper = CourseKeeper()
        monitor = OnsetMonitor(
            load_gear(Path(folder) / 'gear.yaml'), _knowledge(record, chance), on_stretch=keeper
        )
        spent = 0.0
        try:
            for sample in _samples(scenario, acting):
                begun = time.process_time()
                raised += monitor.feed(sample)
                spent += time.process_time() - begun
        except TrawlError as reason:
            return replace(trial, why_not=str(reason))
    course = keeper.course
    if picture is not None:
        told = list(monitor.findings.values())
        write_figure(picture, onset_figure(course, told, monitor.options.limit, 0), DPI)
    first = {found.number: found for found in reversed(raised)}
    from_s = np.inf if trial.begin_s is None else trial.begin_s
    early = [one for one in first.values() if one.raised_ns / SECOND < from_s]
    later = [one for one in first.values() if one.raised_ns / SECOND >= from_s]
    trial = replace(
        trial, false=len(early), watched_s=30.0 * monitor.watched,
        unwatched_s=30.0 * monitor.unwatched, seconds=spent,
        rarity=float(np.nanmax(course.rarities, initial=0.0)),
    )  # fmt: skip
    if not later:
        return trial
    found = min(later, key=lambda one: one.number)
    last = monitor.findings[found.number]
    return replace(
        trial, raised_s=found.raised_ns / SECOND, onset_s=found.onset_ns / SECOND, name=last.name,
        alike=last.alike,
    )  # fmt: skip


def clean_marks(gear: str, seed: int, minutes: float) -> list[FloatArray]:
    """Marks (w, r, p) that the candidates would leave in each stretch of a clean tow."""
    chance = np.random.default_rng(seed)
    found: list[FloatArray] = []

    def keep(stretch: WatchedStretch) -> None:
        if stretch.marks is not None:
            found.append(stretch.marks)

    with TemporaryDirectory() as folder:
        record = coarse_gear(gear)
        scenario = _scenario(Path(folder), record, minutes, chance)
        monitor = OnsetMonitor(
            load_gear(Path(folder) / 'gear.yaml'), _knowledge(record, chance), on_stretch=keep
        )
        for sample in _samples(scenario, NO_EFFECTS):
            monitor.feed(sample)
    return found


def _beginning(
    effect: Effect, begin_s: float, chance: np.random.Generator
) -> tuple[EffectSet, float]:
    """Effect set of one that begins, and its size."""
    ((name, steady),) = STEADY_SIZES[effect.name].items()
    (place,) = (n for n, own in enumerate(effect.parameters) if own.name == name)
    own = effect.parameters[place]
    sign = chance.choice((-1.0, 1.0))
    if not own.low <= own.neutral + sign * TIMES * steady <= own.high:
        sign = -sign
    size = sign * TIMES * steady
    values = effect.neutral
    values[place] += size
    same = {key: getattr(effect, key) for key in Effect.__dataclass_fields__}
    beginning = Beginning(**same, of=effect, begin_h=begin_s / 3600.0)
    return EffectSet((ActiveEffect(beginning, values),)), float(size)


def _knowledge(gear: GearRecord, chance: np.random.Generator) -> Knowledge:
    """Boards as they are known: the truth, wrong by as much as is stated."""
    std = KNOWN * board_prior(gear).std
    truth = gear.board.coefficients.array()
    return Knowledge(truth + std * chance.standard_normal(len(std)), np.diag(std**2))


def _scenario(
    folder: Path, gear: GearRecord, minutes: float, chance: np.random.Generator
) -> Scenario:
    write_text(folder / 'gear.yaml', yaml.safe_dump(gear.model_dump(mode='json')))
    length, speed = chance.uniform(*LENGTHS_M), chance.uniform(*SPEEDS_M_S)
    steps: list[dict[str, object]] = []
    left = minutes
    while left > 0.0:
        leg = min(left, chance.uniform(*LEG_MIN))
        step: dict[str, object] = {'name': f'leg {len(steps) + 1}', 'minutes': float(leg)}
        if steps and chance.uniform() < 0.5:
            step['speed_m_s'] = float(chance.uniform(*SPEEDS_M_S))
        elif steps:
            step['warp_length_m'] = float(chance.uniform(*LENGTHS_M))
        steps.append(step)
        left -= leg
    record = {
        'description': 'a tow in which something may begin',
        'gear': 'gear.yaml',
        'seed': int(chance.integers(2**31)),
        'refine': {'warp': 2, 'bridle': 2, 'unjoined': True},
        'start': {'warp_length_m': float(length), 'speed_m_s': float(speed)},
        'steps': steps,
        'truth_rate_hz': 2.0,
        'record': ['instruments'],
    }
    path = folder / 'scenario.yaml'
    write_text(path, yaml.safe_dump(record))
    return load_scenario(path)


def _samples(scenario: Scenario, acting: EffectSet) -> Iterator[Sample]:
    trial = Trial(scenario)
    suite = InstrumentSuite(
        scenario.instruments, surroundings=scenario.surroundings, draws=scenario.draws
    )
    seen = SensorEffects(acting, build_water(scenario.plant))
    while (truth := trial.step()) is not None:
        yield from map(seen, suite.observe(truth))
