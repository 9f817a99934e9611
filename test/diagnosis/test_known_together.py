"""Of two values that only show together the sum or the difference is given."""

import numpy as np
import pytest

from trawl_ros.diagnosis.report.common_units import in_common_unit
from trawl_ros.diagnosis.report.known_together import sharper


def test_the_difference_is_sharp_where_both_go_together():
    covariance = np.array([[4.0, 3.99], [3.99, 4.0]])
    value, std, word = sharper(np.array([-0.9, -2.3]), covariance, 0, 1)
    assert (value, word) == (pytest.approx(1.4), 'less')
    assert std == pytest.approx(np.sqrt(0.02))
    _, _, word = sharper(np.array([1.0, 1.0]), -covariance + 8.0 * np.eye(2), 0, 1)
    assert word == 'and'


def test_numbers_without_a_unit_are_in_percent_and_exponents_are_not():
    assert in_common_unit(0.863, 0.843, 0.884, '', 'factor', 1.0) == '-13.7 % (-15.7 to -11.6)'
    assert in_common_unit(0.02, 0.0, 0.1, '', 'exponent') == '0.02 (0 to 0.1)'
    assert in_common_unit(1.0, 0.5, 1.5, 'm/s per 100 m').startswith('1.94 knots per 100 m (')


def test_forces_are_in_tonnes_and_light_ones_in_kilograms():
    assert in_common_unit(9806.65, 4903.3, 19613.3, 'N') == '1 t (0.5 to 2)'
    assert in_common_unit(98.0665, 49.0, 196.0, 'N').startswith('10 kg (')
