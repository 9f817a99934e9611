"""Small mathematics: exact under a complex step and right as plain functions."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from trawl_ros.model.numerics import STEP, length, skew
from trawl_ros.model.rotations import rotation, rotation_vector


@pytest.mark.parametrize('size', [0.0, 1e-9, 1e-4, 1.1e-4, 0.3, 3.1, 10.0])
def test_rotation_is_that_of_its_vector(size: float) -> None:
    vector = size * np.array([0.48, -0.6, 0.64])
    np.testing.assert_allclose(
        rotation(vector), Rotation.from_rotvec(vector).as_matrix(), atol=1e-14
    )


@pytest.mark.parametrize('size', [0.0, 1e-9, 0.3, 2.0, 3.0, np.pi - 1e-6])
def test_rotation_vector_is_the_inverse_of_rotation(size: float) -> None:
    axes = np.random.default_rng(2).normal(size=(20, 3))
    vectors = size * axes / np.linalg.norm(axes, axis=1)[:, None]
    np.testing.assert_allclose(rotation_vector(rotation(vectors)), vectors, atol=1e-14)


def test_rotation_of_an_imaginary_step_is_the_skew_matrix() -> None:
    vector = np.array([0.2, -0.5, 0.9])
    np.testing.assert_array_equal(rotation(1j * STEP * vector).imag / STEP, skew(vector))


def test_skew_is_the_cross_product() -> None:
    a, b = np.random.default_rng(0).normal(size=(2, 7, 3))
    np.testing.assert_allclose(np.einsum('kij,kj->ki', skew(a), b), np.cross(a, b), atol=1e-14)


def test_length() -> None:
    a = np.array([1.0, 2.0, 3.0])
    assert length(np.zeros(3), 1e-6) == pytest.approx(1e-6)
    assert (length(a + 1j * STEP * a).imag / STEP) == pytest.approx(np.sqrt(14.0))
