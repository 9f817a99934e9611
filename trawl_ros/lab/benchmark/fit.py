# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Cost of one fit of the coefficients, as the number of steady states that it solves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.nuisance import eliminate_nuisance
from trawl_ros.estimation.fit.objective import objective, paper_values, stack
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.benchmark.fit_rivals import (
    CoordinateSearch,
    Counting,
    FiniteDifferencePredictor,
    Searched,
)
from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.timing import Part, shares, timed
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import sensitivities
from trawl_ros.solver.slow_mode import slow_mode

LENGTHS = (200.0, 375.0, 550.0, 725.0, 900.0)
SPEEDS = (1.8, 2.0, 2.2)

MORE_DRAG = 1.05
READINGS = 60
SEED = 1


def plant_of(gear: GearRecord) -> GearModel:
    """Gear that differs from its model: its net has more drag."""
    drag = gear.netting.normal_drag * MORE_DRAG
    return build_model(gear.changed('netting', normal_drag=drag))


def trial(
    plant: GearModel, lengths: Sequence[float], speeds: Sequence[float]
) -> list[SteadyWindow]:
    """One window per steady state, with errors of the size of the instruments' errors."""
    rng = np.random.default_rng(SEED)
    windows: list[SteadyWindow] = []
    found: Equilibrium | None = None
    for length in lengths:
        for speed in speeds:
            found = find_equilibrium(plant, OperatingPoint(length, length, speed), found)
            seen = dict(zip(OBSERVABLES, found.observables.array(), strict=True))
            seen |= {'port_length': length, 'starboard_length': length, 'speed': speed}
            exact = {name: float(seen[name]) for name in (*INPUTS, *MEASURED)}
            std = {name: CHANNELS[name].bias_std(value) for name, value in exact.items()}
            means = {name: exact[name] + std[name] * float(rng.normal()) for name in exact}
            index = len(windows)
            windows.append(
                SteadyWindow(
                    index=index,
                    state=index,
                    start_ns=index * READINGS * SECOND,
                    end_ns=(index + 1) * READINGS * SECOND,
                    means=means,
                    noise=dict.fromkeys(exact, 0.0),
                    bias=std,
                    counts=dict.fromkeys(exact, READINGS),
                )
            )
    return windows


MESHES_AROUND = 24
"""Meshes around the net of the model: fewer than the default, to keep the rivals' runs short."""

OVER_SEARCH, OVER_DIFFERENCES, FIT_S = 50.0, 10.0, 1.0

SEARCH_BUDGET_FACTOR = 1.04
"""Budget of the coordinate search as a multiple of the steady states it is expected to need."""

OPTIONS = EstimatorOptions(iterations_per_window=1, relinearise=2.0)
"""Options for windows that are all known beforehand: no estimate is needed on the way."""

QUICK = EstimatorOptions(iterations_per_window=1, iterations_final=2, relinearise=2.0)


PARTS: dict[str, Part] = {
    'steady states': find_equilibrium,
    'their derivatives': sensitivities,
    'their slowest motions': slow_mode,
    'errors of instruments and tows': eliminate_nuisance,
}
"""Main functions of a fit."""


@dataclass(frozen=True)
class Fitted:
    """Result of a fit: objective of eq. 35, number of steady states, CPU time (s), and its end."""

    objective: float
    solves: int
    seconds: float
    reason: str


def measure(quick: bool) -> Findings:
    """Fit by sensitivities, by differences, and by coordinate search."""
    gear = (
        default_gear(quick=True)
        if quick
        else default_gear(quick=False).changed('netting', around=MESHES_AROUND)
    )
    model, prior = build_model(gear), board_prior(gear)
    lengths, speeds = (LENGTHS[2:3], SPEEDS[1:2]) if quick else (LENGTHS, SPEEDS)
    windows = trial(plant_of(gear), lengths, speeds)
    options = QUICK if quick else OPTIONS
    ours = _fitted(Counting(model), windows, prior, options)
    of_ours = shares(lambda: _fitted(Counting(model), windows, prior, options), PARTS)
    theirs = _fitted(FiniteDifferencePredictor(model, prior.std), windows, prior, options)
    search = CoordinateSearch(model, windows, prior)
    budget = round((0.02 if quick else 1.0) * SEARCH_BUDGET_FACTOR * OVER_SEARCH * ours.solves)
    searched, seconds = timed(lambda: search.search(ours.objective, budget))
    found = (
        f'reached eq. 35 at {searched.objective:.4f} after {searched.solves} steady states'
        if searched.reached
        else f'had come to {searched.objective:.4f} and not to {ours.objective:.4f} after '
        f'{searched.solves} steady states, its budget: the ratio is no more than a lower bound'
    )
    rows = (
        MeasuredValue(
            f'steady states solved for one fit to {len(windows)} states',
            ours.solves,
            note=f'{ours.reason}; eq. 35 at {ours.objective:.4f}',
        ),
        MeasuredValue(
            'that fit',
            ours.seconds,
            's',
            at_most(FIT_S),
            f'{1e3 * ours.seconds / ours.solves:.0f} ms for each of these steady states, with its '
            f'derivatives; of it {of_ours}',
        ),
        MeasuredValue(
            "coordinate search's steady states over ours",
            searched.solves / ours.solves,
            '×',
            at_least(OVER_SEARCH),
            f'the search {found}',
        ),
        MeasuredValue(
            "coordinate search's time over ours",
            seconds / ours.seconds,
            '×',
            at_least(1.0),
            f'{seconds:.0f} s and {ours.seconds:.1f} s',
        ),
        MeasuredValue(
            "finite-difference Gauss–Newton's steady states over ours",
            theirs.solves / ours.solves,
            '×',
            at_least(OVER_DIFFERENCES),
            theirs.reason,
        ),
        MeasuredValue(
            "finite-difference Gauss–Newton's time over ours",
            theirs.seconds / ours.seconds,
            '×',
            at_least(1.0),
            f'{theirs.seconds:.0f} s and {ours.seconds:.1f} s',
        ),
        _no_worse('coordinate search', ours, searched),
        _no_worse('finite-difference Gauss–Newton', ours, theirs),
    )
    return Findings(
        rows,
        text=f'The model has {gear.netting.around} meshes around its net; the {len(windows)} '
        f'states come from a plant with {MORE_DRAG:g} times the drag across its twine and the '
        'coefficients of eq. 37, and carry errors as large as those of the instruments. All '
        "three start at the gear file's start values, and solve each steady state from a known "
        "one nearby. Gauss–Newton with differences is this package's estimator with derivatives "
        'by forward differences. The coordinate search goes round the coefficients as the '
        'founding paper describes it, on eq. 35 alone; it ends as soon as it is no worse than '
        f'the estimator, or when it has solved {SEARCH_BUDGET_FACTOR * OVER_SEARCH:.0f} times as '
        'many steady states. Each ran once.',
    )


def _fitted(
    predictor: Counting,
    windows: Sequence[SteadyWindow],
    prior: ParameterVector,
    options: EstimatorOptions,
) -> Fitted:
    estimator = Estimator(predictor, prior, OBSERVABLES, options)

    def fit() -> None:
        for window in windows:
            estimator.add(window)
        estimator.finish()

    _, seconds = timed(fit)
    solves, estimate = predictor.solves, estimator.estimate
    assert estimate is not None
    measured = stack([paper_values(window.means) for window in estimator.windows])
    value = objective(estimator.predictions(estimate.values), measured)
    return Fitted(value, solves, seconds, estimate.reason)


def _no_worse(name: str, ours: Fitted, theirs: Fitted | Searched) -> MeasuredValue:
    """Row on the objective (eq. 35) to four digits, since differences are never exact."""
    note = f'{ours.objective:.4f} and {theirs.objective:.4f}'
    if ours.objective > theirs.objective:
        note += '; a search that is stopped when it is no worse ends a little lower'
    ratio = round(ours.objective / theirs.objective, 4)
    return MeasuredValue(f'our objective over that of {name}', ratio, '×', note=note)
