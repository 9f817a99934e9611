"""The depth of the water in a window is the median of its soundings."""

import math

import pytest

from trawl_ros.estimation.windows.sounder import Sounder
from trawl_ros.records.samples import RangeSample


def sounding(second, depth, what='depth'):
    return RangeSample(second * 1_000_000_000, what, depth, 0.1, 0.5, 1000.0)


def test_a_window_has_the_median_of_its_soundings():
    sounder = Sounder()
    for second, depth in enumerate([200.0, 210.0, math.inf, 212.0, 900.0, 250.0]):
        sounder.add(sounding(second, depth))
    # A distance to fish is none to the ground.
    sounder.add(sounding(1, 5.0, 'school'))
    assert sounder.depth(1_000_000_000, 5_000_000_000) == pytest.approx(212.0)
    assert sounder.depth(7_000_000_000, 9_000_000_000) is None
