"""The twelve quantities say what the board's laws themselves say."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.fit.laws import (
    QUANTITIES,
    WorkingAngles,
    law_quantities,
    law_spans,
    working_angles,
)
from trawl_ros.model.board_laws import EQ14
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES, Observables

ANGLES = WorkingAngles(attack=np.radians(19.0), slip=np.radians(-4.0))


@pytest.fixture
def covariance() -> np.ndarray:
    root = np.random.default_rng(1).normal(size=(12, 12))
    return 0.01 * root @ root.T


def test_values_are_those_of_the_law_at_the_working_angle(sea, covariance):
    found = law_quantities(EQ14, sea.TRUTH, covariance, ANGLES)
    law = EQ14(sea.TRUTH, np.array(ANGLES.attack), np.array(ANGLES.slip))
    assert found.values[:6] == pytest.approx(law, rel=1e-12)


def test_slopes_are_the_change_from_15_to_30_degrees(sea, covariance):
    found = law_quantities(EQ14, sea.TRUTH, covariance, ANGLES)
    ends = EQ14(sea.TRUTH, np.radians([15.0, 30.0]), np.radians([15.0, 30.0]))
    assert found.values[6:] == pytest.approx(ends[1] - ends[0], rel=1e-9)
    assert found.span == pytest.approx(np.abs(np.tile(ends[1] - ends[0], 2)), rel=1e-9)


def test_standard_deviations_are_those_of_laws_drawn_at_random(sea, covariance):
    # So little that no drag becomes negative, which the law does not allow.
    covariance = 0.01 * covariance
    draws = np.random.default_rng(2).multivariate_normal(sea.TRUTH, covariance, 20_000)
    rows = np.array([law_quantities(EQ14, one, covariance, ANGLES).values for one in draws])
    found = law_quantities(EQ14, sea.TRUTH, covariance, ANGLES)
    assert found.sd == pytest.approx(rows.std(axis=0), rel=0.03)


def test_a_fifth_of_the_span_is_the_limit(sea):
    slopes = [COEFFICIENTS.index(name) for name in ('a1', 'a2', 'b3', 'a4', 'b5', 'a6')]
    std = np.full(12, 1e-6)
    std[slopes] = 0.2 * np.abs(sea.TRUTH[slopes]) * np.array([0.99, 1.01] * 3)
    found = law_quantities(EQ14, sea.TRUTH, np.diag(std**2), ANGLES)
    assert found.well_known[6:].tolist() == [True, False] * 3
    assert len(QUANTITIES) == len(found.values)


def test_a_law_without_slope_spans_nothing_unless_its_slope_is_uncertain(sea):
    flat = sea.TRUTH.copy()
    flat[COEFFICIENTS.index('b3')] = 0.0
    at = QUANTITIES.index('C_z^F slope')
    assert np.isinf(law_quantities(EQ14, flat, np.eye(12), ANGLES).ratio[at])
    span = law_spans(EQ14, flat, ANGLES, np.full(12, 0.4))
    assert span[at] == pytest.approx(0.4 * np.radians(15.0))
    assert law_quantities(EQ14, flat, np.eye(12), ANGLES, span).ratio[at] == pytest.approx(2.5)


def test_working_angles_are_means_over_boards_and_states():
    still = Observables(*np.zeros(len(OBSERVABLES)))
    seen = [
        replace(still, port_attack=0.2, starboard_attack=0.4, port_slip=0.1, starboard_slip=0.1),
        replace(still, port_attack=0.5, starboard_attack=0.5, port_slip=0.0, starboard_slip=0.2),
    ]
    found = working_angles(seen)
    assert (found.attack, found.slip) == pytest.approx((0.4, 0.1))
