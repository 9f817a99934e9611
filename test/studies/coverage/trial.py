"""Trial: a random board, towed, fitted, and predicted on a tow that was left out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from studies.kept import TrialTask
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.objective import paper_values, stack
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.lab.trials.linearised_plant import (
    LinearisedState,
    MeshResolution,
    State,
    TowedBoard,
    towed_board,
)
from trawl_ros.lab.trials.readings import (
    SAME_IN_ALL_STATES,
    SENSED_CHANNELS,
    Sensors,
    steady_windows,
    wrong_by,
)
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor
from trawl_ros.solver.trimming.drawn_board import fastened_as

ROWS = [OBSERVABLES.index(name) for name in SENSED_CHANNELS]


def information(tows: Sequence[Sequence[LinearisedState]], sensors: Sensors) -> FloatArray:
    """Fisher information (12, 12) of the coefficients in the windows of some tows.

    The covariance is the true one: noise of the windows' means, what changes with the state,
    offsets and errors of scale that go through a tow, and all of these of the warp lengths and
    speed, through the sensitivities.

    Parameters
    ----------
    tows
        Observables of the plant at the truth.
    sensors
        True errors of the instruments.
    """
    total = np.zeros((12, 12))
    for looks in tows:
        gain = np.vstack([look.by_coefficients[ROWS] for look in looks])
        whitened = np.linalg.solve(np.linalg.cholesky(_covariance(looks, sensors)), gain)
        total += whitened.T @ whitened
    return total


def _covariance(looks: Sequence[LinearisedState], sensors: Sensors) -> FloatArray:
    """Covariance of measured less predicted at the measured inputs, over all windows of a tow."""
    blocks = []
    for look in looks:
        own, inputs = (
            np.diag(
                [
                    sensors.mean_std(name) ** 2 + sensors.state_std(name, _size(look, name)) ** 2
                    for name in names
                ]
            )
            for names in (SENSED_CHANNELS, INPUTS)
        )
        sensitivity = look.by_inputs[ROWS]
        blocks.append(own + sensitivity @ inputs @ sensitivity.T)
    columns = []
    for name in (*SENSED_CHANNELS, *INPUTS):
        channel, factor = CHANNELS[name], sensors.factor(name)
        offset = np.concatenate([_effect(look, name) for look in looks])
        scale = np.concatenate([_effect(look, name) * _size(look, name) for look in looks])
        columns += [factor * channel.bias * offset, factor * channel.bias_fraction * scale]
    shared = np.column_stack(columns)
    covariance: FloatArray = np.asarray(block_diag(*blocks)) + shared @ shared.T
    return covariance


def _effect(look: LinearisedState, name: str) -> FloatArray:
    """Sensitivity (k,) of the residuals to an offset of a channel or input."""
    if name in INPUTS:
        return -look.by_inputs[ROWS, INPUTS.index(name)]
    return np.array([float(name == other) for other in SENSED_CHANNELS])


def _size(look: LinearisedState, name: str) -> float:
    return float(look.inputs[INPUTS.index(name)]) if name in INPUTS else look[name]


TOWS: tuple[tuple[State, ...], ...] = (
    ((300.0, 2.4), (400.0, 2.2), (550.0, 2.0), (700.0, 2.4), (900.0, 2.2)),
    ((300.0, 2.2), (400.0, 2.0), (550.0, 2.4), (700.0, 2.2), (900.0, 2.0)),
    ((300.0, 2.0), (400.0, 2.4), (550.0, 2.2), (700.0, 2.0), (900.0, 2.4)),
    ((300.0, 2.4), (400.0, 2.2), (550.0, 2.0), (700.0, 2.4), (900.0, 2.2)),
)
"""Steady states of a trial, tow by tow."""

HELD_OUT: tuple[State, ...] = ((350.0, 2.3), (480.0, 2.1), (620.0, 2.3), (800.0, 2.1))
"""The tow that is predicted and not fitted."""


WRONG_BY = 0.3
"""Noise and biases are larger or smaller than stated by this part."""


@dataclass(frozen=True)
class EstimationTask(TrialTask):
    """Task of one trial.

    Attributes
    ----------
    mesh
        Meshes of model and plant.
    tows
        Number of `TOWS` that are fitted.
    stated
        True if noise is as stated and the estimator knows that model and plant are the same, as
        a bound on the spread presumes.
    """

    mesh: MeshResolution
    tows: int
    stated: bool


@dataclass(frozen=True)
class EstimationTrial:
    """Result of a trial.

    Attributes
    ----------
    truth, values, std, low, high : 12 numbers each
        Coefficients that made the data; the estimate, its standard deviations and intervals.
    converged
        True if the fit came to rest.
    windows
        Numbers of windows fitted and found.
    rejected
        Boards drawn before that cannot be towed, by reason.
    information : 12 × 12 numbers
        Fisher information of the data at the truth.
    measured, predicted, perfect : n × 4 numbers
        The channels of eq. 35 on the tow that was left out: measured, predicted by the fit, and
        by the plant itself at the measured warp lengths and speed. NaN stands as None.
    noise_scales
        Noise found over noise stated, by group.
    """

    series: str
    number: int
    truth: list[float]
    values: list[float]
    std: list[float]
    low: list[float]
    high: list[float]
    converged: bool
    windows: int
    rejected: dict[str, int]
    information: list[list[float]]
    measured: list[list[float]]
    predicted: list[list[float | None]]
    perfect: list[list[float]]
    noise_scales: dict[str, float]


def run_trial(task: EstimationTask) -> EstimationTrial:
    """Run a trial.

    Raises
    ------
    TrawlError
        If no board drawn can be towed, or no window can be fitted.
    """
    rng = task.rng()
    board = towed_board(task.mesh.plant(task.gear), (*TOWS[: task.tows], HELD_OUT), rng)
    gear = fastened_as(task.mesh.model(task.gear), board.drawn.gear)
    prior = board_prior(gear)
    tows, held_out = board.tows[:-1], board.tows[-1]
    sensors = SAME_IN_ALL_STATES if task.stated else wrong_by(WRONG_BY, rng)
    exact = EstimatorOptions(model_error=0.0, state_share=0.0, unsettled=0.0)
    options = exact if task.stated else None
    estimator = Estimator(Predictor(build_model(gear)), prior, OBSERVABLES, options)
    for window in steady_windows(tows, sensors, rng):
        estimator.add(window)
    estimate = estimator.finish()
    if estimate is None:
        raise TrawlError('the model has no steady state at any of the windows')
    unseen = steady_windows([held_out], sensors, rng, first_tow=len(tows))
    predicted = estimator.predictions(estimate.values, unseen)
    return EstimationTrial(
        series=task.series,
        number=task.number,
        truth=board.drawn.coefficients.tolist(),
        values=estimate.values.tolist(),
        std=estimate.std.tolist(),
        low=estimate.low.tolist(),
        high=estimate.high.tolist(),
        converged=estimate.converged,
        windows=estimate.windows,
        rejected=dict(board.drawn.rejected),
        information=information(tows, sensors).tolist(),
        measured=stack([paper_values(window.means) for window in unseen]).tolist(),
        predicted=[[None if np.isnan(value) else value for value in row] for row in predicted],
        perfect=_perfect(board, [window.means for window in unseen]).tolist(),
        noise_scales=dict(estimate.noise_scales),
    )


def _perfect(board: TowedBoard, means: list[Mapping[str, float]]) -> FloatArray:
    """Predictions (n, 4) of the plant itself at the inputs as measured."""
    rows = []
    for look, seen in zip(board.tows[-1], means, strict=True):
        wrong = np.array([seen[name] for name in INPUTS]) - look.inputs
        values = look.values + look.by_inputs @ wrong
        rows.append(paper_values(dict(zip(OBSERVABLES, values, strict=True))))
    return stack(rows)
