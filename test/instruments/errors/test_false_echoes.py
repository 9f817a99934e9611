"""False echoes are as frequent, as long and as much in runs as they are said to be."""

import numpy as np
import pytest
from pydantic import ValidationError

from trawl_ros.instruments.errors.channel import ErrorChannel, ErrorModel
from trawl_ros.instruments.errors.random_processes import FalseEchoes, FalseEchoModel
from trawl_ros.instruments.parameters import RangeParameters

RANGE = {'rate_hz': 1.0, 'min_range_m': 1.0, 'max_range_m': 400.0}


def drawn(model, n=50_000, seed=4, value=20.0):
    echoes = FalseEchoes(model, np.random.default_rng(seed))
    return np.array([echoes.draw(value) for _ in range(n)])


def test_reflections_come_a_longer_way_and_never_a_shorter_one():
    longer = drawn(FalseEchoModel(0.05, 6.0))
    assert longer.min() == 0.0
    false = longer[longer > 0]
    assert len(false) / len(longer) == pytest.approx(0.05, rel=0.06)
    assert (false.mean(), false.std()) == pytest.approx((6.0, 6.0), rel=0.06)


def test_an_ambiguous_range_is_one_period_too_long():
    longer = drawn(FalseEchoModel(0.09, 210.0, ambiguous=True))
    assert set(np.unique(longer)) == {0.0, 210.0}
    assert np.mean(longer > 0) == pytest.approx(0.09, rel=0.05)


def test_an_echo_of_an_echo_is_twice_as_long_whatever_the_distance():
    for value in (15.0, 150.0):
        longer = drawn(FalseEchoModel(0.03, multiple=2.0), value=value)
        assert set(np.unique(longer)) == {0.0, value}
        assert np.mean(longer > 0) == pytest.approx(0.03, rel=0.1)


def test_runs_have_the_mean_length_at_the_same_share():
    on = drawn(FalseEchoModel(0.1, 1.0, run=4.0)) > 0
    begins = np.count_nonzero(on[1:] & ~on[:-1])
    assert on.mean() == pytest.approx(0.1, rel=0.1)
    assert on.sum() / begins == pytest.approx(4.0, rel=0.1)
    # One after another by chance alone where no run is asked for.
    alone = drawn(FalseEchoModel(0.1, 1.0)) > 0
    assert np.mean(alone[1:][alone[:-1]]) == pytest.approx(0.1, rel=0.15)


@pytest.mark.parametrize(('share', 'longer'), [(0.0, 0.0), (1.0, 3.0)])
def test_none_and_all(share, longer):
    assert (drawn(FalseEchoModel(share, 3.0, ambiguous=True), 100) == longer).all()


def test_false_echoes_leave_the_other_draws_as_they_were():
    plain, false = (
        ErrorChannel('spread/distance', ErrorModel(false_echoes=models), 7)
        for models in ((), (FalseEchoModel(0.3, 5.0, ambiguous=True),))
    )
    apart = [false.measure(20.0, k, 0) - plain.measure(20.0, k, 0) for k in range(200)]
    assert set(np.round(apart, 9)) == {0.0, 5.0}


def test_a_file_says_share_and_size_together():
    model = RangeParameters(**RANGE, ambiguity_share=0.1, ambiguity_m=210.0).model()
    assert model.false_echoes == (FalseEchoModel(0.1, 210.0, ambiguous=True),)
    model = RangeParameters(**RANGE, double_share=0.02, double_run=1.5).model()
    assert model.false_echoes == (FalseEchoModel(0.02, multiple=2.0, run=1.5),)
    assert RangeParameters(**RANGE).model().false_echoes == ()
    with pytest.raises(ValidationError, match=r'reflection_share: found 0\.1 with reflection_m 0'):
        RangeParameters(**RANGE, reflection_share=0.1)
