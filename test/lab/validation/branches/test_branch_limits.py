"""Limits along branches: where they turn unstable, and which motion grows there."""

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.validation.branches.branch_limits import followed_branch, limits, sweeps
from trawl_ros.lab.validation.branches.lattices import SPEED
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import steady_state


def test_a_branch_over_epsilon_ends_in_boards_that_heave_against_each_other(
    model: GearModel,
) -> None:
    (sweep,) = (sweep for sweep in sweeps(model, (), angles=True) if sweep.name == 'ε > 0')
    lost, *_ = limits(followed_branch(sweep, 15))
    assert lost.kind == 'unstable, Hopf'
    assert lost.mode.startswith('heave of one board')
    steady_state(_turned(model, lost.value - 0.5), 500.0, SPEED)
    with pytest.raises(NoSteadyState, match='unstable'):
        steady_state(_turned(model, lost.value + 1.0), 500.0, SPEED)


def _turned(model: GearModel, epsilon_deg: float) -> GearModel:
    return model.with_board(installation=(np.radians(epsilon_deg), 0.0, 0.0))
