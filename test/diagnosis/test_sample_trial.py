"""The synthetic trial that comes with the package, cut off: nothing is missing in it."""

import pytest

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.resources import share_path
from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.estimation.from_gear import finder_for
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.records.topics import NAMESPACE


@pytest.fixture(scope='module')
def cut_off():
    """Windows of its first so many minutes."""
    finder, began, windows = finder_for(load_gear('kaifuha')), None, []
    for _, sample in SampleStream([share_path('bags', 'sea_trial')], NAMESPACE):
        began = sample.stamp if began is None else began
        if sample.stamp - began > 125 * 60 * SECOND:
            break
        windows += [w for w in finder.feed(sample) if isinstance(w, SteadyWindow)]
    return lambda minutes: [w for w in windows if w.end_ns - began < minutes * 60 * SECOND]


@pytest.mark.parametrize('minutes', [52, 78, 125])
def test_a_spread_sensor_that_errs_anew_in_each_state_is_no_discrepancy(cut_off, minutes):
    # Three to six states: calibration alone would not explain them.
    found = diagnose_windows(load_gear('kaifuha'), cut_off(minutes), ['sea trial'])
    assert found.verdict == 'NO_DISCREPANCY', found.reason
    assert found.posterior.nothing > 0.1
