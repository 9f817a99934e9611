# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Calibration of estimates from a whole tow in motion, with the model as its own plant."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.special import chdtri

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState, TrawlError
from trawl_ros.estimation.fit.error_terms import group_of
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.fit import fit_motion
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.nuisances import columns, layout_of, linear_part, point_of
from trawl_ros.estimation.motion.processes import EXACT_MODEL, group_rows
from trawl_ros.estimation.motion.towing.inputs import TowInputs
from trawl_ros.estimation.motion.towing.knots import knots_of_log
from trawl_ros.estimation.motion.towing.lineariser import linearise_tow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.benchmark.motion_instruments import (
    MOST_DRAWS,
    PLACES,
    PRIOR_STD_FACTOR,
    narrowed,
    run_instrument_trial,
    wrong_predictions,
)
from trawl_ros.lab.report.measured import MeasuredValue, between
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.timing import timed
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import MEASURED
from trawl_ros.solver.trimming.drawn_board import BoardDraw, draw_board

MESHES_AROUND = 24
"""Meshes around the mouth of the net."""

SEEDS = (1, 2, 3, 4, 5, 6)

READ_SEEDS = (201, 202, 203, 204)
"""Seeds of tows read by instruments; the estimator was developed with others."""

NORMAL_95 = 1.96

MOVES = (
    (20.0, 110.0, -40.0, 0.0),
    (130.0, 160.0, 0.0, -0.2),
    (220.0, 250.0, 0.0, 0.3),
    (270.0, 400.0, 40.0, 0.0),
)
"""Changes: from and to (s), of both warps (m), and of the speed (m/s).

Warp is paid out at towing speed. At a lower speed boards lose their lift and bars go slack.
"""

START = np.array([520.0, 520.0, 2.3])

NOISE = {
    'tension': 500.0,
    'door_depth': 0.1,
    'door_spread': 0.4,
    'net_depth': 0.1,
    'pitch': 0.003,
    'roll': 0.003,
    'vertical_opening': 0.3,
}
"""Standard deviations (SI) of the means of a stretch of 20 s, about those of the instruments."""

CHANNELS = tuple(name for name in MEASURED if group_of(name) in NOISE)
"""Channels of the tows."""

STEP_S, STRETCH_S, DURATION_S = 2.0, 20.0, 420.0

LOG_STD, MEMORY_S = 0.03, 160.0
"""Std (m/s) of a reading of the log, one a second; time (s) after which an error is forgotten."""

BAND = tuple(float(chdtri(12, tail)) for tail in (0.975, 0.025))
"""Band that holds 95 % of the squared normalised errors of twelve coefficients."""


@dataclass(frozen=True)
class MotionTrial:
    """Case: the true coefficients (12,), and the fit."""

    truth: FloatArray
    prior: ParameterVector
    fit: MotionFit

    @property
    def squared_error(self) -> float:
        """Squared error of the coefficients in the metric of the posterior; expectation 12."""
        away = self.fit.values - self.truth
        return float(away @ np.linalg.solve(self.fit.covariance, away))

    @property
    def held(self) -> float:
        """Share of the coefficients inside their 95 % intervals."""
        std = np.sqrt(np.diag(self.fit.covariance))
        return float(np.mean(np.abs(self.fit.values - self.truth) <= NORMAL_95 * std))

    @property
    def shrunk(self) -> FloatArray:
        """Posterior std over prior std (12,)."""
        return np.sqrt(np.diag(self.fit.covariance)) / self.prior.std


def course_tow(duration_s: float = DURATION_S) -> MovingTow:
    """Tow of the course without readings; its stretches are averaged like all others."""
    grid = np.arange(0.0, duration_s + 0.5)
    values, rates = np.tile(START, (len(grid), 1)), np.zeros((len(grid), 3))
    for begin, end, warp, speed in MOVES:
        part = np.clip((grid - begin) / (end - begin), 0.0, 1.0)[:, None]
        change = np.array([warp, warp, speed])
        values += change * part**2 * (3.0 - 2.0 * part)
        rates += change * 6.0 * part * (1.0 - part) / (end - begin)
    n, k, steps = int(duration_s / STRETCH_S), len(CHANNELS), round(STRETCH_S / STEP_S)
    weights = np.full((n, k, steps + 1), 1.0 / steps)
    weights[..., [0, -1]] *= 0.5
    noise = np.tile([NOISE[group_of(name)] for name in CHANNELS], (n, 1))
    still = np.zeros(len(grid))
    return MovingTow(
        'course', 0, STEP_S, STRETCH_S, CHANNELS, np.zeros((n, k)), noise,
        np.ones((n, k), dtype=int), weights, TowInputs(1.0, values, rates, still, still),
    )  # fmt: skip


def run_motion_trial(
    gear: TowedGear,
    seed: int,
    errors: bool = False,
    duration_s: float = DURATION_S,
    std_factor: float = PRIOR_STD_FACTOR,
) -> MotionTrial:
    """Draw a board from the prior, rig and tow it, add noise, and fit from the prior's mean.

    Parameters
    ----------
    gear
        The gear that is towed.
    seed
        Of the trial.
    errors
        True if all is drawn that the fit counts with: added mass, errors of counters and of the
        log, calibration, drifts of sensors and errors of the model; else white noise alone.
    duration_s
        Length of the tow.
    std_factor
        Part of the gear file's std of the boards' prior.

    Raises
    ------
    TrawlError
        If none of `MOST_DRAWS` boards tows the course.
    """
    record = gear.model.gear
    prior = narrowed(board_prior(record), std_factor)
    rng, tow = np.random.default_rng(seed), course_tow(duration_s)
    if errors:
        readings = np.arange(0.0, duration_s)
        knots = knots_of_log(readings, LOG_STD, duration_s, STRETCH_S, MEMORY_S)
        tow = replace(tow, inputs=replace(tow.inputs, knots=(knots,)))
        options = MotionOptions(estimate_sizes=False)
    else:
        options = MotionOptions(
            sizes=EXACT_MODEL, estimate_sizes=False, nuisances=False, tolerance=0.02
        )
    layout = layout_of(tow, gear, options.model)
    for _ in range(MOST_DRAWS):
        drawn = draw_board(record, PLACES, rng, BoardDraw(std_factor=std_factor))
        rigged = replace(gear, model=gear.model.with_board(points=drawn.model.board.points))
        z = rng.standard_normal(len(layout))
        z[len(prior)] = abs(z[len(prior)])
        if not errors:
            z[len(prior) :] = 0.0
        z[: len(prior)] = (drawn.coefficients - prior.start) / prior.std
        point = point_of(tow, layout, z, prior.start, prior.std)
        try:
            towed = linearise_tow(rigged, tow, point, np.ones(len(tow), dtype=bool))
        except NoSteadyState:
            continue
        means = towed.values + columns(towed, layout, prior.std) @ (z * linear_part(layout))
        for number, rows in enumerate(group_rows(replace(tow, means=means), means, tow.noise)):
            covariance = rows.covariance(options.sizes.of_group(number), options.times)
            noise = np.linalg.cholesky(covariance) @ rng.standard_normal(len(covariance))
            means[rows.stretches, rows.channels] += noise
        fit = fit_motion(rigged, [replace(tow, means=means)], prior, options)
        return MotionTrial(point.coefficients, prior, fit)
    raise TrawlError(
        f'none of {MOST_DRAWS} boards drawn from identification of {record.name} tows the course; '
        'expected one: ask for another seed'
    )


def measure(quick: bool) -> Findings:
    """Run the trials."""
    record = default_gear(quick=quick)
    if not quick:
        record = record.changed('netting', around=MESHES_AROUND)
    gear, factor = TowedGear(build_model(record)), PRIOR_STD_FACTOR * (0.2 if quick else 1.0)
    rows: list[MeasuredValue] = []
    seeds, duration = (SEEDS[:1], 80.0) if quick else (SEEDS, DURATION_S)
    for words, errors in (('white noise', False), ('all errors as stated', True)):
        if not (quick and errors):
            runs = [
                partial(run_motion_trial, gear, seed, errors, duration, factor) for seed in seeds
            ]
            rows += _rows(words, runs)
    if not quick:
        for along, groups in wrong_predictions(record, READ_SEEDS[1]).items():
            rows += [
                MeasuredValue(
                    f'prediction at the truth along {along}: {group}', away, '',
                    note="std through the tow of what a stretch's mean is off by, over its noise",
                )
                for group, away in groups.items()
            ]  # fmt: skip
        rows += _rows('read by instruments', [partial(_read_trial, record, s) for s in READ_SEEDS])
    return Findings(
        tuple(rows),
        text=f'{DURATION_S:.0f} s of hauling, two speed steps and veering, in stretches of '
        f'{STRETCH_S:.0f} s; the model, with {MESHES_AROUND} meshes around its net, is its own '
        f'plant and is towed in the same steps of {STEP_S:g} s. Boards are drawn from the '
        f"gear file's prior with {PRIOR_STD_FACTOR:g} of its std, and rigged for the course's "
        'states; the fit begins at the mean of that prior and knows the fastening points. With '
        '*white noise* inputs and sensors are else exact; with *all errors as stated* added mass, '
        'counters, log, calibration, drifts and errors of the model are drawn from what the fit '
        'takes them for. '
        '*Read by instruments*, the same course is commanded to ship and winches, simulated in '
        'steps of 0.5 s and read by the default instruments, counters and spread sensor of which '
        'are wrong by another amount after each command; the fit knows none of it.',
    )


def _read_trial(record: GearRecord, seed: int) -> MotionTrial:
    coefficients, fit = run_instrument_trial(record, seed)
    return MotionTrial(coefficients, narrowed(board_prior(record)), fit)


def _rows(words: str, runs: Sequence[Callable[[], MotionTrial]]) -> list[MeasuredValue]:
    trials, seconds = zip(*map(timed, runs), strict=True)
    squares = np.array([trial.squared_error for trial in trials])
    inside = np.mean((squares >= BAND[0]) & (squares <= BAND[1]))
    shrunk = np.exp(np.mean([np.log(trial.shrunk).mean() for trial in trials]))
    converged = sum(trial.fit.converged for trial in trials)
    # The mean over n trials of the sum of twelve squared normal errors has a band of its own.
    freedom = 12 * len(trials)
    low, high = (float(chdtri(freedom, tail)) / len(trials) for tail in (0.975, 0.025))
    each = ', '.join(f'{square:.1f}' for square in squares)
    return [
        MeasuredValue(
            f'{words}: squared normalised error of twelve coefficients, mean of the trials',
            float(squares.mean()),
            '',
            between(low, high),
            f'{each}; {converged} of {len(trials)} converged',
        ),
        MeasuredValue(
            f'{words}: trials with it within {BAND[0]:.1f} to {BAND[1]:.1f}',
            100.0 * float(inside),
            '%',
            note='95 % of them belong there',
        ),
        MeasuredValue(
            f'{words}: 95 % intervals that hold the truth',
            100.0 * float(np.mean([trial.held for trial in trials])),
            '%',
        ),
        MeasuredValue(f'{words}: posterior over prior std, geometric mean', float(shrunk), ''),
        MeasuredValue(f'{words}: processor time of a trial', float(np.mean(seconds)), 's'),
    ]
