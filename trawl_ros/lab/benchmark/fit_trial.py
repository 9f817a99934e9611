"""Fifteen steady states of a gear that is not quite the model, as instruments report them."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

LENGTHS = (200.0, 375.0, 550.0, 725.0, 900.0)
SPEEDS = (1.8, 2.0, 2.2)

MORE_DRAG = 1.05
READINGS = 60
SEED = 1


def plant_of(gear: GearRecord) -> GearModel:
    """A gear unlike its model: its net has more drag."""
    drag = {'normal_drag': gear.netting.normal_drag * MORE_DRAG}
    return build_model(gear.model_copy(update={'netting': gear.netting.model_copy(update=drag)}))


def trial(
    plant: GearModel, lengths: Sequence[float], speeds: Sequence[float]
) -> list[SteadyWindow]:
    """One window per steady state, with errors as large as those of the instruments."""
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
