"""Tows read apart from each other count as if they had been read one after another."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.tows import FoundWindows, estimate_tows, numbered, require_distinct
from trawl_ros.estimation.windows.finder import SteadyWindowFinder
from trawl_ros.estimation.windows.records import Rejections, SteadyWindow, WindowOptions

OPTIONS = WindowOptions(settle_s=120.0, settle_passages=0.0, speed_tolerance=0.15)


@pytest.fixture
def trials(sea, model):
    legs = [[sea.Leg(x, u, 220.0) for x in (300.0, 600.0)] for u in (1.8, 2.2)]
    return [sea.tow(model, part, seed) for seed, part in enumerate(legs)]


def find(sea, samples, name):
    finder = SteadyWindowFinder(sea.pressure_to_depth, OPTIONS)
    found = [item for sample in samples for item in finder.feed(sample)] + finder.finish()
    windows = tuple(item for item in found if isinstance(item, SteadyWindow))
    return FoundWindows(name, windows, finder.arrived, finder.readings, finder.rejections, None, ())


def make(sea, model, prior):
    return Identification(model, prior, sea.OBSERVABLES, sea.pressure_to_depth, OPTIONS)


def test_windows_states_and_tows_are_numbered_through(sea, trials):
    found = [find(sea, samples, name) for samples, name in zip(trials, 'ab', strict=True)]
    windows, names = numbered(
        [*found, FoundWindows('none', (), {}, {}, Rejections(), 'no windows', ()), found[0]]
    )
    number = len(found[0].windows)
    assert number >= 2
    assert [window.index for window in windows] == list(range(len(windows)))
    assert [names[window.tow] for window in windows] == ['a'] * number + ['b'] * number + [
        'a'
    ] * number
    states = [window.state for window in windows]
    assert sorted(set(states)) == list(range(3 * len({w.state for w in found[0].windows})))


def test_a_recording_that_is_given_twice_is_refused(sea, trials):
    found = [find(sea, samples, name) for samples, name in zip(trials, 'ab', strict=True)]
    empty = FoundWindows('none', (), {}, {}, Rejections(), 'no windows', ())
    require_distinct([*found, empty, empty])
    with pytest.raises(TrawlError, match=r'^a and a copy '):
        require_distinct([*found, replace(found[0], name='a copy')])


def test_reading_apart_gives_what_one_stream_gives(sea, model, prior, trials):
    apart = make(sea, model, prior)
    taken = []
    estimate_tows(
        apart,
        [find(sea, samples, 'tow') for samples in trials],
        taken.append,
    )
    stream = make(sea, model, prior)
    for samples in trials:
        for sample in samples:
            stream.feed(sample)
        stream.next_tow()
    stream.finish()
    assert apart.estimate.windows == stream.estimate.windows == len(taken) == taken[-1].done
    np.testing.assert_array_equal(apart.estimate.values, stream.estimate.values)
    np.testing.assert_array_equal(apart.estimate.covariance, stream.estimate.covariance)
    assert [bias.tow for bias in apart.estimate.tow_biases] == [
        bias.tow for bias in stream.estimate.tow_biases
    ]
    assert len(apart.course) == len(stream.course)


def test_what_each_refused_is_summed(sea, model, prior, trials):
    found = [find(sea, samples, 'tow') for samples in trials]
    for part in found:
        part.rejections.add('outlier', f'{part.name} has outliers', 3)
    identification = make(sea, model, prior)
    estimate_tows(identification, found)
    assert identification.rejected['outlier'] == 6
    assert identification.found['outlier'] == 'tow has outliers'
    assert identification.missing_channels() == ()
