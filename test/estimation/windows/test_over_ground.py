"""A log that shows speed over ground is told from one that sees the water."""

import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.windows.over_ground import OverGround, ground_track
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import HeadingSample, VelocitySample

SECOND = 1_000_000_000
STAMPS = np.arange(60) * SECOND


def track(log, heading, current, seed=0, speed=2.1, noise=0.03):
    """The ground track of a minute with a log that is 'true', 'bottom' or 'gps'."""
    draw = np.random.default_rng(seed).standard_normal
    water = speed * np.array([math.cos(heading), math.sin(heading)])
    ground = water + current + noise * draw((60, 2))
    ahead = np.array([math.cos(heading), math.sin(heading)])
    reading = {
        'true': speed + noise * draw(60),
        'bottom': (water + current) @ ahead + noise * draw(60),
        'gps': np.hypot(*ground.T),
    }[log]
    headings = heading + 0.002 * draw(60)
    return ground_track(
        (STAMPS, reading), (STAMPS, ground[:, 0]), (STAMPS, ground[:, 1]), (STAMPS, headings)
    )


def verdict(log, headings, current):
    judge = OverGround()
    found = [judge.judge(0, track(log, h, np.array(current), i)) for i, h in enumerate(headings)]
    return found[-1]


@pytest.mark.parametrize('current', [(0.0, 0.0), (0.4, 0.0), (0.0, 0.4), (-0.2, 0.3)])
def test_a_true_log_is_not_accused_in_any_current(current):
    for turn in np.linspace(0.0, 6.0, 13):
        assert verdict('true', [turn, turn + 1.0, turn + 3.0], current) is None


def test_a_log_over_ground_is_told_on_two_headings():
    assert 'no current' in verdict('bottom', [0.0, 1.5], (0.0, 0.4))


@pytest.mark.parametrize(
    ('headings', 'current'),
    [([0.0, 0.0, 0.0], (0.0, 0.4)), ([0.0, 1.5, 3.0], (0.0, 0.0))],
    ids=['one heading alone', 'no current'],
)
def test_where_a_log_over_ground_cannot_be_told_or_is_as_good_nothing_is_said(headings, current):
    assert verdict('bottom', headings, current) is None


@pytest.mark.parametrize('current', [(0.0, 0.0), (0.4, 0.0)])
def test_a_log_fed_by_gps_is_told_at_once(current):
    assert 'reading by reading' in verdict('gps', [0.0], current)


def test_what_was_found_of_one_tow_is_not_held_against_the_next():
    judge = OverGround()
    for heading in (0.0, 1.5):
        found = judge.judge(0, track('bottom', heading, np.array([0.0, 0.4])))
    assert found is not None
    assert judge.judge(0, None) == found
    assert judge.judge(1, None) is None


def test_without_gps_or_compass_nothing_is_compared():
    nothing = np.array([], dtype=np.int64), np.array([])
    some = STAMPS, np.full(60, 2.0)
    assert ground_track(some, nothing, nothing, some) is None
    assert ground_track(some, some, some, nothing) is None


def over_ground(samples):
    """The log tracks the bottom: it shows what the ship does over ground along her heading."""
    rng = np.random.default_rng(8)
    found = []
    for sample in samples:
        if isinstance(sample, HeadingSample):
            heading = sample.heading
        elif isinstance(sample, VelocitySample) and sample.over == 'ground':
            ground = sample.velocity
        elif isinstance(sample, VelocitySample):
            along = math.cos(heading) * ground[0] + math.sin(heading) * ground[1]
            along += 0.03 * rng.normal()
            sample = replace(sample, velocity=np.array([along, 0.0, 0.0]))
        found.append(sample)
    return found


def copied(samples):
    """The log's display is fed by the GPS."""
    found = []
    for sample in samples:
        if isinstance(sample, VelocitySample) and sample.over == 'ground':
            speed = math.hypot(*sample.velocity)
        elif isinstance(sample, VelocitySample):
            sample = replace(sample, velocity=np.array([speed, 0.0, 0.0]))
        found.append(sample)
    return found


@pytest.mark.parametrize('spoil', [over_ground, copied])
def test_all_windows_of_such_a_tow_are_refused_and_withdrawn(clean_tow, spoil):
    options = WindowOptions(settle_s=120.0, settle_passages=0.0)
    identification = Identification(
        clean_tow.linear, clean_tow.prior, OBSERVABLES, clean_tow.depth, options
    )
    events = [event for sample in spoil(clean_tow.samples) for event in identification.feed(sample)]
    events += identification.finish()
    assert identification.rejected['speed over ground'] >= 1
    assert 'speed over ground' in identification.found['speed over ground']
    assert events[-1].reason == 'speed over ground'
    assert identification.course == []
    assert identification.estimate is None
