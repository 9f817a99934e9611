"""Forces on one straight bar, each against its equation written out."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model import line
from trawl_ros.model.bar import SLACK_WIDTH, mass_at, weight_at
from trawl_ros.model.bar_pass import add_bar_blocks, add_bar_forces, add_bar_masses, water_of
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
    normal_viscous=np.array([0.0]),
    friction_viscous=np.array([0.0]),
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


@pytest.mark.parametrize('stretching', [-1.0, 0.0, 0.9])
def test_a_bar_that_stays_slack_neither_pulls_nor_pushes(stretching: float) -> None:
    # One that stretches pulls as soon as it will be taut within its damping time.
    slack = -SLACK_WIDTH - 0.05 * 1.0 / REST
    force, _ = line.tension(BAR, motion(strain=slack, stretching=stretching))
    assert force[0] == 0.0


@pytest.mark.parametrize('bow', [0.0, 1e-9])
def test_no_bar_pushes_and_tension_rises_with_strain_and_with_its_rate(bow: float) -> None:
    strain = np.linspace(-20, 20, 81)[:, None] * SLACK_WIDTH
    stretching = np.linspace(-1.0, 1.0, 81)[None] * 100 * SLACK_WIDTH * REST
    bar = replace(BAR, bow=np.array([bow]))
    pull = np.array(
        [
            [line.tension(bar, motion(strain=e, stretching=v))[0][0] for v in stretching[0]]
            for e in strain[:, 0]
        ]
    )
    assert pull.min() >= 0.0
    for axis in (0, 1):
        assert np.diff(pull, axis=axis).min() >= -1e-9 * pull.max()


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
    area = np.pi / 4 * DIAMETER**2
    found = weight_at(3.7, area, REST, 1025.0, 9.80665)
    assert found == pytest.approx(-(3.7 - 1025.0 * area) * 9.80665 * REST, rel=1e-12)


def test_added_mass_acts_across_and_along_the_bar() -> None:
    along, across = np.array([0.6, 0.0, -0.8]), np.array([0.8, 0.0, 0.6])
    inertia = np.empty((3, 3))
    mass_at(111.0, 25.0, 2.5, REST * along, inertia)
    np.testing.assert_allclose(inertia @ across, (111.0 + 25.0) * across)
    np.testing.assert_allclose(inertia @ along, (111.0 + 2.5) * along)


def summed(bar: BarProperties) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Forces (2, 3) at the ends of one bar, and its slopes and mass (36,), as the pass has them."""
    x = np.array([[0.0, 0.0, -100.0], 1.004 * REST * np.array([0.8, 0.6, 0.0])])
    x[1, 2] -= 100.0
    v = np.array([[1.0, 0.5, -0.3], [1.1, 0.4, -0.3]])
    ends, order, slots = np.array([[0, 1]]), np.array([0]), np.arange(36)
    rest, rate, water = np.array([REST]), np.array([0.1]), water_of(WATER)
    total, stiffness, damping, inertia = np.zeros((2, 3)), *np.zeros((3, 36))
    none, nobody, nowhere = np.empty((2, 0, 6, 6)), np.empty((0, 3)), np.empty((0, 3, 3))
    columns = bar.columns
    add_bar_blocks(
        ends, order, x, v, rest, rate, columns, water, slots,
        total, stiffness, damping, *none, nobody,
    )  # fmt: skip
    add_bar_masses(ends, order, x, rest, columns, water, slots, inertia, nowhere)
    forces = np.zeros((2, 3))
    add_bar_forces(ends, x, v, rest, rate, columns, water, forces)
    np.testing.assert_array_equal(total, forces)
    return total, stiffness, damping, inertia


def test_two_bars_side_by_side_are_one_bar_of_twice_the_area() -> None:
    double = replace(
        BAR,
        **{
            name: 2 * getattr(BAR, name)
            for name in ('stiffness', 'mass', 'volume', 'normal_area', 'wet_area')
        },
    )
    for one, two in zip(summed(BAR), summed(double), strict=True):
        np.testing.assert_allclose(two, 2 * one, rtol=1e-12)


def test_a_bar_pulls_and_hangs_at_its_ends_as_tension_drag_and_weight_say() -> None:
    total, *_ = summed(BAR)
    here = BarMotion(
        vector=1.004 * REST * np.array([[0.8, 0.6, 0.0]]),
        stretching=np.array([[0.1, -0.1, 0.0]]),
        velocity=np.array([[1.05, 0.45, -0.3]]),
        height=np.array([-100.0]),
        rest=np.array([REST]),
        rest_rate=np.array([0.1]),
    )
    force, along = line.tension(BAR, here)
    load = line.drag(BAR, here, along, WATER)[0]
    load[2] += weight_at(3.7, BAR.volume[0], REST, 1025.0, WATER.gravity)
    np.testing.assert_allclose(total[0], force * along[0] + 0.5 * load, rtol=1e-12)
    np.testing.assert_allclose(total[1], -force * along[0] + 0.5 * load, rtol=1e-12)
