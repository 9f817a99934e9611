"""Trials of a coarse gear in which something may be hidden, past the catalogue of effects."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.linearised_plant import LinearisedState
from trawl_ros.lab.trials.readings import AS_STATED, steady_windows
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.sensitivity import sensitivities

TOWS = 3
STATES = ((800.0, 2.2), (600.0, 2.4), (450.0, 2.2), (300.0, 2.4), (600.0, 2.2))
HOURS = 0.5
"""Between two states."""


@dataclass(frozen=True)
class Hidden:
    """What is hidden: in the gear, by the hours towed, and in what sensors show."""

    gear: Callable[[GearModel, float], GearModel] = lambda model, hours: model
    shown: Callable[[dict[str, float]], dict[str, float]] = lambda values: values


@cache
def looks(gear: GearRecord, hidden: Hidden) -> tuple[LinearisedState, ...]:
    """The states of one tow of a board that differs from the start values."""
    prior = board_prior(gear)
    board = prior.start + 0.3 * prior.std * np.cos(np.arange(12))
    model, found, near = build_model(gear), [], None
    for number, (length, speed) in enumerate(STATES):
        there = hidden.gear(model, HOURS * number).with_coefficients(board)
        near = find_equilibrium(there, OperatingPoint(length, length, speed), near)
        jacobian = sensitivities(there, near)
        seen = dict(zip(OBSERVABLES, near.observables.array(), strict=True))
        values = np.array([hidden.shown(seen)[name] for name in OBSERVABLES])
        found.append(LinearisedState((length, speed), values, jacobian[:, 12:], jacobian[:, :12]))
    return tuple(found)


def trial(
    gear: GearRecord, hidden: Hidden, seed: int, tows: int = TOWS, first: int = 0
) -> list[SteadyWindow]:
    """Steady windows of tows with errors of instruments as stated."""
    seen = looks(gear, hidden)
    rng = np.random.default_rng(seed)
    windows = steady_windows([seen] * tows, AS_STATED, rng, first_tow=first)
    return [
        replace(window, hours=HOURS * (number % len(STATES)))
        for number, window in enumerate(windows)
    ]


def catch_in_steps(model: GearModel, hours: float) -> GearModel:
    """Fish that comes into the codend in two schools, and a little all the time."""
    area = model.lump_drag_area.copy()
    codend = [points[-1] for name, points, _ in model.layout.lines if name == 'codend'][-1]
    area[codend] += 1.5 * (hours > 0.4) + 1.5 * (hours > 1.4) + 1.5 * hours
    return replace(model, lump_drag_area=area)


def tight_cells(values: dict[str, float]) -> dict[str, float]:
    """Tension cells that show a seventh too much."""
    return {
        name: 1.15 * value if name.endswith('_tension') else value for name, value in values.items()
    }


@pytest.fixture(scope='session')
def coarse():
    gear = load_gear('kaifuha')
    return gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 12})})


@pytest.fixture(scope='session')
def hide():
    """What tests need of this file."""
    return SimpleNamespace(
        Hidden=Hidden,
        trial=trial,
        catch=Hidden(gear=catch_in_steps),
        cells=Hidden(shown=tight_cells),
        nothing=Hidden(),
        names=[f'tow {number + 1}' for number in range(2 * TOWS)],
    )
