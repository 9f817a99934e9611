"""A bag comes back as the quantities that went into it."""

import numpy as np
import pytest

from trawl_ros.core.errors import BagError
from trawl_ros.model.water import Water
from trawl_ros.plots import bag_messages
from trawl_ros.plots.reading import read_history


def test_flawless_readings_lie_on_truth(tow):
    for name in (
        'port_length', 'starboard_tension', 'port_door_depth', 'starboard_door_depth',
        'door_spread', 'port_pitch', 'starboard_roll', 'net_depth', 'opening_height',
        'speed_water', 'speed_ground', 'heading',
    ):  # fmt: skip
        truth, measured = tow.truth[name], tow.measured[name]
        expected = np.interp(measured.times, truth.times, truth.values)
        np.testing.assert_allclose(measured.values, expected, atol=1e-3, err_msg=name)


def test_depths_are_those_of_the_water(bag, tow, known):
    assert tow.measured['port_door_depth'].at(60.0) == pytest.approx(66.0, abs=1e-3)
    heavy = read_history(bag, Water(density=1060.0).depth, 'trawl')
    assert heavy.measured['port_door_depth'].at(60.0) == pytest.approx(66.0 * 1025 / 1060, abs=1e-2)


def test_times_count_from_the_first_stamp(tow, known):
    assert (tow.start, tow.duration_s) == (known.START, known.DURATION_S)
    assert tow.truth['heading'].times[0] == 0.0


def test_the_heading_has_no_jump_where_it_passes_west(tow):
    for series in (tow.truth['heading'], tow.measured['heading']):
        assert np.abs(np.diff(series.values)).max() < np.radians(1.0)
        assert np.ptp(series.values) == pytest.approx(np.radians(30.0), abs=1e-3)


def test_what_is_not_in_the_bag_is_not_there(readings_only):
    tow = read_history(readings_only, Water().depth, 'trawl')
    assert not tow.truth
    assert 'opening_height' not in tow.measured


def test_a_long_series_is_thinned_evenly_and_said(bag, monkeypatch):
    monkeypatch.setattr(bag_messages, 'MOST_MESSAGES', 50)
    tow = read_history(bag, Water().depth, 'trawl')
    times = tow.measured['door_spread'].times
    assert len(times) <= 50
    np.testing.assert_allclose(np.diff(times), 3.0)
    assert any(p.startswith('door/spread: one of 3 of its 121') for p in tow.problems)
    assert not any('truth' in problem for problem in tow.problems)


def test_a_bag_logged_late_keeps_the_times_of_its_stamps(known, tmp_path):
    late = known.write(tmp_path / 'late', log_lag_s=3.0)
    tow = read_history(late, Water().depth, 'trawl')
    assert tow.log_lag == 3_000_000_000
    assert tow.start == known.START


def test_a_bag_with_nothing_to_draw_says_what_is_missing(bag):
    with pytest.raises(BagError, match=f'{bag}.*none of the topics'):
        read_history(bag, Water().depth, 'elsewhere')
