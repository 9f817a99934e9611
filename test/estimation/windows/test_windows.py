"""Steady windows: found where the gear is steady, refused with the right reason elsewhere."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.windows.finder import SteadyWindowFinder
from trawl_ros.estimation.windows.records import RejectedWindow, SteadyWindow, WindowOptions
from trawl_ros.records.samples import (
    AttitudeSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    VelocitySample,
    WinchSample,
)

# The closed-form sea settles at once; its legs are kept short.
SHORT = {'settle_s': 120.0, 'settle_passages': 0.0, 'speed_tolerance': 0.15}


def run(sea, samples, **options):
    finder = SteadyWindowFinder(sea.pressure_to_depth, WindowOptions(**{**SHORT, **options}))
    found = [item for sample in samples for item in finder.feed(sample)]
    found += finder.finish()
    return finder, [item for item in found if isinstance(item, SteadyWindow)]


@pytest.fixture
def calm(sea, model):
    """One leg that is steady all along."""
    return sea.tow(model, [sea.Leg(500.0, 2.0, 300.0)])


def is_door(sample, side='port'):
    return isinstance(sample, PressureSample) and sample.place == side


def test_means_are_those_of_the_steady_state_within_their_errors(sea, model):
    ratios = []
    for seed in range(12):
        samples = sea.tow(model, [sea.Leg(500.0, 2.0, 300.0)], seed=seed)
        # What the gear may still have to settle is no error of a mean.
        _, (window, *_) = run(sea, samples, slow_s=0.0)
        exact = model.predict(sea.TRUTH, 500.0, 500.0, 2.0).values
        ratios += [
            (window.means[name] - value) / window.noise[name]
            for name, value in zip(sea.OBSERVABLES, exact, strict=True)
            if name in window.means
        ]
    assert 0.75 < np.std(ratios) < 1.3


def test_the_gear_is_given_time_to_settle(sea, model):
    samples = sea.tow(model, [sea.Leg(400.0, 2.0, 300.0), sea.Leg(500.0, 2.0, 300.0)])
    arrived = next(s.stamp for s in samples if isinstance(s, WinchSample) and s.lengths[0] > 499.5)
    _, windows = run(sea, samples)
    second = [window for window in windows if window.means['port_length'] > 450.0]
    assert windows[0].means['port_length'] == pytest.approx(400.0, abs=0.1)
    assert second[0].start_ns >= arrived + 110 * sea.NANO
    assert second[0].state == windows[0].state + 1


def test_a_change_of_speed_starts_a_new_state(sea, model):
    _, windows = run(sea, sea.tow(model, [sea.Leg(500.0, 1.8), sea.Leg(500.0, 2.2)]))
    assert {round(window.means['speed'], 1): window.state for window in windows} == {
        1.8: 0,
        2.2: 1,
    }


def test_a_long_state_gives_several_windows_of_one_state_that_do_not_overlap(sea, model):
    samples = sea.tow(model, [sea.Leg(500.0, 2.0, 900.0)])
    finder, windows = run(sea, samples, max_windows_per_state=3)
    assert [window.state for window in windows] == [0, 0, 0]
    assert [window.index for window in windows] == [0, 1, 2]
    for before, after in itertools.pairwise(windows):
        assert before.end_ns <= after.start_ns
    assert finder.rejected['unsteady'] == 0


def test_a_bias_is_not_worn_down_by_taking_more_windows_of_a_state(sea, calm):
    _, (window, *_) = run(sea, calm)
    four = [window.std('door_spread', 4)] * 4
    assert np.sqrt(np.sum(np.square(four))) / 4 > window.bias['door_spread']


def test_arrival_order_within_the_slack_changes_nothing(sea, calm):
    finder, windows = run(sea, calm)
    assert len(windows) == 2
    for seed in range(10):
        rng = np.random.default_rng(seed)
        # Some arrive at once, some as late as the slack allows.
        late = [sample.stamp + rng.choice([0.0, 1.99e9]) for sample in calm]
        other, again = run(sea, [calm[i] for i in np.argsort(late, kind='stable')])
        assert again == windows
        assert other.rejected == finder.rejected


def test_a_window_is_decided_only_when_all_needed_channels_have_passed_its_end(sea, calm):
    finder = SteadyWindowFinder(sea.pressure_to_depth)
    spread_end = calm[0].stamp + 225 * sea.NANO
    for sample in calm:
        if isinstance(sample, RangeSample) and sample.stamp > spread_end:
            continue
        if sample.stamp > spread_end + 50 * sea.NANO:
            break
        for item in finder.feed(sample):
            assert item.end_ns <= spread_end


@pytest.mark.parametrize('bad', [math.nan, math.inf])
def test_not_finite_readings_never_enter_a_mean(sea, calm, bad):
    spoilt = [
        replace(s, distance=bad) if isinstance(s, RangeSample) and i % 4 == 0 else s
        for i, s in enumerate(calm)
    ]
    finder, windows = run(sea, spoilt)
    assert finder.rejected['not finite'] > 3
    assert windows
    assert all(math.isfinite(window.means['door_spread']) for window in windows)


@pytest.mark.parametrize(('share', 'used'), [(10, True), (2, False)])
def test_readings_out_of_range_are_refused(sea, calm, share, used):
    spreads = [i for i, s in enumerate(calm) if isinstance(s, RangeSample)]
    spoilt = list(calm)
    for i in spreads[::share]:
        spoilt[i] = replace(spoilt[i], distance=400.0, max_range=300.0)
    finder, windows = run(sea, spoilt)
    # Where many are out of range, so is the channel: what is left of it is no fair sample.
    assert finder.rejected['out of range'] == len(spreads[::share]) + (not used)
    assert bool(windows) == used


def test_outliers_are_left_out_of_the_mean(sea, calm):
    _, (clean, *_) = run(sea, calm)
    doors = [i for i, s in enumerate(calm) if is_door(s) and clean.start_ns <= s.stamp]
    spoilt = list(calm)
    for i in doors[2:5]:
        spoilt[i] = replace(spoilt[i], pressure=spoilt[i].pressure + 3e5)
    finder, (window, *_) = run(sea, spoilt)
    assert finder.rejected['outlier'] >= 3
    assert window.counts['port_door_depth'] == clean.counts['port_door_depth'] - 3
    assert window.means['port_door_depth'] == pytest.approx(clean.means['port_door_depth'], abs=0.3)


def echoed(calm, start_ns, nth, longer):
    """Samples with a spread that is ``longer`` (m) in ``nth`` of ten readings."""
    spreads = [i for i, s in enumerate(calm) if isinstance(s, RangeSample) and s.stamp >= start_ns]
    spoilt = list(calm)
    for number, i in enumerate(spreads):
        if number % 10 < nth:
            spoilt[i] = replace(spoilt[i], distance=spoilt[i].distance + longer)
    return spoilt


def test_false_echoes_cast_no_doubt_on_the_others(sea, calm):
    _, (clean, *_) = run(sea, calm)
    finder, windows = run(sea, echoed(calm, calm[0].stamp, 3, 210.0))
    assert [w.start_ns for w in windows][:1] == [clean.start_ns]
    assert finder.rejected['outlier'] >= 0.25 * clean.counts['door_spread']
    window = windows[0]
    assert window.counts['door_spread'] == pytest.approx(0.7 * clean.counts['door_spread'], abs=1)
    assert abs(window.means['door_spread'] - clean.means['door_spread']) <= 3.0 * math.hypot(
        window.noise['door_spread'], clean.noise['door_spread']
    )


@pytest.mark.parametrize(('nth', 'longer'), [(3, 15.0), (5, 210.0)])
def test_a_sensor_with_many_outliers_or_as_many_false_echoes_as_true_is_not_used(
    sea, calm, nth, longer
):
    finder, windows = run(sea, echoed(calm, calm[0].stamp, nth, longer))
    assert windows == []
    assert 'outliers in' in finder.rejections.sentences['outlier'] or (
        'false echoes in' in finder.rejections.sentences['outlier']
    )


def test_a_spike_of_the_counter_does_not_break_the_state(sea, calm):
    at = next(
        i for i, s in enumerate(calm)
        if isinstance(s, WinchSample) and s.stamp > calm[0].stamp + 100 * sea.NANO
    )  # fmt: skip
    spoilt = list(calm)
    spoilt[at] = replace(spoilt[at], lengths=(900.0, 900.0))
    finder, windows = run(sea, spoilt)
    assert windows
    assert finder.rejected['unsteady'] == 0


def test_a_frozen_sensor_is_refused(sea, calm):
    spoilt = [replace(s, pressure=2e6) if is_door(s) else s for s in calm]
    finder, windows = run(sea, spoilt)
    assert windows == []
    assert finder.rejected['frozen'] == 1


def test_an_optional_sensor_that_freezes_is_left_out(sea, calm):
    spoilt = [
        replace(s, pitch=0.1) if isinstance(s, AttitudeSample) and s.side == 'port' else s
        for s in calm
    ]
    finder, (window, *_) = run(sea, spoilt)
    assert 'port_pitch' not in window.means
    assert 'starboard_pitch' in window.means
    assert finder.rejected['frozen'] >= 1


def test_a_silent_sensor_is_a_gap(sea, calm):
    first = calm[0].stamp
    spoilt = [
        s for s in calm
        if not (is_door(s) and first + 130e9 < s.stamp < first + 290e9)
    ]  # fmt: skip
    finder, windows = run(sea, spoilt)
    assert windows == []
    assert finder.rejected['gap'] == 1


def test_a_channel_that_never_speaks_is_missing(sea, calm):
    finder, windows = run(sea, [s for s in calm if not isinstance(s, RangeSample)])
    assert windows == []
    assert finder.rejected['missing channel'] == 1


def test_a_long_gear_is_given_longer_than_a_short_one(sea, model):
    held = {}
    for length in (200.0, 900.0):
        samples = sea.tow(model, [sea.Leg(length, 2.0, 1200.0)])
        _, windows = run(sea, samples, settle_passages=1.8, settle_s=180.0)
        held[length] = (windows[0].start_ns - samples[0].stamp) / 1e9
    # The time to tow 1.8 times warp and net (200 m), to the next ten seconds of the grid.
    assert held[200.0] == pytest.approx(1.8 * 400.0 / 2.0, abs=15.0)
    assert held[900.0] == pytest.approx(1.8 * 1100.0 / 2.0, abs=15.0)


def test_turning_is_not_steady(sea, model):
    finder, windows = run(sea, sea.tow(model, [sea.Leg(500.0, 2.0, 400.0, turn=0.002)]))
    assert windows == []
    assert finder.rejected['turning'] == 1


def test_turning_is_seen_without_a_compass_too(sea, model):
    samples = sea.tow(model, [sea.Leg(500.0, 2.0, 400.0, turn=0.002)])
    finder, windows = run(sea, [s for s in samples if not isinstance(s, HeadingSample)])
    assert windows == []
    assert finder.rejected['turning'] == 1


def test_a_log_that_has_no_yaw_rate_is_no_fault(sea, calm):
    spoilt = [replace(s, yaw_rate=math.nan) if isinstance(s, VelocitySample) else s for s in calm]
    finder, windows = run(sea, spoilt)
    assert windows
    assert finder.rejected['not finite'] == 0


def test_gear_that_still_drifts_is_unsteady_though_winch_and_speed_are_held(sea, model):
    legs = [sea.Leg(400.0, 2.0, 60.0), sea.Leg(600.0, 2.0, 205.0)]
    finder = SteadyWindowFinder(sea.pressure_to_depth, WindowOptions(**SHORT))
    found = [item for s in sea.tow(model, legs, lag_s=90.0) for item in finder.feed(s)]
    details = [item.detail for item in found if isinstance(item, RejectedWindow)]
    assert any('drifts by' in detail for detail in details)
    assert not any(isinstance(item, SteadyWindow) for item in found)


def test_a_reading_later_than_the_slack_is_out_of_order(sea, calm):
    early = [i for i, s in enumerate(calm) if isinstance(s, RangeSample)][20]
    later = early + 40
    assert calm[later].stamp - calm[early].stamp < 10 * sea.NANO
    moved = [*calm[:early], *calm[early + 1 : later], calm[early], *calm[later:]]
    finder, windows = run(sea, moved)
    assert windows
    assert finder.rejected['out of order'] == 1


def test_a_hole_in_the_recording_starts_afresh(sea, model):
    samples = sea.tow(model, [sea.Leg(500.0, 2.0, 300.0)])
    later = [replace(s, stamp=s.stamp + 5000 * sea.NANO) for s in samples]
    _, windows = run(sea, [*samples, *later])
    assert len({window.state for window in windows}) == 2
    assert windows[-1].start_ns >= later[0].stamp + 110 * sea.NANO


def test_after_a_reset_the_same_samples_give_the_same_windows(sea, calm):
    finder, windows = run(sea, calm)
    finder.reset()
    assert finder.readings.total() == 0
    again = [item for s in calm for item in finder.feed(s)] + finder.finish()
    assert [item for item in again if isinstance(item, SteadyWindow)] == windows


def test_memory_is_bounded_by_a_window(sea, model):
    finder = SteadyWindowFinder(sea.pressure_to_depth)
    for sample in sea.tow(model, [sea.Leg(500.0, 2.0, 1200.0)]):
        finder.feed(sample)
    kept = finder._buffers['port_length'].window(0, 2**62)[0]
    assert len(kept) < 120


@pytest.mark.parametrize('setting', ['window_s', 'block_s', 'length_tolerance'])
def test_settings_that_make_no_sense_are_refused_by_name(setting):
    with pytest.raises(TrawlError, match=setting):
        WindowOptions(**{setting: -1.0})


@pytest.mark.parametrize('first', [0, 1_750_000_000])
def test_windows_know_how_long_the_tow_has_lasted(sea, model, first):
    samples = sea.tow(model, [sea.Leg(400.0, 2.0, 300.0), sea.Leg(500.0, 2.0, 300.0)])
    shift = first * sea.NANO - sea.EPOCH
    samples = [replace(sample, stamp=sample.stamp + shift) for sample in samples]
    _, windows = run(sea, samples)
    assert len(windows) >= 2
    for window in windows:
        middle = 0.5 * (window.start_ns + window.end_ns) - first * sea.NANO
        assert window.hours == pytest.approx(middle / (3600 * sea.NANO), abs=1e-6)
