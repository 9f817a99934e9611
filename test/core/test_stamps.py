"""Which stamps can be when something was measured."""

import numpy as np
import pytest

from trawl_ros.core.stamps import (
    DAY_NS,
    EXCURSION,
    FUTURE,
    LOG_APART_NS,
    Leaps,
    impossible_time,
    judge_stamps,
)
from trawl_ros.core.time import SECOND

TOW = 1_785_000_000 * SECOND + np.arange(600) * SECOND
"""Ten minutes of July 2026."""

OF_2005 = 1_115_251_200 * SECOND
ROLLOVER = 1024 * 7 * DAY_NS


def test_three_stamps_far_from_the_last_are_believed_and_fewer_are_not():
    leaps = Leaps()
    far = 2_147_483_647 * SECOND
    assert leaps.take(100 * SECOND, 'a') == (['a'], [])
    assert leaps.take(far, 'false') == ([], [])
    assert leaps.take(101 * SECOND, 'b') == (['b'], ['false'])
    for stamp, message in ((5, 'c'), (6, 'd')):
        assert leaps.take(stamp * SECOND, message) == ([], [])
    assert leaps.take(7 * SECOND, 'e') == (['c', 'd', 'e'], [])


@pytest.mark.parametrize('stamp', [0, 12 * 3600 * SECOND, 820_454_400 * SECOND, TOW[0]])
def test_what_can_be_has_no_objection(stamp):
    assert impossible_time(int(stamp)) is None


@pytest.mark.parametrize(
    'stamp', [-1, 315_964_800 * SECOND, int(TOW[-1]) + 100 * 365 * DAY_NS, 2**63 - 1]
)
def test_what_cannot_be_has_one(stamp):
    assert impossible_time(stamp)


@pytest.mark.parametrize(
    ('other', 'why'),
    [
        (0, 'never stamps'),
        (315_964_800 * SECOND, 'before 1990'),
        (OF_2005, 'far from the rest'),
        (TOW[0] - ROLLOVER, 'far from the rest'),
        (TOW[0] + ROLLOVER, 'future'),
        (-(2**63), 'before 1970'),
    ],
)
def test_stamps_that_cannot_be_are_marked_and_counted(other, why):
    stamps = np.concatenate([np.full(40, other), TOW]).astype(np.int64)
    judged = judge_stamps(stamps)
    assert judged.false.tolist() == [True] * 40 + [False] * 600
    assert list(judged.reasons.values()) == [40]
    assert why in judged.sentences()[0]
    assert judged.span == (TOW[0], TOW[-1])


def test_a_simulation_counts_from_zero():
    judged = judge_stamps(np.arange(600) * SECOND // 10)
    assert not judged.false.any()
    assert not judged.reasons


def test_of_a_driver_that_never_stamps_nothing_is_left():
    judged = judge_stamps(np.zeros(30, dtype=np.int64))
    assert judged.false.all()
    assert judged.span is None


def test_where_all_is_in_the_future_this_machine_may_be_wrong():
    judged = judge_stamps(TOW + 20 * 365 * DAY_NS)
    assert not judged.false.any()
    assert judged.reasons == {FUTURE: 600}


def test_two_seasons_are_one_log_and_no_one_recording():
    stamps = np.concatenate([TOW - 200 * DAY_NS, TOW, TOW])
    assert judge_stamps(stamps, apart_ns=LOG_APART_NS).span == (TOW[0] - 200 * DAY_NS, TOW[-1])
    assert judge_stamps(stamps).span == (TOW[0], TOW[-1])


@pytest.mark.parametrize('leap', [-DAY_NS, -3600 * SECOND, DAY_NS])
def test_a_date_that_changes_late_is_an_excursion(leap):
    stamps = TOW.copy()
    stamps[300:303] += leap
    judged = judge_stamps(stamps, in_order=True)
    assert np.flatnonzero(judged.false).tolist() == [300, 301, 302]
    assert judged.reasons == {EXCURSION: 3}


@pytest.mark.parametrize(
    'order', [slice(None, None, -1), np.random.default_rng(1).permutation(600)]
)
def test_rows_in_no_order_are_no_excursions(order):
    assert not judge_stamps(TOW[order], in_order=True).false.any()


def test_a_pause_is_no_excursion():
    stamps = TOW.copy()
    stamps[300:] += DAY_NS
    assert not judge_stamps(stamps, in_order=True).false.any()
