"""Kites on ropes: lift across the flow, its derivatives, and what it does to a mouth."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import share_path
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.kite import LiftingBodies
from trawl_ros.solver.advising.rig_changes import hung_changes
from trawl_ros.solver.equilibrium import steady_state

RNG = np.random.default_rng(7)


def gear_with(folder: Path, *items: dict[str, Any]) -> GearRecord:
    data = yaml.safe_load(share_path('config', 'gear', 'krill_1600.yaml').read_text())
    data['hung'] += [{'name': f'kite {n}', **item} for n, item in enumerate(items)]
    file = folder / 'own.yaml'
    file.write_text(yaml.safe_dump(data))
    return load_gear(file).refined(net=0.4)


@pytest.fixture(scope='module')
def bodies() -> LiftingBodies:
    water = build_model(load_gear('krill_1600').refined(net=0.4)).water
    return LiftingBodies(np.arange(4), np.array([1.0, 2.0, -3.0, 0.5]), water)


def test_lift_is_across_the_flow_and_goes_with_its_square(bodies: LiftingBodies) -> None:
    positions, velocities = RNG.normal(size=(2, 4, 3)) - [0.0, 0.0, 50.0]
    velocities[:, 2] = RNG.normal(size=4)
    lift = bodies(positions, velocities)
    np.testing.assert_allclose((lift * velocities).sum(axis=1), 0.0, atol=1e-6)
    head = 0.5 * bodies.water.density_at(positions[:, 2]) * (velocities**2).sum(axis=1)
    np.testing.assert_allclose(np.linalg.norm(lift, axis=1), head * np.abs(bodies.area))
    np.testing.assert_array_equal(np.sign(lift[:, 2]), np.sign(bodies.area))
    np.testing.assert_allclose(bodies(positions, 2 * velocities), 4 * lift)


def test_lift_has_the_derivatives_of_its_differences(bodies: LiftingBodies) -> None:
    positions, velocities = RNG.normal(size=(2, 4, 3))
    for axis in range(3):
        step = np.eye(3)[axis]
        exact = bodies(positions + 0j, velocities + 1e-30j * step).imag / 1e-30
        ahead, back = (bodies(positions, velocities + sign * 1e-6 * step) for sign in (1, -1))
        np.testing.assert_allclose(exact, (ahead - back) / 2e-6, rtol=1e-4, atol=1e-3)


def test_still_water_lifts_nothing(bodies: LiftingBodies) -> None:
    np.testing.assert_allclose(bodies(np.zeros((4, 3)), np.zeros((4, 3))), 0.0, atol=1e-6)


def test_several_kites_lie_where_the_file_says_and_open_the_mouth(tmp_path: Path) -> None:
    plain = gear_with(tmp_path)
    kites = gear_with(
        tmp_path,
        {'rope': 'headrope', 'from_share': 0.45, 'to_share': 0.55, 'lift_area_m2': 2.0},
        {'rope': 'headrope', 'from_share': 0.2, 'to_share': 0.25, 'lift_area_m2': 1.0},
        {'rope': 'headrope', 'from_share': 0.75, 'to_share': 0.8, 'lift_area_m2': 1.0},
        {'rope': 'footrope', 'lift_area_m2': -2.0, 'weight_in_water_n': 100.0},
    )
    model = build_model(kites)
    assert [
        force.area.sum() for force in model.node_forces if isinstance(force, LiftingBodies)
    ] == (pytest.approx([2.0, 1.0, 1.0, -2.0]))
    assert set(model.node_forces[0].nodes) < set(model.layout.headrope)
    assert set(model.node_forces[3].nodes) <= set(model.layout.footrope)
    low, high = (steady_state(build_model(gear), 250.0, 1.2).observables for gear in (plain, kites))
    assert high.vertical_opening > low.vertical_opening + 0.3


def test_a_kite_has_no_weight_that_could_be_changed(tmp_path: Path) -> None:
    alone = gear_with(tmp_path, {'rope': 'headrope', 'lift_area_m2': 2.0})
    assert len(hung_changes(alone)) == len(hung_changes(gear_with(tmp_path)))


def test_what_neither_weighs_nor_lifts_is_refused(tmp_path: Path) -> None:
    with pytest.raises(GearError, match='lift_area_m2'):
        gear_with(tmp_path, {'rope': 'headrope'})
