"""The rarity of a likelihood ratio is that of a χ²."""

import numpy as np
import pytest
from scipy.stats import chi2

from trawl_ros.diagnosis.onset.ratios import NEAR, rarity


@pytest.mark.parametrize('ratio', [-3.0, 0.0, 1e-6, 0.3, 5.0, 100.0, 1400.0])
def test_a_ratio_is_as_rare_as_chi_squared(ratio):
    for freedom in (1, 2, 3, 4, 7):
        expected = -chi2.logsf(ratio, freedom) / np.log(10.0)
        assert rarity(ratio, freedom) == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_what_is_rarer_than_the_smallest_number_still_has_its_rarity():
    # Of two degrees of freedom it is exponential; of more the same ratio is less rare.
    assert rarity(1e5, 2) == pytest.approx(5e4 / np.log(10.0), rel=1e-12)
    rarities = [rarity(1e5, freedom) for freedom in (1, 2, 3, 4, 7)]
    assert rarities == sorted(rarities, reverse=True)
    assert np.ptp(rarities) < 20.0


def test_what_is_near_is_within_the_95_percent_of_one_value():
    assert pytest.approx(chi2.ppf(0.95, 1)) == NEAR
