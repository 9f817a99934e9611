"""Smallest detectable sizes of effects, by steady windows alone and by all of the tows.

A size is detectable that exceeds in 80 % of trials what chance makes of a gear in order in one of a
hundred, in any of about thirty looks.
"""

import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from studies.motion.detectable_information import ExaminedGear, information_in_motion
from studies.motion.plant import COURSE, towed_samples
from studies.motion.trial import MotionTask
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.diagnosis.inference.blocks import blocks_of
from trawl_ros.diagnosis.inference.candidates import Candidate, lower_edges, signatures
from trawl_ros.diagnosis.inference.marginal import marginal
from trawl_ros.diagnosis.inference.refit import fit_boards
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.bag_motion import STRETCHES
from trawl_ros.estimation.from_gear import board_prior, finder_for, predictor_for
from trawl_ros.estimation.motion.nuisances import ADDED_MASS_STD
from trawl_ros.estimation.motion.series import tow_readings
from trawl_ros.estimation.motion.stretches import moving_tow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.tows import FoundWindows, numbered
from trawl_ros.estimation.windows.records import Rejections, SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.trials.linearised_plant import State
from trawl_ros.lab.trials.strength import DETECTED_SIGMAS, ERRORS_AS_STATED
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import Sample
from trawl_ros.report.rendering import number as in_digits
from trawl_ros.scenario.records import SteadyStartRecord, StepRecord
from trawl_ros.scenario.scenario import Scenario, load_scenario

STATES: tuple[tuple[State, State, State], ...] = (
    ((550.0, 2.4), (400.0, 2.2), (300.0, 2.0)),
    ((600.0, 2.2), (450.0, 2.4), (320.0, 2.1)),
    ((500.0, 2.3), (380.0, 2.0), (250.0, 1.9)),
    ((420.0, 2.1), (300.0, 2.4), (220.0, 1.9)),
)
"""Warp length (m) and speed (m/s) of the states of each tow."""

STATE_MINUTES = 20.0
"""Of each state, the hauling that leads to it among them."""

HEADINGS = (0.0, np.pi, 0.0, np.pi)
"""ENU yaw (rad) of each tow: both courses of one track."""


@dataclass(frozen=True)
class ReadTows:
    """Tows as they are read: in motion, and their steady windows."""

    moving: tuple[MovingTow, ...]
    windows: tuple[SteadyWindow, ...]


def tow_and_read(gear: GearRecord, coefficients: FloatArray, seeds: Sequence[int]) -> ReadTows:
    """Tow the four with the model as its own plant, and read them by the default instruments.

    Parameters
    ----------
    gear
        Model and plant.
    coefficients
        Of its boards (12,).
    seeds
        Of the instruments in each tow.

    Raises
    ------
    NoSteadyState, StepFailed
        If the gear cannot be towed so.
    """
    moving, found, depth = [], [], build_water(gear).depth
    each = zip(STATES, HEADINGS, seeds, strict=True)
    for number, (states, heading, seed) in enumerate(each, start=1):
        name = f'tow {number}'
        samples = towed_samples(gear, coefficients, 0.0, _course(states), seed, heading)
        moving.append(moving_tow(tow_readings(samples, depth, name), name, STRETCHES))
        windows = _steady_windows(gear, samples)
        found.append(FoundWindows(name, windows, {}, {}, Rejections(), None, ()))
    return ReadTows(tuple(moving), tuple(numbered(found)[0]))


def _course(states: Sequence[State]) -> Scenario:
    """Scenario of a tow; instruments and all else are those of the demo."""
    usual = load_scenario(COURSE)
    (length, speed), *_ = states
    steps = tuple(
        StepRecord(
            name=f'{length:g} m at {speed:g} m/s', minutes=STATE_MINUTES,
            warp_length_m=length, speed_m_s=speed,
        )
        for length, speed in states
    )  # fmt: skip
    start = SteadyStartRecord(warp_length_m=length, speed_m_s=speed)
    record = usual.record.model_copy(update={'start': start, 'steps': steps})
    return replace(usual, record=record)


def _steady_windows(gear: GearRecord, samples: Sequence[Sample]) -> tuple[SteadyWindow, ...]:
    finder = finder_for(gear)
    decided = [item for sample in samples for item in finder.feed(sample)]
    every = (*decided, *finder.finish())
    return tuple(item for item in every if isinstance(item, SteadyWindow))


@dataclass(frozen=True)
class DetectableSizes:
    """Smallest detectable sizes; those of several values of an effect, each alone.

    Attributes
    ----------
    effects, values, units
        Effect, name and unit of each of m values.
    windows, motion : m numbers
        Sizes by steady windows alone, and by all of the tows; None where nothing shows.
    added_mass
        The same of the added mass of the boards by all of the tows; no window shows it.
    number_of_windows, counted_s
        Steady windows, and time of the stretches that count.
    cpu_s
        Processor time of it all.
    """

    series: str
    number: int
    effects: list[str]
    values: list[str]
    units: list[str]
    windows: list[float | None]
    motion: list[float | None]
    added_mass: float | None
    number_of_windows: int
    counted_s: float
    cpu_s: float


def run_detectable(task: MotionTask) -> DetectableSizes:
    """Tow, read and compare.

    Raises
    ------
    TrawlError
        If the gear cannot be towed, or most windows have no steady state in the model.
    """
    begun = time.process_time()
    record, rng = task.mesh.model(task.gear), task.rng()
    truth = record.board.coefficients.array()
    read = tow_and_read(record, truth, rng.integers(2**31, size=len(STATES)).tolist())
    predictor, prior = predictor_for(record), board_prior(record)
    base = fit_boards(predictor, prior, read.windows)
    if base is None or len(base.fit.windows) < len(read.windows):
        raise TrawlError(f'{task.name}: windows of the model have no steady state in it')
    depths = lower_edges(base.fit.windows)
    # Of an effect that is looked for in several places the first, as in the table of a diagnosis.
    wanted = tuple(
        Candidate(effect, effect.starts(depths)[0])
        for effect in catalogue().values()
        if effect.fitted
    )
    columns = signatures(predictor, base.fit.windows, wanted)
    units = np.concatenate([candidate.scale for candidate in wanted])
    still = marginal(blocks_of(base.fit, [own * units for own in columns], errors=ERRORS_AS_STATED))
    coefficients = base.fit.coefficients[: len(prior)]
    gear = ExaminedGear(predictor.model, predictor.fixed, coefficients, prior, wanted)
    moving = information_in_motion(gear, read.moving)
    number = len(gear.units)
    parameters = [own for candidate in wanted for own in candidate.effect.parameters]
    return DetectableSizes(
        series=task.series,
        number=task.number,
        effects=[one.name for one in wanted for _ in one.effect.parameters],
        values=[own.name for own in parameters],
        units=[own.unit for own in parameters],
        windows=_numbers(gear.units * DETECTED_SIGMAS * still.std(range(number))),
        motion=_numbers(gear.units * DETECTED_SIGMAS * moving.evidence.std(range(number))),
        added_mass=_numbers(ADDED_MASS_STD * DETECTED_SIGMAS * moving.added_mass.std(range(1)))[0],
        number_of_windows=len(read.windows),
        counted_s=moving.counted_s,
        cpu_s=time.process_time() - begun,
    )  # fmt: skip


def _numbers(sizes: Iterable[float]) -> list[float | None]:
    return [float(size) if math.isfinite(size) else None for size in sizes]


MOST_RATIO = 0.5
"""Smallest detectable size by all of the tows over that by their windows, at most."""

SERIES = 'four tows of an hour'


def detectable_rows(found: DetectableSizes) -> list[MeasuredValue]:
    """Medians over effects and over their values, and a row for each effect."""
    ratios, every, rows, blind = [], [], [], []
    for effect, lines in groupby(_lines(found), lambda line: line[0]):
        own = list(lines)
        each = [m / w for _, _, w, m in own if w is not None and m is not None]
        if not each:
            blind.append(effect)
            continue
        every += each
        ratios.append(float(np.exp(np.mean(np.log(each)))))
        words = '; '.join(
            f'{what} {_size(still)}, {_size(moving)}' for _, what, still, moving in own
        )
        what = f'{SERIES}: smallest detectable {effect}, all of them over windows alone'
        rows.append(MeasuredValue(what, ratios[-1], note=f'by windows, by all: {words}'))
    told = f'neither shows {", ".join(blind)}; ' if blind else ''
    return [
        MeasuredValue(
            f'{SERIES}: smallest detectable effect, all of them over windows alone, median',
            float(np.median(ratios)), '', at_most(MOST_RATIO),
            f'of {len(ratios)} effects, one of several values by the geometric mean of theirs; '
            f'least and most; {found.number_of_windows} windows, '
            f'{found.counted_s / 60.0:.0f} min that count; {told}of board_added_mass, which no '
            f'window shows, {_size(found.added_mass)}; {found.cpu_s:.0f} s of processor time',
            low=min(ratios), high=max(ratios),
        ),
        MeasuredValue(
            f'{SERIES}: the same, median of all values one by one',
            float(np.median(every)), '',
            note=f'of {len(every)} values; effects of one side and of boards have several; least '
            'and most',
            low=min(every), high=max(every),
        ),
        *rows,
    ]  # fmt: skip


def _lines(found: DetectableSizes) -> list[tuple[str, str, float | None, float | None]]:
    words = [
        f'{value} ({unit})' if unit else value
        for value, unit in zip(found.values, found.units, strict=True)
    ]
    return list(zip(found.effects, words, found.windows, found.motion, strict=True))


def _size(size: float | None) -> str:
    return 'none' if size is None else in_digits(size)
