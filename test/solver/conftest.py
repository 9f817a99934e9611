"""One steady state that most claims look at."""

import pytest

from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import SteadyState, steady_state


@pytest.fixture(scope='session')
def steady(model: GearModel) -> SteadyState:
    """The coarse gear at 500 m of warp and 2.1 m/s."""
    return steady_state(model, 500.0, 2.1)
