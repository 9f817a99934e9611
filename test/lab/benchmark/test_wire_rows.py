"""The rows on one wire, on a short manoeuvre, and how the longest good step is found."""

import math
import sys

import numpy as np
import pytest

from trawl_ros.lab.benchmark.wire import fastest, measure
from trawl_ros.lab.reference_codes.absent import PeerFailed
from trawl_ros.lab.reference_codes.manoeuvre import History
from trawl_ros.lab.report.measured import at_least


def history(error: float, seconds: float = 0.1) -> History:
    times = np.linspace(0.0, 10.0, 11)
    return History(times, np.full(11, 100.0 * (1.0 + error)), np.full(11, 4e4), seconds)


def test_the_longest_step_within_one_percent_is_taken() -> None:
    def run(step: float) -> History:
        if step > 3.0:
            raise PeerFailed('too long')
        return history(0.004 * step**2)

    found = fastest(run, (4.0, 3.0, 2.0, 1.5, 1.0), history(0.0), quick=False)
    assert found is not None
    assert found.step == 1.5
    assert found.error == pytest.approx(0.009)
    assert found.factor == pytest.approx(100.0)


def test_the_factor_is_the_median_of_repeats() -> None:
    seconds = iter((0.1, 0.2, 0.5, 0.2, 0.1))
    found = fastest(lambda step: history(0.0, next(seconds)), (1.0,), history(0.0), quick=False)
    assert found is not None
    assert found.factor == pytest.approx(50.0)


def test_no_step_that_is_good_gives_none() -> None:
    assert fastest(lambda step: history(0.5), (2.0, 1.0), history(0.0), quick=True) is None


def test_both_programs_are_faster_than_real_time_and_the_ratio_is_theirs() -> None:
    pytest.importorskip('moordyn')
    own, peer, ratio = measure(quick=True).rows
    assert min(own.value, peer.value) > 20.0
    assert ratio.value == pytest.approx(own.value / peer.value)
    assert ratio.target == at_least(1.5)
    assert ratio.ok or 'a step takes' in ratio.note


def test_without_moordyn_the_row_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, 'moordyn', None)
    missing = measure(quick=True).rows[-1]
    assert math.isnan(missing.value)
    assert 'pip install' in missing.note
