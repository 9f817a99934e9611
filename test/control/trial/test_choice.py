"""The next target is the best proposal that passes no limit."""

import pytest

from trawl_ros.control.trial.choice import choose, waiting_for_advice
from trawl_ros.control.trial.memory import TowedState
from trawl_ros.control.trial.records import Knowledge, Proposal, TrialSettings, TrialTarget

HERE = TrialTarget(port=300.0, starboard=300.0, speed=2.1)


def at(length, speed=2.1):
    return TrialTarget(port=length, starboard=length, speed=speed)


def proposal(length, speed=2.1, *, minutes=15.0, rate=1.0, tension=150e3, deepest=100.0):
    return Proposal(at(length, speed), minutes, 1.0, rate, tension, deepest)


PROPOSALS = (proposal(500.0, tension=250e3, deepest=200.0), proposal(400.0, deepest=150.0))


def chosen(settings=None, proposals=PROPOSALS, **known):
    asked = {'here': HERE, 'towed': (), 'struck': (), 'minutes_left': 60.0} | known
    return choose(proposals, settings or TrialSettings(), **asked)


def test_the_first_is_chosen_where_nothing_is_against_it():
    assert chosen().proposal is PROPOSALS[0]


@pytest.mark.parametrize(
    ('settings', 'reason'),
    [
        (TrialSettings(max_tension=200e3), 'tension'),
        (TrialSettings(max_depth=180.0), 'depth'),
        (TrialSettings(seabed=205.0), 'seabed'),
    ],
)
def test_limits_strike_it_off_and_are_counted(settings, reason):
    choice = chosen(settings)
    assert choice.proposal is PROPOSALS[1]
    assert choice.refused == {reason: 1}


def test_the_sounder_counts_as_the_seabed_does():
    assert chosen(seabed=205.0).proposal is PROPOSALS[1]


def test_neither_here_nor_struck_off_nor_twice_nor_for_nothing():
    proposals = (
        proposal(300.5),
        proposal(500.0),
        proposal(600.0),
        proposal(700.0, rate=0.0),
        proposal(700.0, speed=1.5),
        proposal(400.0),
    )
    twice = (TowedState(target=at(600.0), windows=2),) * 2
    choice = chosen(proposals=proposals, struck=(at(500.0),), towed=twice)
    assert choice.proposal is proposals[-1]
    assert choice.refused == {
        'here already': 1, 'struck off': 1, 'towed before': 1, 'teaches nothing': 1, 'speed': 1,
    }  # fmt: skip


def test_what_does_not_fit_into_the_time_is_told_apart():
    choice = chosen(minutes_left=10.0)
    assert choice.proposal is None
    assert choice.late
    assert choice.refused == {'time': 2}
    none = chosen(TrialSettings(max_tension=1.0))
    assert none.proposal is None
    assert not none.late
    assert not chosen(proposals=()).refused


def test_a_slow_adviser_is_waited_for_and_a_poor_one_not_for_ever():
    settings = TrialSettings(least_looked_up=0.3, advice_patience=600.0)
    assert 'first window' in waiting_for_advice(Knowledge(), settings, 0.0)
    late = Knowledge(windows=4, advised=2, looked_up=1.0)
    assert waiting_for_advice(late, settings, 1e5).startswith('for advice after 4 ')
    older = Knowledge(4, {}, 2, 1.0, PROPOSALS)
    assert waiting_for_advice(older, settings, 599.0).startswith('for advice after 4 ')
    assert waiting_for_advice(older, settings, 600.0) == ''
    poor = Knowledge(windows=4, advised=4, looked_up=0.1)
    assert '10 % are' in waiting_for_advice(poor, settings, 599.0)
    assert waiting_for_advice(poor, settings, 600.0) == ''
    assert waiting_for_advice(Knowledge(4, {}, 4, 0.3), settings, 0.0) == ''
    # By the newest estimate none can be towed: an earlier one's serve, ranked anew.
    doubtful = Knowledge(4, {}, 4, 1.0, PROPOSALS, 'by this estimate the gear can be towed in none')
    assert waiting_for_advice(doubtful, settings, 0.0) == ''
