"""Doubts about assumed numbers: factors that a point needs are read between those tried."""

import pytest

from trawl_ros.lab.report.doubts import factors_needed, need_in_words


def test_the_range_nearest_to_one_is_found_between_the_factors_tried() -> None:
    values = {0.5: 12.0, 1.0: 10.0, 2.0: 30.0}
    assert factors_needed(values, 15.0, 0.1) == pytest.approx((1.175, 1.325), abs=1e-3)
    assert need_in_words(values, 15.0, 0.1).startswith('× 1.17')


def test_what_is_not_reached_or_not_found_is_not_enough() -> None:
    assert factors_needed({0.5: 20.0, 1.0: 10.0}, 50.0, 0.1) is None
    assert need_in_words({0.5: float('nan'), 1.0: 10.0}, 15.0, 0.1) == 'not enough'
    assert need_in_words({1.0: 10.0, 2.0: 20.0}, 15.0, 0.1) == '× 1.35 to 1.65'
