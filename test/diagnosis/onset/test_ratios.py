"""The rarity of a likelihood ratio is that of a χ²."""

import numpy as np
import pytest
from scipy.stats import chi2

from trawl_ros.diagnosis.onset.ratios import NEAR, rarity


@pytest.mark.parametrize('ratio', [-3.0, 0.0, 0.3, 5.0, 100.0, 1400.0, 1e5])
def test_a_ratio_is_as_rare_as_chi_squared(ratio):
    for freedom in (1, 2, 4):
        expected = -chi2.logsf(ratio, freedom) / np.log(10.0)
        assert rarity(ratio, freedom) == pytest.approx(expected, rel=1e-12)


def test_what_is_near_is_within_the_95_percent_of_one_value():
    assert pytest.approx(chi2.ppf(0.95, 1)) == NEAR
