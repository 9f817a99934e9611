"""Synthetic logs: readings of the model's steady states, changed by a part on some sensors."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import channel_values, with_channel_values
from trawl_ros.records.samples import Sample
from trawl_ros.solver.equilibrium import steady_state

LEGS = ((190.0, 2.3), (220.0, 2.3), (220.0, 2.1), (250.0, 2.1))
LEG_S = 480

Changed = Callable[..., Path]


@pytest.fixture(scope='session')
def four_states(steady_tow: Any, coarse_gear: Path) -> Any:
    """Four steady states of the coarse gear at several warps and speeds."""
    model, states, start = build_model(load_gear(coarse_gear)), [], None
    for length, speed in LEGS:
        found = steady_state(model, length, speed, start=start)
        start = found.equilibrium
        states.append((length, speed, found.observables))
    return replace(steady_tow, states=tuple(states))


@pytest.fixture(scope='session')
def changed_log(four_states: Any, coarse_gear: Path, tmp_path_factory: Any) -> Changed:
    """Write a log whose sensors show so many times what the gear file says."""
    water = build_model(load_gear(coarse_gear)).water

    def changed(factors: dict[str, float], *, leg_s: int = LEG_S, **kwargs: int) -> Path:
        def samples() -> Iterator[Sample]:
            sample: Sample
            for sample in four_states.samples(leg_s=leg_s, **kwargs):
                if sample.stamp // SECOND % 2:
                    continue
                values = channel_values(sample, water.depth)
                wrong = {k: factors[k] * v for k, v in values.items() if k in factors}
                yield with_channel_values(sample, wrong, water.pressure) if wrong else sample

        path: Path = four_states.write(tmp_path_factory.mktemp('log') / 'log', samples())
        return path

    return changed


BOTH_SIDES = ('port', 'starboard')


@pytest.fixture(scope='session')
def off_log(changed_log: Changed) -> Path:
    """The log of the gear engineer: 6 % narrower, 7 % heavier and 5 % deeper than the file says."""
    factors = {'door_spread': 0.94, 'net_depth': 1.05}
    factors |= {f'{side}_tension': 1.07 for side in BOTH_SIDES}
    factors |= {f'{side}_door_depth': 1.05 for side in BOTH_SIDES}
    return changed_log(factors, seed=3)
