"""Makes trials: what a diagnoser may see, and the key it may not."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from trawl_ros.diagnosis.showing import split
from trawl_ros.effects.effect import Situation
from trawl_ros.errors import NoSteadyState
from trawl_ros.identification.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.identification.from_gear import board_prior
from trawl_ros.identification.over_ground import GroundTrack
from trawl_ros.identification.window_records import SteadyWindow
from trawl_ros.model.observables import OBSERVABLES
from trawl_ros.studies.discrepancy.inside import INSIDE
from trawl_ros.studies.discrepancy.outside import OUTSIDE
from trawl_ros.studies.discrepancy.plant import Plant, draw_plant
from trawl_ros.studies.discrepancy.strength import Likelihood, likelihood
from trawl_ros.studies.discrepancy.tows import BASELINE, PLAN, PlannedTow
from trawl_ros.studies.identification.plant import Cut, Look
from trawl_ros.studies.identification.readings import AS_STATED, steady_windows, wrong_by

WRONG_BY = 0.3
"""Noise and biases of each kind of sensor are larger or smaller than stated by this part."""

DROPOUTS = 0.02
"""Part of the means that are missing of windows in which a channel fell silent."""

LENGTH_JITTER, SPEED_JITTER, HOURS_JITTER = 4.0, 0.02, 0.05
"""Std of how far (m, m/s, h) states are from the plan."""


@dataclass(frozen=True)
class Spec:
    """A trial to be made.

    Attributes
    ----------
    series
        'clean', 'inside', 'outside' or 'pair'.
    number
        Within the study.
    effects
        Names of what is hidden.
    strength
        In smallest detectable sizes.
    signs
        To which sides.
    plant
        Number of the plant.
    """

    series: str
    number: int
    effects: tuple[str, ...]
    strength: float
    signs: tuple[float, ...]
    plant: int


@dataclass(frozen=True)
class Key:
    """What is hidden in a trial, ``testable`` or not; read by the scorer alone.

    ``floor`` are errors, by channel, that the plant itself would have on what is kept back.
    """

    spec: Spec
    sizes: tuple[float, ...]
    units: tuple[str, ...]
    detectable: tuple[float, ...]
    testable: bool
    why_not: str
    coefficients: tuple[float, ...]
    floor: Mapping[str, float]

    def record(self) -> dict[str, Any]:
        """As JSON has it; sizes that are infinite are null."""
        record = asdict(self)
        for name in ('sizes', 'detectable'):
            record[name] = [value if np.isfinite(value) else None for value in record[name]]
        return record


def make(spec: Spec, gear: str, cut: Cut, seed: int) -> tuple[Key, tuple[SteadyWindow, ...] | None]:
    """Make a trial, or say in its key why it cannot be made."""
    chance = np.random.default_rng([seed, spec.number, *spec.series.encode()])
    plant, likely = _plant(gear, cut, seed, spec.plant)
    drawn = tuple({**INSIDE, **OUTSIDE}[name](chance) for name in spec.effects)
    # Two at once are each as strong as if it were alone.
    outside = spec.series == 'outside'
    detectable = tuple(
        likely.detectable(hidden, sign, beside_catalogue=outside)
        for hidden, sign in zip(drawn, spec.signs, strict=True)
    )
    sizes = tuple(
        sign * spec.strength * size for sign, size in zip(spec.signs, detectable, strict=True)
    )
    units = tuple(hidden.unit for hidden in drawn)

    def key(why_not: str = '') -> Key:
        coefficients = tuple(map(float, plant.coefficients))
        return Key(spec, sizes, units, detectable, not why_not, why_not, coefficients, {})

    for hidden, size in zip(drawn, sizes, strict=True):
        most = hidden.most[0] if size < 0.0 else hidden.most[1]
        if not abs(size) <= most:
            return key(f'{hidden.name} of {size:.3g} {hidden.unit} is not possible'), None
    try:
        tows = plant.towed(list(zip(drawn, sizes, strict=True)))
    except NoSteadyState as reason:
        return key(f'cannot be towed: {reason}'), None
    windows, looks = windows_of(tows, chance)
    return replace(key(), floor=_floor(windows, looks)), windows


def _floor(windows: Sequence[SteadyWindow], looks: Sequence[Look]) -> dict[str, float]:
    """Errors that the plant itself would have on the windows that are kept back, by channel."""
    showing = {window.index for window in split(windows, frozenset(range(BASELINE))).showing}
    errors: dict[str, list[float]] = {}
    for window, look in zip(windows, looks, strict=True):
        if window.index not in showing:
            continue
        inputs = np.array([window.means[name] for name in INPUTS])
        predicted = look.values + look.by_inputs @ (inputs - np.array(look.inputs))
        for name in MEASURED:
            if name in window.means:
                error = window.means[name] - float(predicted[OBSERVABLES.index(name)])
                errors.setdefault(name, []).append(error)
    return {name: float(np.sqrt(np.mean(np.square(own)))) for name, own in errors.items()}


def windows_of(
    tows: Sequence[Sequence[Look]],
    chance: np.random.Generator,
    plan: Sequence[PlannedTow] = PLAN,
) -> tuple[tuple[SteadyWindow, ...], tuple[Look, ...]]:
    """Windows as instruments give them, of states that are not quite as planned, and the states."""
    jittered = [[_jittered(look, chance) for look in tow] for tow in tows]
    windows = steady_windows(jittered, wrong_by(WRONG_BY, chance), chance)
    states = [(tow, place) for tow in plan for place in range(len(tow.states))]
    seen = tuple(
        _as_seen(window, number, tow.moment(place), chance)
        for number, (window, (tow, place)) in enumerate(zip(windows, states, strict=True))
    )
    return seen, tuple(look for tow in jittered for look in tow)


def _jittered(look: Look, chance: np.random.Generator) -> Look:
    length = LENGTH_JITTER * chance.standard_normal()
    speed = SPEED_JITTER * chance.standard_normal()
    state = (look.state[0] + length, look.state[1] + speed)
    values = look.values + look.by_inputs @ np.array([length, length, speed])
    return replace(look, state=state, values=values)


def _as_seen(
    window: SteadyWindow, number: int, at: Situation, chance: np.random.Generator
) -> SteadyWindow:
    # Windows without a channel that is required are none.
    lost = {
        name for name in window.means if not CHANNELS[name].required and chance.uniform() < DROPOUTS
    }

    def kept(values: Mapping[str, float]) -> dict[str, float]:
        return {name: own for name, own in values.items() if name not in lost}

    return replace(
        window,
        index=number,
        state=number,
        hours=at.hours + HOURS_JITTER * chance.uniform(-1.0, 1.0),
        track=GroundTrack(0.0 if at.sense > 0.0 else np.pi, 0.0, 0.0, False),
        means=kept(window.means),
        noise=kept(window.noise),
        bias=kept(window.bias),
        counts={name: own for name, own in window.counts.items() if name not in lost},
    )


@cache
def _plant(gear: str, cut: Cut, seed: int, number: int) -> tuple[Plant, Likelihood]:
    plant = draw_plant(gear, cut, seed, number)
    quiet = steady_windows(plant.looks, AS_STATED, np.random.default_rng(0))
    quiet = tuple(replace(window, index=place, state=place) for place, window in enumerate(quiet))
    return plant, likelihood(plant, board_prior(cut.model(gear)), quiet)
