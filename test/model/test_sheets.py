"""Lift of sheets of netting: its size, its direction, and its derivatives."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.model.assembly import forces, linearised
from trawl_ros.model.bar_pass import water_of
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.lump_pass import add_sheet_forces
from trawl_ros.model.numerics import STEP
from trawl_ros.model.water import Water


@pytest.fixture(scope='module')
def dense() -> GearModel:
    """A net whose fine netting lifts."""
    model = build_model(load_gear('krill_800').refined(net=0.4))
    assert model.sheets.lift.max() > 0.0
    return model


def test_jacobian_equals_the_complex_step_where_sheets_lift(dense: GearModel, random_case) -> None:
    model, state, tow = random_case(dense, 1)
    here = linearised(model, state, tow)
    direction = np.random.default_rng(5).normal(size=model.dof)
    moved = forces(model, state.moved(1j * STEP * direction), tow)
    faster = forces(model, state.with_velocity(state.velocity + 1j * STEP * direction), tow)
    for data, along in ((here.stiffness, moved), (here.damping, faster)):
        expected = -along.imag / STEP
        found = model.pattern.matrix(data) @ direction
        assert np.abs(found - expected).max() < 1e-11 * np.abs(expected).max()
    plain = forces(model, state, tow)
    assert np.abs(plain - here.force).max() < 1e-12 * np.abs(plain).max()


@pytest.mark.parametrize('slope', [0.1, 0.4])
def test_a_flat_sheet_is_lifted_across_the_flow(dense: GearModel, slope: float) -> None:
    # A diamond of 4 m along and 1 m around, of which its middle has half of the area.
    around = np.arange(5)[None]
    weights = np.array([[[0.0, -0.5, -0.5, 0.5, 0.5], [0.0, -0.25, 0.25, -0.25, 0.25]]])
    x = np.array([[0, 0, 0], [-1, -0.5, 0], [-1, 0.5, 0], [1, -0.5, 0], [1, 0.5, 0]], float)
    lift, twine, total = np.array([3.0]), np.array([0.2]), np.zeros((5, 3))
    speed = 1.5
    v = np.zeros((5, 3))
    v[0] = -speed * np.array([np.cos(slope), 0.0, np.sin(slope)])
    water = water_of(Water(density=1025.0))
    add_sheet_forces(x, v, around, weights, lift, twine, water, total)
    area = 1.0
    pressure = 0.5 * 1025.0 * speed**2
    square = 0.2**2 / (area**2 + 0.2**2)
    expected = 3.0 * square * pressure * area * np.sin(slope) * np.cos(slope)
    assert total[0] @ v[0] == pytest.approx(0.0, abs=1e-9)
    assert np.linalg.norm(total[0]) == pytest.approx(expected, rel=1e-6)
    assert total[0, 2] > 0.0
    assert not total[1:].any()


def test_sheets_cover_the_netting_once(dense: GearModel) -> None:
    bars = [bar for bar in dense.net_mesh.bars if bar.group == 'netting']
    twine = sum(bar.area * bar.rest for bar in bars)
    assert 0.7 * twine < dense.sheets.twine.sum() <= twine


def test_a_file_can_switch_lift_off() -> None:
    gear = load_gear('krill_800')
    netting = gear.netting.model_copy(update={'lift': 0.0})
    model = build_model(gear.model_copy(update={'netting': netting}).refined(net=0.4))
    assert len(replace(model).sheets.lift) == 0
