"""Limits along branches: where they turn unstable, and which motion grows there."""

import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.validation.branches.branch_limits import followed_branch, limits, sweeps
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import steady_state


def test_a_branch_over_speed_ends_in_boards_that_heave_against_each_other(
    model: GearModel,
) -> None:
    (sweep,) = sweeps(model, (500.0,), angles=False)
    lost, *_ = limits(followed_branch(sweep, 18))
    assert lost.kind == 'unstable, real'
    assert lost.mode == 'heave of one board against the other'
    steady_state(model, 500.0, lost.value + 0.05)
    with pytest.raises(NoSteadyState, match='unstable'):
        steady_state(model, 500.0, lost.value - 0.03)
