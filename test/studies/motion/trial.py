"""Trial: a random board towed in time, fitted by the steady parts and by all of its tow."""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studies.kept import TrialTask
from studies.motion.plant import (
    AUTOTRAWLED_COURSE,
    COURSE,
    MOST_DRAWS,
    PlantTow,
    draw_tow,
)
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.bag_motion import STRETCHES, fit_tows
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.objective import paper_values, stack
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.motion.outcome import MotionOutcome
from trawl_ros.estimation.motion.series import tow_readings
from trawl_ros.estimation.motion.stretches import moving_tow
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.linearised_plant import MeshResolution
from trawl_ros.lab.trials.readings import AS_STATED, steady_windows
from trawl_ros.model.water import build_water
from trawl_ros.scenario.scenario import load_scenario
from trawl_ros.solver.trimming.drawn_board import fastened_as

AUTOTRAWLED = 'autotrawled'
"""Series whose winches an autotrawl works."""

KINDS = ('noise', 'drift', 'model', 'state')
"""Kinds of errors whose sizes a fit in motion finds for each quantity."""


@dataclass(frozen=True)
class MotionTask(TrialTask):
    """Task of one trial, with the meshes of model and plant."""

    mesh: MeshResolution


@dataclass(frozen=True)
class MotionTrial:
    """Result of a trial; of pairs, the first is of the steady parts, the second of all of the tow.

    Attributes
    ----------
    truth : 12 numbers
        Coefficients that made the data.
    values, std, low, high : 2 × 12 numbers
        Estimates, their standard deviations and intervals.
    squared : 2 numbers
        Squared errors of the twelve in the metric of the posterior, 12 in the mean.
    refused
        Sentences on why a fit was refused; in its place stands that of the steady windows.
    reason, iterations
        Of the fit in motion.
    windows
        Number of steady windows.
    duration_s, left_out_s
        Length of the tow, and time of it that does not count.
    rejected
        Boards drawn before that cannot be towed, by reason.
    measured : n × 4 numbers
        The channels of eq. 35 in the states that were not towed.
    predicted : 3 × n × 4 numbers
        By the model with both estimates, and with the true coefficients; None where it has none.
    sizes
        Sizes of the errors that were found, by kind.
    cpu_s
        Processor time of the fit in motion.
    """

    series: str
    number: int
    truth: list[float]
    values: list[list[float]]
    std: list[list[float]]
    low: list[list[float]]
    high: list[list[float]]
    squared: list[float]
    refused: str
    reason: str
    iterations: int
    windows: int
    duration_s: float
    left_out_s: float
    rejected: dict[str, int]
    measured: list[list[float]]
    predicted: list[list[list[float | None]]]
    sizes: dict[str, list[float]]
    cpu_s: float


@dataclass(frozen=True)
class WindowedTow:
    """Tow with steady windows, what was learned of them, and boards drawn before, by reason."""

    plant: PlantTow
    identification: Identification
    estimate: Estimate
    rejected: Counter[str]


def draw_windowed(
    draw: Callable[[], PlantTow], identify: Callable[[PlantTow], Identification], name: str
) -> WindowedTow:
    """Draw tows until one has a steady window: boards that flutter all the way are towed by nobody,
    and there is nothing to compare with.

    Parameters
    ----------
    draw
        Draws a tow.
    identify
        Makes an identification of a tow, which has read nothing of it.
    name
        Of the trial, for errors.

    Raises
    ------
    TrawlError
        If none of `MOST_DRAWS` has one.
    """
    rejected: Counter[str] = Counter()
    for _ in range(MOST_DRAWS):
        plant = draw()
        identification = identify(plant)
        rejected += plant.rejected
        for sample in plant.samples:
            identification.feed(sample)
        identification.finish()
        if identification.estimate is not None:
            return WindowedTow(plant, identification, identification.estimate, rejected)
        rejected['without a steady window'] += 1
    raise TrawlError(f'{name}: {identification.why_not()}')


def run_motion_trial(task: MotionTask) -> MotionTrial:
    """Run a trial.

    Raises
    ------
    TrawlError
        If no board drawn can be towed, or nothing can be fitted.
    """
    rng = task.rng()
    course = load_scenario(AUTOTRAWLED_COURSE if task.series == AUTOTRAWLED else COURSE)
    windowed = draw_windowed(
        lambda: draw_tow(task.mesh.plant(task.gear), course, rng),
        lambda plant: identification_for(_aboard(task, plant)),
        task.name,
    )
    plant, identification, estimate = windowed.plant, windowed.identification, windowed.estimate
    gear = _aboard(task, plant)
    read = tow_readings(plant.samples, build_water(gear).depth, task.name)
    tow = moving_tow(read, task.name, STRETCHES)
    begun = time.process_time()
    learned, refused = None, []
    try:
        learned = fit_tows(gear, identification, [tow], [0], ())
    except TrawlError as reason:
        refused.append(str(reason))
    cpu_s = time.process_time() - begun
    steady = estimate
    try:
        steady = fit_tows(gear, identification, [tow], [0], (), steady=True).estimate
    except TrawlError as reason:
        refused.append(str(reason))
    unseen = steady_windows([plant.held_out], AS_STATED, rng, first_tow=1)
    whole = estimate if learned is None else learned.estimate
    both = (steady.values, whole.values)
    covariances = steady.covariance, whole.covariance
    predictions = [
        identification.estimator.predictions(values, unseen)
        for values in (*both, plant.coefficients)
    ]
    fit = None if learned is None else learned.fit
    return MotionTrial(
        series=task.series,
        number=task.number,
        truth=plant.coefficients.tolist(),
        values=[values.tolist() for values in both],
        std=[steady.std.tolist(), whole.std.tolist()],
        low=[steady.low.tolist(), whole.low.tolist()],
        high=[steady.high.tolist(), whole.high.tolist()],
        squared=[
            _squared(values - plant.coefficients, covariance)
            for values, covariance in zip(both, covariances, strict=True)
        ],
        refused='; '.join(refused),
        reason='' if fit is None else fit.reason,
        iterations=0 if fit is None else fit.iterations,
        windows=estimate.windows,
        duration_s=len(tow) * tow.stretch_s,
        left_out_s=0.0 if learned is None else _left_out(learned),
        rejected=dict(windowed.rejected),
        measured=stack([paper_values(window.means) for window in unseen]).tolist(),
        predicted=[
            [[None if np.isnan(value) else value for value in row] for row in rows.tolist()]
            for rows in predictions
        ],
        sizes={} if fit is None else {
            **{kind: list(getattr(fit.sizes, kind)) for kind in KINDS}, 'log': [fit.sizes.log]
        },
        cpu_s=cpu_s,
    )  # fmt: skip


def _aboard(task: MotionTask, plant: PlantTow) -> GearRecord:
    """The gear as it is known aboard: boards fastened as they are, and not their coefficients."""
    return fastened_as(task.mesh.model(task.gear), plant.gear)


def _left_out(learned: MotionOutcome) -> float:
    return float(sum(part.end - part.begin for _, part in learned.left_out))


def _squared(away: FloatArray, covariance: FloatArray) -> float:
    return float(away @ np.linalg.solve(covariance, away))
