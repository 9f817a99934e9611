"""Forces on one straight bar, each against its equation written out."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model import line
from trawl_ros.model.bar import SLACK_WIDTH
from trawl_ros.model.line import BarMotion, BarProperties
from trawl_ros.model.water import Water

WATER = Water(density=1025.0)
DIAMETER, REST, STIFFNESS = 0.032, 30.0, 4e7
BAR = BarProperties(
    stiffness=np.array([STIFFNESS]),
    damping_time=np.array([0.05]),
    mass=np.array([3.7]),
    volume=np.array([np.pi / 4 * DIAMETER**2]),
    normal_area=np.array([DIAMETER]),
    wet_area=np.array([np.pi * DIAMETER]),
    normal_drag=np.array([1.2]),
    friction=np.array([0.02]),
    added_normal=np.array([1.0]),
    added_tangential=np.array([0.1]),
    bow=np.array([0.0]),
)
AHEAD = np.array([1.0, 0.0, 0.0])


def motion(
    along=AHEAD, strain=0.0, stretching=0.0, velocity=(0.0, 0.0, 0.0), rest_rate=0.0
) -> BarMotion:
    along = np.asarray(along)
    return BarMotion(
        vector=(REST * (1 + strain) * along)[None],
        stretching=(stretching * along)[None],
        velocity=np.array([velocity]),
        height=np.array([-100.0]),
        rest=np.array([REST]),
        rest_rate=np.array([rest_rate]),
    )


@pytest.mark.parametrize('strain', [2 * SLACK_WIDTH, 0.003, 0.02])
def test_a_taut_bar_pulls_in_proportion_to_its_strain(strain: float) -> None:
    force, along = line.tension(BAR, motion(strain=strain))
    assert force[0] == pytest.approx(STIFFNESS * strain, rel=1e-9)
    np.testing.assert_allclose(along[0], AHEAD)


@pytest.mark.parametrize('stretching', [-1.0, 0.0, 1.0])
def test_a_slack_bar_neither_pulls_nor_pushes(stretching: float) -> None:
    force, _ = line.tension(BAR, motion(strain=-1.01 * SLACK_WIDTH, stretching=stretching))
    assert force[0] == 0.0


def test_the_corner_between_slack_and_taut_is_rounded_within_its_width() -> None:
    strain = np.linspace(-2, 2, 4001) * SLACK_WIDTH
    value, slope, curve = line.taut(strain)
    np.testing.assert_allclose(np.gradient(value, strain), slope, atol=1e-3)
    assert np.abs(np.diff(slope)).max() <= curve.max() * (strain[1] - strain[0]) * 1.01
    assert np.abs(value - np.maximum(strain, 0.0)).max() <= SLACK_WIDTH / 4 * (1 + 1e-9)


@pytest.mark.parametrize('strain', [-0.5, -0.01, -1e-4, 0.0, 1e-4, 0.01])
def test_a_bowed_bar_is_shorter_by_its_arc_and_longer_by_its_pull(strain: float) -> None:
    load = 50.0
    bowed = replace(BAR, bow=np.array([(load / STIFFNESS) ** 2 / 24]))
    (force,), _ = line.tension(bowed, motion(strain=strain))
    assert force > 0.0
    assert force / STIFFNESS - (load / force) ** 2 / 24 == pytest.approx(strain, abs=1e-12)


def test_an_arc_between_two_points_under_an_even_load_has_the_tension_of_a_bowed_bar() -> None:
    # A circular arc of radius R under a load q across it pulls with q R; its chord is 2 R sin(a).
    angle, load = 0.05, 50.0
    strain = np.sin(angle) / angle - 1.0 + load / (2 * angle) / STIFFNESS
    bowed = replace(BAR, bow=np.array([(load / STIFFNESS) ** 2 / 24]))
    (force,), _ = line.tension(bowed, motion(strain=strain))
    assert force == pytest.approx(load / (2 * angle), rel=1e-3)


def test_slopes_of_a_bowed_bar_are_those_of_its_tension() -> None:
    strain = np.linspace(-1e-2, 1e-2, 4001)
    value, slope, curve = line.taut(strain, 1e-8)
    np.testing.assert_allclose(np.gradient(value, strain)[1:-1], slope[1:-1], atol=1e-5)
    np.testing.assert_allclose(np.gradient(slope, strain)[1:-1], curve[1:-1], atol=1e-2)


def test_damping_resists_stretching_in_proportion_to_its_rate() -> None:
    calm, _ = line.tension(BAR, motion(strain=0.01))
    moving, _ = line.tension(BAR, motion(strain=0.01, stretching=0.3))
    assert moving[0] - calm[0] == pytest.approx(STIFFNESS * 0.05 * 0.3 / REST, rel=1e-9)


def test_a_warp_paid_out_as_fast_as_it_stretches_does_not_brake() -> None:
    calm, _ = line.tension(BAR, motion(strain=0.01))
    paid_out, _ = line.tension(BAR, motion(strain=0.01, stretching=1.01 * 0.3, rest_rate=0.3))
    assert paid_out[0] == pytest.approx(calm[0], rel=1e-9)


@pytest.mark.parametrize('degrees', [0.0, 10.0, 45.0, 90.0])
def test_drag_is_the_sum_of_cross_flow_and_friction(degrees: float) -> None:
    # The bar moves at 2 m/s at an angle to its own direction.
    slope = np.radians(degrees)
    along = np.array([np.cos(slope), 0.0, -np.sin(slope)])
    here = motion(along=along, velocity=(2.0, 0.0, 0.0))
    found = line.drag(BAR, here, along[None], WATER)[0]
    normal = 0.5 * 1025.0 * 1.2 * DIAMETER * REST * (2.0 * np.sin(slope)) ** 2
    friction = 0.5 * 1025.0 * 0.02 * np.pi * DIAMETER * REST * (2.0 * np.cos(slope)) ** 2
    expected = -friction * along - normal * np.array([np.sin(slope), 0.0, np.cos(slope)])
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-2)


def test_weight_is_mass_less_displaced_water() -> None:
    found = line.weight(BAR, motion(), WATER)[0]
    displaced = 1025.0 * np.pi / 4 * DIAMETER**2
    assert found == pytest.approx(-(3.7 - displaced) * 9.80665 * REST, rel=1e-12)


def test_added_mass_acts_across_and_along_the_bar() -> None:
    along = np.array([0.6, 0.0, -0.8])
    inertia = line.mass(BAR, motion(along=along), WATER)[0]
    displaced = 1025.0 * np.pi / 4 * DIAMETER**2 * REST
    across = np.array([0.8, 0.0, 0.6])
    np.testing.assert_allclose(inertia @ across, (3.7 * REST + displaced) * across)
    np.testing.assert_allclose(inertia @ along, (3.7 * REST + 0.1 * displaced) * along)


def test_two_bars_side_by_side_are_one_bar_of_twice_the_area() -> None:
    double = replace(
        BAR,
        **{
            name: 2 * getattr(BAR, name)
            for name in ('stiffness', 'mass', 'volume', 'normal_area', 'wet_area')
        },
    )
    here = motion(along=(0.8, 0.6, 0.0), strain=0.004, velocity=(1.0, 0.5, -0.3))
    one, two = (line.linearised(bar, here, WATER) for bar in (BAR, double))
    for name, value in vars(one).items():
        np.testing.assert_allclose(getattr(two, name), 2 * value, rtol=1e-12, err_msg=name)
