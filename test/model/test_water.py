"""Density, pressure and current as functions of depth."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from trawl_ros.model.numerics import STEP
from trawl_ros.model.water import ATMOSPHERE_PA, Water


@pytest.mark.parametrize('gradient', [0.0, 1e-9, 0.02])
def test_depth_is_the_inverse_of_pressure(gradient: float) -> None:
    water = Water(density_gradient=gradient)
    for depth in (0.0, 1.0, 150.0, 900.0):
        assert water.depth(water.pressure(depth)) == pytest.approx(depth, rel=1e-9, abs=1e-6)


def test_pressure_is_the_weight_of_the_column_above() -> None:
    water = Water(density=1024.0, density_gradient=0.03)
    column, _ = quad(lambda depth: water.density_at(-depth) * water.gravity, 0.0, 400.0)
    assert water.pressure(400.0) == pytest.approx(ATMOSPHERE_PA + column, rel=1e-12)


def test_density_grows_downward_from_its_surface_value() -> None:
    water = Water(density=1024.0, density_gradient=0.02)
    np.testing.assert_allclose(water.density_at(np.array([0.0, -100.0])), [1024.0, 1026.0])


def test_the_current_meets_its_levels_and_stays_beyond_them(rich_water: Water) -> None:
    found = rich_water.current(-rich_water.depths)
    np.testing.assert_allclose(found[:, :2], rich_water.currents, atol=1e-15)
    np.testing.assert_array_equal(found[:, 2], 0.0)
    np.testing.assert_array_equal(
        rich_water.current(np.array([-1000.0, -400.0]))[0],
        rich_water.current(np.array([-400.0]))[0],
    )


def test_the_current_does_not_overshoot_between_levels(rich_water: Water) -> None:
    for (low, high), (a, b) in zip(
        np.stack([rich_water.depths[:-1], rich_water.depths[1:]], 1),
        np.stack([rich_water.currents[:-1], rich_water.currents[1:]], 1),
        strict=True,
    ):
        between = rich_water.current(-np.linspace(low, high, 50))[:, :2]
        assert (between >= np.minimum(a, b) - 1e-12).all()
        assert (between <= np.maximum(a, b) + 1e-12).all()


@pytest.mark.parametrize('number', [2, 3, 4, 9])
def test_its_cubics_are_those_of_scipy(number: int) -> None:
    rng = np.random.default_rng(number)
    for flat in (1.0, 0.0):
        depths = np.cumsum(rng.uniform(0.1, 80.0, number))
        currents = rng.normal(size=(number, 2))
        # Levels of one current, steep ends and turns are where its slopes are cut.
        currents[1:3] *= flat
        found = Water(depths=depths, currents=currents).profile[1][:-1]
        expected = PchipInterpolator(depths, currents).c.transpose(1, 2, 0)
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-13)


def test_its_slope_is_its_derivative(rich_water: Water) -> None:
    z = -np.linspace(1.0, 450.0, 300)
    slope = rich_water.current_slope(z)
    h = 1e-4
    difference = (rich_water.current(z + h) - rich_water.current(z - h)) / (2 * h)
    np.testing.assert_allclose(slope, difference, atol=1e-7)
    np.testing.assert_allclose(rich_water.current(z + 1j * STEP).imag / STEP, slope, rtol=1e-14)


def test_no_levels_mean_still_water_and_one_level_a_uniform_current() -> None:
    z = np.array([0.0, -300.0])
    np.testing.assert_array_equal(Water().current(z), np.zeros((2, 3)))
    one = Water(depths=np.array([50.0]), currents=np.array([[0.3, -0.2]]))
    np.testing.assert_array_equal(one.current(z), [[0.3, -0.2, 0.0]] * 2)
    np.testing.assert_array_equal(one.current_slope(z), np.zeros((2, 3)))
