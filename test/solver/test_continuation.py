"""Branches go through folds, and meet what is solved at their places anew."""

from itertools import islice

import numpy as np
import pytest

from trawl_ros.gear.records import GearRecord
from trawl_ros.model.assembly import forces
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.observables import observe
from trawl_ros.model.state import Tow
from trawl_ros.solver.continuation import branch
from trawl_ros.solver.equilibrium import SteadyState, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow


def over_speed(model: GearModel):
    def family(speed: float) -> tuple[GearModel, Tow]:
        return model, steady_tow(model, OperatingPoint(500.0, 500.0, speed))

    return family


def test_points_of_a_branch_are_steady_states(model: GearModel, steady: SteadyState) -> None:
    points = list(islice(branch(over_speed(model), 2.1, steady.equilibrium.state, scale=-0.1), 6))
    values = [here.value for here in points]
    assert values[0] == 2.1
    assert (np.diff(values) < 0.0).all()
    for here in points:
        assert np.abs(forces(here.model, here.state, here.tow)).max() < 1e-4
    last = points[-1]
    anew = find_equilibrium(
        model, OperatingPoint(500.0, 500.0, last.value), steady.equilibrium
    ).observables.array()
    seen = observe(model, last.state, last.tow).array()
    np.testing.assert_allclose(seen, anew, rtol=1e-6, atol=1e-7)


def test_a_branch_over_warp_length_meets_the_states_there(
    model: GearModel, steady: SteadyState
) -> None:
    def family(length: float) -> tuple[GearModel, Tow]:
        return model, steady_tow(model, OperatingPoint(length, length, 2.1))

    *_, last = islice(branch(family, 500.0, steady.equilibrium.state, scale=10.0), 4)
    assert last.value > 505.0
    expected = find_equilibrium(model, OperatingPoint(last.value, last.value, 2.1))
    seen = observe(model, last.state, last.tow).array()
    np.testing.assert_allclose(seen, expected.observables.array(), rtol=1e-6, atol=1e-7)


@pytest.mark.slow
def test_towed_more_and_more_slowly_the_branch_folds_back(gear: GearRecord) -> None:
    coarse = build_model(
        gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 24})})
    )
    start = find_equilibrium(coarse, OperatingPoint(500.0, 500.0, 2.1))
    points = list(islice(branch(over_speed(coarse), 2.1, start.state, scale=-0.1), 60))
    rates = np.array([here.rate for here in points])
    turned = int(np.argmax(rates < 0.0))
    assert turned > 0
    assert points[turned].value == pytest.approx(1.526, abs=0.005)
    assert points[-1].value > points[turned].value
