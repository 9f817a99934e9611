"""Smallest detectable sizes of effects, by steady windows alone and by all of the tows.

A size is detectable as in a diagnosis: in 80 % of trials it exceeds what chance makes of a gear in
order in one of a hundred (`trawl_ros.diagnosis.evidence`). The limit is that of the windows.
"""

import math
import time
from collections.abc import Iterable
from dataclasses import dataclass

from studies.motion.detectable_information import ExaminedGear, information_in_motion
from studies.motion.detectable_tows import STATES, tow_and_read
from studies.motion.trial import MotionTask
from trawl_ros.core.errors import TrawlError
from trawl_ros.diagnosis.evidence import detectable
from trawl_ros.diagnosis.refit import fit_boards
from trawl_ros.diagnosis.rules import DOUBT
from trawl_ros.diagnosis.score_test import score_test
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior, predictor_for
from trawl_ros.estimation.motion.nuisances import ADDED_MASS_STD


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
    test = score_test(predictor, base.fit, catalogue())
    # Of an effect that is looked for in several places the first, as in the table of a diagnosis.
    wanted = tuple(candidate for candidate in test.wanted if not candidate.place)
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
        windows=_numbers(size for candidate in wanted for size in test.detectable(candidate)),
        motion=_numbers(
            gear.units * detectable(moving.evidence, range(number), test.limit, DOUBT)
        ),
        added_mass=_numbers(
            ADDED_MASS_STD * detectable(moving.added_mass, range(1), test.limit, DOUBT)
        )[0],
        number_of_windows=len(read.windows),
        counted_s=moving.counted_s,
        cpu_s=time.process_time() - begun,
    )  # fmt: skip


def _numbers(sizes: Iterable[float]) -> list[float | None]:
    return [float(size) if math.isfinite(size) else None for size in sizes]
