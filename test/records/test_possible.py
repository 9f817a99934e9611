"""Readings that no instrument can give are told from those that are unknown."""

import math

import numpy as np
import pytest

from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import VelocitySample


@pytest.mark.parametrize(
    ('velocity', 'refused'),
    [
        ([2.1, 0.1, 0.0], False),
        ([2.1, math.nan, math.nan], False),
        ([61.0, 0.0, 0.0], True),
        ([math.inf, math.nan, 0.0], True),
        ([1e200, math.nan, 0.0], True),
    ],
)
def test_an_unknown_part_of_a_velocity_hides_no_impossible_one(velocity, refused):
    sample = VelocitySample(0, 'water', np.array(velocity), 0.0)
    assert bool(impossible(sample)) == refused
