# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tows of the model itself, read by the default instruments, and fitted as a whole."""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.core.errors import NoSteadyState, TrawlError
from trawl_ros.estimation.fit.error_terms import group_of
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.fit import fit_motion
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.nuisances import ADDED_MASS_STD
from trawl_ros.estimation.motion.series import TowReadings, tow_readings
from trawl_ros.estimation.motion.stretches import (
    REACH_S,
    StretchOptions,
    moving_tow,
    warp_path,
)
from trawl_ros.estimation.motion.towing.inputs import (
    CorrectedInputs,
    TowInputs,
    on_grid,
    stacked,
    without_errors,
)
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.gear.records import GearRecord
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.instruments.suite import InstrumentSuite
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.observables import observe
from trawl_ros.model.water import build_water
from trawl_ros.records.channels import INPUTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import Sample
from trawl_ros.scenario.sea import build_surroundings
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation, tow_of
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.stepper import StepFailed
from trawl_ros.solver.trimming.drawn_board import BoardDraw, draw_board, fastened_as

COURSE = (
    (0.0, 520.0, 2.3),
    (20.0, 480.0, 2.3),
    (130.0, 480.0, 2.1),
    (220.0, 480.0, 2.4),
    (270.0, 520.0, 2.4),
)
"""Commands: start time (s), length of both warps (m), speed (m/s)."""

PLACES = tuple((warp, speed) for _, warp, speed in COURSE)
"""Warp length (m) and speed (m/s) of the steady states that must be usable with drawn boards."""

PRIOR_STD_FACTOR = 0.3
"""Factor that narrows the std of the boards' prior.

Fits start at its mean, at which boards with fastening points for other coefficients must still tow.
"""

DURATION_S = 420.0

PERIOD_S, PERIODS = 0.25, 2
"""Period of the simulation, and how many of them make one truth: two a second."""

MOST_DRAWS = 20
"""Largest number of boards drawn until one can be towed in time."""

AS_READ_S = 5.0
"""Smoothing time of counters that are used as read."""

FROM_REST = StretchOptions(settling_s=0.0)
"""Option: these tows start in an equilibrium."""


@dataclass(frozen=True)
class PlantTow:
    """Tow of the plant.

    Attributes
    ----------
    gear
        With the drawn coefficients and the fastening points for them.
    added_mass
        As a part of the cylinder of water around a board.
    samples
        Of its instruments.
    inputs, rates : (t, 3) arrays
        True warp lengths (m) and speed (m/s) at the truths, and their rates of change.
    observables : (t, n_observables) array
        At the truths.
    """

    gear: GearRecord
    added_mass: float
    samples: tuple[Sample, ...]
    inputs: FloatArray
    rates: FloatArray
    observables: FloatArray


def tow_plant(
    plant: GearRecord, added_mass: float, seed: int, duration_s: float = DURATION_S
) -> PlantTow:
    """Tow a plant along `COURSE` and read it with the default instruments.

    The slowly varying part of each instrument's error changes with every command.

    Raises
    ------
    NoSteadyState, StepFailed
        If the gear cannot be towed that way.
    """
    gear = TowedGear(build_model(plant))
    (_, warp, speed), *changes = COURSE
    simulation = Simulation(
        gear.model,
        Command(warp, warp, speed),
        period=PERIOD_S,
        effect_set=gear.with_added_mass(added_mass),
    )
    suite = InstrumentSuite(
        load_instruments(),
        surroundings=build_surroundings(plant),
        draws=SeedPlan(seed, tuple(begin for begin, *_ in changes)),
    )
    samples: list[Sample] = []
    inputs, payouts, seen = [], [], []
    for number in range(round(duration_s / PERIOD_S) + 1):
        if number:
            before = PERIOD_S * (number - 1)
            _, warp, speed = next(step for step in reversed(COURSE) if step[0] <= before)
            simulation.command = Command(warp, warp, speed)
            simulation.advance()
        if number % PERIODS == 0:
            samples += suite.observe(simulation.truth())
            now = simulation.now
            inputs.append([*(winch.length for winch in now.winches), now.ship.speed])
            payouts.append([winch.speed for winch in now.winches])
            at = tow_of(simulation.model, now.ship, now.winches)
            seen.append(observe(simulation.model, now.motion.state, at).array())
    true = np.array(inputs)
    faster = np.gradient(true[:, 2], PERIODS * PERIOD_S)
    return PlantTow(
        plant, added_mass, tuple(samples), true, np.column_stack((payouts, faster)),
        np.array(seen),
    )  # fmt: skip


def narrowed(prior: ParameterVector, std_factor: float = PRIOR_STD_FACTOR) -> ParameterVector:
    """Prior of the trials."""
    return replace(prior, std=std_factor * prior.std)


def draw_tow(record: GearRecord, seed: int, duration_s: float = DURATION_S) -> PlantTow:
    """Draw boards and their added mass until one can be towed.

    Raises
    ------
    TrawlError
        If none of `MOST_DRAWS` boards tows the course.
    """
    rng = np.random.default_rng(seed)
    for _ in range(MOST_DRAWS):
        drawn = draw_board(record, PLACES, rng, BoardDraw(std_factor=PRIOR_STD_FACTOR))
        added_mass = ADDED_MASS_STD * abs(rng.standard_normal())
        try:
            return tow_plant(drawn.gear, added_mass, seed, duration_s)
        except (NoSteadyState, StepFailed):
            continue
    raise TrawlError(
        f'none of {MOST_DRAWS} boards drawn from identification of {record.name} tows the course; '
        'expected one: ask for another seed'
    )


def read_tow(record: GearRecord, plant: PlantTow, name: str) -> TowReadings:
    """Return the readings of a tow."""
    return tow_readings(plant.samples, build_water(record).depth, name)


def run_instrument_trial(
    record: GearRecord, seed: int, duration_s: float = DURATION_S
) -> tuple[FloatArray, MotionFit]:
    """Draw a board, tow it, read it, and fit it from the prior's mean.

    Returns
    -------
    tuple
        The coefficients (12,) that were towed, and the fit.
    """
    plant, name = draw_tow(record, seed, duration_s), f'seed {seed}'
    tow = moving_tow(read_tow(record, plant, name), name, FROM_REST)
    model = build_model(fastened_as(record, plant.gear))
    fit = fit_motion(TowedGear(model), [tow], narrowed(board_prior(record)), MotionOptions())
    return plant.gear.board.coefficients.array(), fit


def wrong_predictions(record: GearRecord, seed: int) -> dict[str, dict[str, float]]:
    """Deviation of the model from a tow at the true parameters, by kind of inputs.

    Returns
    -------
    dict
        Inputs → group of channels → std of the difference of means through the tow, over their own
        noise. What stays is left out, for calibration errors take it up.
    """
    plant, name = draw_tow(record, seed), f'seed {seed}'
    read = read_tow(record, plant, name)
    tow = moving_tow(read, name, FROM_REST)
    rows = [OBSERVABLES.index(channel) for channel in tow.channels]
    seen = plant.observables[:: round(tow.step_s / (PERIODS * PERIOD_S))][_instants(tow)][..., rows]
    true = np.einsum('nki,nik->nk', tow.weights, seen)
    half, still = PERIODS * PERIOD_S, np.zeros(len(plant.inputs))
    grid: FloatArray = half * np.arange(len(still), dtype=np.float64)
    found = {}
    for words, (values, rates) in _inputs(read, plant, grid).items():
        along = without_errors(TowInputs(half, values, rates, still, still))
        away = (_towed(plant, along, tow, rows) - true) / tow.noise
        away -= np.nanmean(away, axis=0)
        found[words] = {
            group: float(np.sqrt(np.nanmean(away[:, _channels(tow, group)] ** 2)))
            for group in ('tension', 'door_depth', 'net_depth')
        }
    return found


def _towed(plant: PlantTow, along: CorrectedInputs, tow: MovingTow, rows: list[int]) -> FloatArray:
    """Means (n, k) of the plant's boards, towed along inputs in the steps of a tow."""
    none, gear = np.zeros((0, 3)), TowedGear(build_model(plant.gear))
    towed = DifferentiatedTow(
        gear.model,
        MotionParameters(),
        lambda time: replace(along(time), errors=none, error_rates=none),
        gear.with_added_mass(plant.added_mass),
    )
    seen = [towed.observed().values[rows]]
    for _ in range(len(tow) * tow.steps):
        towed.advance(tow.step_s)
        seen.append(towed.observed().values[rows])
    means: FloatArray = np.einsum('nki,nik->nk', tow.weights, np.array(seen)[_instants(tow)])
    return means


def _instants(tow: MovingTow) -> IntArray:
    """Step numbers (n, s + 1) of the instants of each stretch."""
    return np.arange(len(tow))[:, None] * tow.steps + np.arange(tow.steps + 1)


def _inputs(
    read: TowReadings, plant: PlantTow, grid: FloatArray
) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Inputs and their rates (t, 3): the true ones, or some of them replaced by readings."""
    counters = [on_grid(*_readings(read, name), grid, AS_READ_S) for name in INPUTS[:2]]
    paths = [
        warp_path(read.series[name], payout, grid)
        for name, payout in zip(INPUTS[:2], read.payout, strict=True)
    ]
    log = on_grid(*_readings(read, 'speed'), grid, REACH_S)
    exact = [(plant.inputs[:, i], plant.rates[:, i]) for i in range(3)]
    return {
        'the true inputs': stacked(exact),
        'counters as they read': stacked([*counters, exact[2]]),
        "counters led by the winches' pay-out speed": stacked([*paths, exact[2]]),
        'the log as it is smoothed': stacked([*exact[:2], log]),
    }


def _readings(read: TowReadings, name: str) -> tuple[FloatArray, FloatArray]:
    return read.series[name].times, read.series[name].values


def _channels(tow: MovingTow, group: str) -> list[int]:
    return [place for place, name in enumerate(tow.channels) if group_of(name) == group]
