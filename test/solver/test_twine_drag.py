"""Drag of netting by the Reynolds number of its twine."""

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.twine_drag import (
    VISCOSITY,
    friction_coefficient,
    normal_coefficient,
    with_twine_drag,
)


def test_coefficients_are_those_of_the_formulas() -> None:
    assert normal_coefficient(np.array([10_000.0]))[0] == pytest.approx(1.14)
    # Below its range the law is taken as at its end.
    assert normal_coefficient(np.array([1.0]))[0] == normal_coefficient(np.array([30.0]))[0]
    diameter, across, along, density = 0.002, 0.4, 0.9, 1025.0
    numbers = np.array([across * diameter / VISCOSITY]), np.array([along * diameter / VISCOSITY])
    pull = np.pi * density * VISCOSITY * along
    pull *= 0.55 * numbers[0][0] ** 0.5 + 0.084 * numbers[0][0] ** (2 / 3)
    friction = friction_coefficient(*numbers)[0]
    assert 0.5 * density * friction * np.pi * diameter * along**2 == pytest.approx(pull)


def test_only_netting_changes_and_keeps_its_shielding() -> None:
    model = build_model(load_gear('krill_1600').refined(net=0.4))
    steady = steady_state(model, 250.0, 1.08)
    changed = with_twine_drag(model, steady.equilibrium)
    numbers = np.concatenate(
        [own for name, _, own in model.layout.lines if name in ('netting', 'codend')]
    )
    others = np.setdiff1d(np.arange(len(model.rest)), numbers)
    for name in ('normal_drag', 'friction'):
        mine, given = getattr(changed.bars, name), getattr(model.bars, name)
        np.testing.assert_array_equal(mine[others], given[others])
    ratio = changed.bars.normal_drag[numbers] / model.bars.normal_drag[numbers]
    ceiling = normal_coefficient(np.array([30.0]))[0] / model.gear.netting.normal_drag
    assert ratio.min() >= 1.1 / model.gear.netting.normal_drag
    assert ratio.max() <= ceiling * (1 + 1e-9)
    lumps = changed.lump_drag_area / np.maximum(model.lump_drag_area, 1e-12)
    codend = model.layout.net[-model.gear.netting.codend_segments :]
    moved = np.flatnonzero(np.abs(lumps - 1.0) > 1e-9)
    moved = moved[model.lump_drag_area[moved] > 0.0]
    assert set(moved) <= set(codend)
    assert len(moved) == len(codend)
