# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Blind trials: visible data and the key."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from trawl_ros.core.errors import NoSteadyState, TrawlError
from trawl_ros.diagnosis.holdout import split
from trawl_ros.effects.base.effect import Situation
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.over_ground import GroundTrack
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.answers import EVERY_CAUSE
from trawl_ros.lab.trials.hidden_effects.hidden import Hidden
from trawl_ros.lab.trials.linearised_plant import LinearisedState, MeshResolution
from trawl_ros.lab.trials.plant import Plant, draw_plant
from trawl_ros.lab.trials.readings import (
    AS_STATED,
    Sensors,
    steady_windows,
    wrong_by,
)
from trawl_ros.lab.trials.recording import record_tows
from trawl_ros.lab.trials.strength import Likelihood, likelihood
from trawl_ros.lab.trials.towing import Course, quasi_steady, towed_in_time
from trawl_ros.lab.trials.tows import PLANS, BlindTrialPlan
from trawl_ros.lab.trials.trial import Key, Spec
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium, require_usable
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.stepper import StepFailed
from trawl_ros.solver.trimming.drawn_board import fastened_as


@dataclass(frozen=True)
class MakingOptions:
    """Options of blind trials.

    Attributes
    ----------
    sensor_deviation
        Relative deviation of the true noise and biases of each sensor from the stated ones.
    dropout_share
        Share of windows in which an optional channel is silent.
    most_plants, next_plant
        Largest number of plants that are drawn, and the step from one number to the next.
    length_std, speed_std
        Std (m, m/s) of the states about the plan.
    hours_spread
        Largest distance (h) of a state from its planned time.
    """

    sensor_deviation: float = 0.3
    dropout_share: float = 0.02
    most_plants: int = 20
    next_plant: int = 1000
    length_std: float = 4.0
    speed_std: float = 0.02
    hours_spread: float = 0.05


MAKING_OPTIONS = MakingOptions()


@dataclass(frozen=True)
class SeededTrial:
    """Plant with effects hidden in it, and the key."""

    key: Key
    plant: Plant
    effects: tuple[tuple[Hidden, float], ...]
    sensors: Sensors

    def towed(self, plan: BlindTrialPlan) -> tuple[tuple[LinearisedState, ...], ...] | None:
        """Return the tows of the plant, or None if it cannot be towed."""
        try:
            return self.plant.towed(self.effects, plan)
        except NoSteadyState:
            return None


def hide(spec: Spec, gear: str, cut: MeshResolution, seed: int) -> SeededTrial:
    """Hide the wanted effects if possible."""
    shape = chance_of(spec, seed)
    plant = _plant(gear, cut, seed, spec.plant, spec.plan)
    likely = likelihood_of(gear, cut, seed, spec.plant, spec.plan)
    drawn = tuple(EVERY_CAUSE[name](shape) for name in spec.effects)
    # Two at once are each as strong as if it were alone.
    outside = spec.series == 'outside'
    detectable = tuple(
        likely.detectable(hidden, sign, after_catalogue=outside)
        for hidden, sign in zip(drawn, spec.signs, strict=True)
    )
    sizes = tuple(
        sign * spec.strength * size for sign, size in zip(spec.signs, detectable, strict=True)
    )
    units = tuple(hidden.unit for hidden in drawn)
    why_not = ''
    for hidden, size in zip(drawn, sizes, strict=True):
        if not abs(size) <= hidden.most[0 if size < 0.0 else 1]:
            why_not = f'{hidden.name} of {size:.3g} {hidden.unit} is not possible'
    sizes = tuple(
        float(np.sign(size)) if hidden.whole else size
        for hidden, size in zip(drawn, sizes, strict=True)
    )
    coefficients = tuple(map(float, plant.coefficients))
    key = Key(spec, sizes, units, detectable, not why_not, why_not, coefficients, {})
    sensors = wrong_by(MAKING_OPTIONS.sensor_deviation, chance_of(spec, seed, 'sensors'))
    return SeededTrial(key, plant, tuple(zip(drawn, sizes, strict=True)), sensors)


def chance_of(spec: Spec, seed: int, what: str = '') -> np.random.Generator:
    """Random generator of a trial."""
    return np.random.default_rng([seed, spec.number, *spec.series.encode(), *what.encode()])


def make(
    spec: Spec, gear: str, cut: MeshResolution, seed: int
) -> tuple[Key, tuple[SteadyWindow, ...] | None]:
    """Make a trial of windows, or give the reason in its key why it cannot be made."""
    hiding, plan = hide(spec, gear, cut, seed), PLANS[spec.plan]
    if not hiding.key.testable:
        return hiding.key, None
    tows = hiding.towed(plan)
    if tows is None:
        return replace(hiding.key, testable=False, why_not='cannot be towed'), None
    windows, looks = windows_of(tows, chance_of(spec, seed, 'noise'), plan, hiding.sensors)
    floor = floor_of(windows, looks, plan.baseline)
    return replace(hiding.key, floor=floor), windows


def floor_of(
    windows: Sequence[SteadyWindow], looks: Sequence[LinearisedState], baseline: int
) -> dict[str, float]:
    """Return the plant's own errors by channel, on the windows held out of the fit."""
    kept_back = {window.index for window in split(windows, frozenset(range(baseline))).kept_back}
    errors: dict[str, list[float]] = {}
    for window, look in zip(windows, looks, strict=True):
        if window.index not in kept_back:
            continue
        inputs = np.array([window.means[name] for name in INPUTS])
        predicted = look.values + look.by_inputs @ (inputs - np.array(look.inputs))
        for name in MEASURED:
            if name in window.means:
                error = window.means[name] - float(predicted[OBSERVABLES.index(name)])
                errors.setdefault(name, []).append(error)
    return {name: float(np.sqrt(np.mean(np.square(own)))) for name, own in errors.items()}


def windows_of(
    tows: Sequence[Sequence[LinearisedState]],
    rng: np.random.Generator,
    plan: BlindTrialPlan,
    sensors: Sensors,
) -> tuple[tuple[SteadyWindow, ...], tuple[LinearisedState, ...]]:
    """Windows as instruments give them, of states that are not quite as planned, and the states.

    Parameters
    ----------
    tows
        Observables of the plant.
    rng
        Generator of random numbers.
    plan
        Tows of the trial.
    sensors
        True errors of the instruments.
    """
    jittered = [[_jittered(look, rng) for look in tow] for tow in tows]
    windows = steady_windows(jittered, sensors, rng)
    states = [(tow, place) for tow in plan.tows for place in range(len(tow.states))]
    seen = tuple(
        _as_seen(window, number, tow.moment(place), rng)
        for number, (window, (tow, place)) in enumerate(zip(windows, states, strict=True))
    )
    return seen, tuple(look for tow in jittered for look in tow)


def _jittered(look: LinearisedState, rng: np.random.Generator) -> LinearisedState:
    length = MAKING_OPTIONS.length_std * rng.standard_normal()
    speed = MAKING_OPTIONS.speed_std * rng.standard_normal()
    state = (look.state[0] + length, look.state[1] + speed)
    values = look.values + look.by_inputs @ np.array([length, length, speed])
    return replace(look, state=state, values=values)


def _as_seen(
    window: SteadyWindow, number: int, at: Situation, rng: np.random.Generator
) -> SteadyWindow:
    # Windows without a channel that is required are none.
    lost = {
        name
        for name in window.means
        if not CHANNELS[name].required and rng.uniform() < MAKING_OPTIONS.dropout_share
    }

    def kept(values: Mapping[str, float]) -> dict[str, float]:
        return {name: own for name, own in values.items() if name not in lost}

    return replace(
        window,
        index=number,
        state=number,
        hours=at.hours + MAKING_OPTIONS.hours_spread * rng.uniform(-1.0, 1.0),
        track=GroundTrack(0.0 if at.sense > 0.0 else np.pi, 0.0, 0.0, False),
        means=kept(window.means),
        noise=kept(window.noise),
        bias=kept(window.bias),
        counts={name: own for name, own in window.counts.items() if name not in lost},
    )


@cache
def _plant(gear: str, cut: MeshResolution, seed: int, number: int, plan: str) -> Plant:
    """Draw a plant whose gear file, as a ship has it, can be towed in the model too.

    Raises
    ------
    TrawlError
        If none of many can.
    """
    states = sorted({state for tow in PLANS[plan].tows for state in tow.states})
    for attempt in range(MAKING_OPTIONS.most_plants):
        own = number + MAKING_OPTIONS.next_plant * attempt
        plant = draw_plant(gear, cut, seed, own, states)
        record = fastened_as(cut.model(gear), plant.model.gear)
        model = build_model(record).with_coefficients(board_prior(record).start)
        near: Equilibrium | None = None
        try:
            for state in states:
                near = find_equilibrium(model, OperatingPoint(state[0], *state), near)
                require_usable(model, near)
        except NoSteadyState:
            continue
        return plant
    raise TrawlError(
        f'plant {number}: none of {MAKING_OPTIONS.most_plants} gear files can be towed'
    )


def gear_aboard(gear: str, cut: MeshResolution, seed: int, number: int, plan: str) -> GearRecord:
    """Return the gear of a plant as known aboard: only the fastening points are the true ones."""
    return fastened_as(cut.model(gear), _plant(gear, cut, seed, number, plan).model.gear)


@cache
def likelihood_of(gear: str, cut: MeshResolution, seed: int, number: int, plan: str) -> Likelihood:
    """Likelihood of a plant in the windows of a plan."""
    plant, tows = _plant(gear, cut, seed, number, plan), PLANS[plan]
    quiet = steady_windows(plant.towed((), tows), AS_STATED, np.random.default_rng(0))
    quiet = tuple(replace(window, index=place, state=place) for place, window in enumerate(quiet))
    return likelihood(plant, board_prior(cut.model(gear)), quiet, tows)


def make_bags(spec: Spec, gear: str, cut: MeshResolution, seed: int, folder: Path) -> Key:
    """Make a trial of bags in a folder, unless its hidden cause is not possible."""
    hiding = hide(spec, gear, cut, seed)
    if not hiding.key.testable:
        return hiding.key
    try:
        courses = _in_time(hiding) if spec.form == 'dynamic' else _steady(hiding)
    except (NoSteadyState, StepFailed) as reason:
        return replace(hiding.key, testable=False, why_not=f'cannot be towed: {reason}')
    rng, dropouts = chance_of(spec, seed, spec.form), MAKING_OPTIONS.dropout_share
    record_tows(folder, courses, hiding.plant.model.water, hiding.sensors, dropouts, rng)
    return hiding.key


def _steady(hiding: SeededTrial) -> list[Course]:
    plan = PLANS[hiding.key.spec.plan]
    tows = hiding.plant.towed(hiding.effects, plan)
    return [quasi_steady(tow, looks) for tow, looks in zip(plan.tows, tows, strict=True)]


def _in_time(hiding: SeededTrial) -> list[Course]:
    plan = PLANS[hiding.key.spec.plan]
    return [
        towed_in_time(hiding.plant.model, tow, () if number < plan.baseline else hiding.effects)
        for number, tow in enumerate(plan.tows)
    ]
