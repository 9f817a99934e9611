"""Readings of a tow: false echoes, leaping counters, means of stretches, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.motion import stretches
from trawl_ros.estimation.motion.parts import parts_of
from trawl_ros.estimation.motion.series import (
    Series,
    payout_by_counter,
    series_of,
    tow_readings,
)
from trawl_ros.estimation.motion.stretches import (
    StretchOptions,
    moving_tow,
    warp_path,
)
from trawl_ros.estimation.motion.towing.linearisation import SLOW_MOTIONS
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.samples import (
    AttitudeSample,
    PressureSample,
    VelocitySample,
    WinchSample,
)

AT_REST = StretchOptions(settling_s=0.0)


def test_false_echoes_are_set_aside_at_the_beginning_too():
    rng, times = np.random.default_rng(4), np.arange(0.0, 300.0, 3.0)
    values = 90.0 + 0.05 * times + 0.4 * rng.standard_normal(100)
    values[[0, 1, 40, 99]] += 210.5
    values[60] += 4.0
    series = series_of(CHANNELS['door_spread'], times, values, 0.4)
    assert series.excluded == 5
    assert not set(series.times) & {0.0, 3.0, 120.0, 180.0, 297.0}
    assert series.noise == pytest.approx(0.4, rel=0.2)


def test_the_start_of_a_haul_is_no_outlier():
    rng, times = np.random.default_rng(5), np.arange(0.0, 60.0, 0.5)
    values = 9e4 + 3e4 * np.clip((times - 30.0) / 4.0, 0.0, 1.0)
    values += 1600.0 * rng.standard_normal(len(times))
    assert series_of(CHANNELS['port_tension'], times, values, 500.0).excluded == 0


@pytest.mark.parametrize('period', [6.0, 8.0, 9.3, 10.0, 12.0])
def test_peaks_of_a_swell_that_are_read_once_a_second_are_no_outliers(period):
    rng, times = np.random.default_rng(6), np.arange(0.0, 660.0)
    values = 1.6e5 + 1.1e4 * np.sin(2.0 * np.pi * times / period)
    values += 300.0 * rng.standard_normal(len(times))
    assert series_of(CHANNELS['port_tension'], times, values, 500.0).excluded == 0


def test_outliers_are_set_aside_where_they_are_many():
    rng, times = np.random.default_rng(6), np.arange(0.0, 660.0)
    values = 1.6e5 + 1600.0 * rng.standard_normal(len(times))
    wrong = np.flatnonzero(rng.random(len(times)) < 0.15)
    values[wrong] += 4e4
    series = series_of(CHANNELS['port_tension'], times, values, 500.0)
    assert series.excluded >= 0.95 * len(wrong)
    assert set(np.delete(times, wrong)) <= set(series.times)


def test_a_counter_that_leaps_while_its_winch_stands_moves_no_warp():
    times, grid = np.arange(0.0, 400.0, 0.5), np.arange(0.0, 400.0)
    speed = np.where((times > 100.0) & (times <= 200.0), -0.4, 0.0)
    true = 500.0 + np.cumsum(speed) * 0.5
    counter = true + np.where(times < 300.0, 0.4, -0.4)
    lengths, rates = warp_path(Series(times, counter), Series(times, speed), grid)
    standing = (grid < 95.0) | (grid > 205.0)
    assert np.abs(rates[standing]).max() < 0.01
    wrong = lengths - np.interp(grid, times, true)
    assert np.abs(wrong).max() < 0.6
    np.testing.assert_allclose(np.gradient(lengths, grid)[5:95], rates[5:95], atol=1e-3)


def test_counters_tell_how_warps_run_where_no_winch_tells():
    rng, times, grid = (
        np.random.default_rng(6),
        np.arange(0.0, 600.0, 0.5),
        np.arange(0.0, 590.0),
    )
    speed = (
        -0.4 * np.clip((times - 200.0) / 4.0, 0.0, 1.0) * np.clip((330.0 - times) / 4.0, 0.0, 1.0)
    )
    true = 500.0 + np.cumsum(speed) * 0.5
    leaps = np.where(times < 200.0, 0.5, np.where(times < 420.0, -0.5, 0.4))
    read = np.round(true + leaps + 0.05 * rng.standard_normal(len(times)), 1)
    payout = payout_by_counter(Series(times, read))
    lengths, rates = warp_path(Series(times, read), payout, grid)
    standing = (grid < 190.0) | (grid > 345.0)
    assert np.abs(rates[standing]).max() < 0.02
    assert np.median(rates[(grid > 220.0) & (grid < 320.0)]) == pytest.approx(-0.4, abs=0.02)
    assert np.abs(lengths - np.interp(grid, times, true)).max() < 1.5


def samples(duration_s=400.0, payout=0.0, silent=(0.0, 0.0)):
    for second in np.arange(0.0, duration_s + 1.0):
        stamp = round((50.0 + second) * SECOND)
        yield WinchSample(stamp, (500.0, 500.0), (payout, payout), (9e4 + second, 9e4))
        if not silent[0] < second < silent[1]:
            speed = 2.2 + 0.01 * np.sin(second)
            yield VelocitySample(stamp, 'water', np.array([speed, 0.0, 0.0]), 0.0)
        yield PressureSample(stamp, 'port', 1e6 + 1e3 * second, 2e3)


def tow_of(*args, **kwargs):
    return moving_tow(
        tow_readings(samples(*args, **kwargs), lambda p: 1e-4 * p, 'bag'), 'bag', AT_REST
    )


def test_means_have_the_weights_of_their_readings():
    tow = tow_of()
    assert tow.channels == ('port_tension', 'starboard_tension', 'port_door_depth')
    assert tow.means.shape == (20, 3)
    instants = np.arange(11) * tow.step_s
    for stretch in (0, 7):
        course = 9e4 + stretch * tow.stretch_s + instants
        assert tow.weights[stretch, 0] @ course == pytest.approx(tow.means[stretch, 0])
    assert np.all(tow.counts == 20)
    np.testing.assert_allclose(tow.inputs.values[:, :2], 500.0)
    assert [knots.channel for knots in tow.inputs.knots] == [
        'speed',
        'port_length',
        'starboard_length',
    ]


def test_the_beginning_does_not_count_where_what_was_before_is_not_known():
    read = tow_readings(samples(700.0), lambda p: 1e-4 * p, 'bag')
    tow = moving_tow(read, 'bag', StretchOptions())
    assert np.all(np.isnan(tow.means[:15]))
    assert np.all(np.isfinite(tow.means[15:]))
    assert tow.left_out[0].end == 300.0


@pytest.mark.parametrize(
    ('changes', 'words'),
    [
        ({'silent': (100.0, 160.0)}, 'bag: speed .* 90 s, .* 10 s'),
        ({'silent': (-1.0, 1e9)}, 'bag: .* 15 .* speed'),
        ({'duration_s': 150.0}, 'bag: lasts 150 s, .* 200 s'),
    ],
)  # fmt: skip
def test_what_cannot_be_towed_along_is_refused(changes, words):
    with pytest.raises(TrawlError, match=words):
        tow_of(**changes)


def test_stretches_are_steady_once_inputs_are_held_as_long_as_a_window_needs():
    read = tow_readings(samples(1100.0), lambda p: 1e-4 * p, 'bag')
    tow = moving_tow(read, 'bag', AT_REST)
    settle = 1.8 * (500.0 + 200.0) / 2.2 + 60.0
    assert list(np.flatnonzero(tow.steady)) == [*range(int(settle / 20.0), len(tow))]
    np.testing.assert_allclose(tow.held_s[tow.steady], settle, rtol=0.02)
    assert tow.starts == 2 * SLOW_MOTIONS
    moved = moving_tow(
        tow_readings(samples(1100.0, payout=0.05), lambda p: 1e-4 * p, 'bag'), 'bag', AT_REST
    )
    assert not moved.steady.any()


def test_a_tow_that_is_too_long_is_refused(monkeypatch):
    monkeypatch.setattr(stretches, 'LONGEST_S', 300.0)
    with pytest.raises(TrawlError, match=r'bag: lasts 400 s, .* 300 s'):
        tow_of()


def test_tows_of_other_steps_have_the_same_means():
    read = tow_readings(samples(), lambda p: 1e-4 * p, 'bag')
    fine = moving_tow(read, 'bag', replace(AT_REST, step_s=0.5))
    assert fine.steps == 40
    np.testing.assert_array_equal(fine.means, moving_tow(read, 'bag', AT_REST).means)


def falling(roll, begin, end, *, side='port', silent=(0.0, 0.0)):
    """Samples of ten minutes in which a board rolls so far (rad) between two times, else 0.1."""
    yield from samples(600.0, silent=silent)
    for second in np.arange(0.0, 600.0, 2.0):
        own = roll if begin <= second < end else 0.1
        yield AttitudeSample(round((50.0 + second) * SECOND), side, 0.0, own, 0.01)


def fallen(*args, **kwargs):
    read = tow_readings(falling(*args, **kwargs), lambda p: 1e-4 * p, 'bag')
    return moving_tow(read, 'bag', AT_REST)


@pytest.mark.parametrize('side', ['port', 'starboard'])
def test_stretches_in_which_a_board_swings_over_are_told(side):
    # Outliers among their neighbours, and beyond what the channel may have, as they are.
    tow = fallen(2.7, 206.0, 216.0, side=side)
    assert tow.fallen == (10,)
    assert fallen(2.7, 206.0, 228.0, side=side).fallen == (10, 11)


@pytest.mark.parametrize(
    ('roll', 'begin', 'end'),
    [(0.1, 0.0, 0.0), (2.7, 206.0, 210.0), (-0.8, 206.0, 226.0), (-8.0, 206.0, 226.0),
     (2.7, 0.0, 400.0), (np.nan, 206.0, 226.0)],
    ids=['stands', 'glitch', 'leans', 'no angle', 'mounted otherwise', 'no reading'],
)  # fmt: skip
def test_what_is_no_fall_is_not_told(roll, begin, end):
    tow = fallen(roll, begin, end)
    assert tow.fallen == ()


def test_a_fall_stays_where_it_was_when_a_tow_is_divided():
    read = tow_readings(
        falling(2.7, 406.0, 416.0, silent=(100.0, 160.0)), lambda p: 1e-4 * p, 'bag'
    )
    parts = parts_of(read, 60.0)
    assert [moving_tow(part, 'bag', AT_REST).fallen for part in parts[1:]] == [(11,)]
