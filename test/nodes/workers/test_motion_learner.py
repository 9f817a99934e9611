"""Learning from all of the tow beside the windows: what fails in it takes nothing away."""

from types import SimpleNamespace

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation import live_motion
from trawl_ros.nodes.workers.identification_report import ReportWriter
from trawl_ros.nodes.workers.motion_learner import BEFORE, ENDED, MotionLearner
from trawl_ros.records.samples import WinchSample

SAMPLE = WinchSample(1, (500.0, 500.0), (0.0, 0.0), (9e4, 9e4))


def broken(*_):
    raise ZeroDivisionError('nothing to divide by')


class Live:
    """Stands for the fit, which takes minutes."""

    def __init__(self, gear, *, net):
        self.recorded, self.why_not = 0, 'the tow has just begun'
        self.feed = lambda sample, windows: None
        self.finish = broken
        self.refusal = str

    def record(self, sample):
        self.recorded += 1

    def reset(self):
        self.recorded = 0


@pytest.fixture
def learner(gear, monkeypatch):
    monkeypatch.setattr(live_motion, 'LiveMotion', Live)
    found = MotionLearner(gear)
    found.feed(SAMPLE, None)
    return found


def test_an_error_on_the_way_is_told_once_and_the_tow_is_recorded_on(learner):
    learner._live.feed = broken
    assert learner.feed(SAMPLE, None)
    assert learner.knowledge.failed
    assert 'ZeroDivisionError' in learner.knowledge.why_not
    assert not learner.feed(SAMPLE, None)
    assert learner._live.recorded == 1
    learner.reset()
    assert not learner.knowledge.failed


def windows():
    """A finished identification of two windows."""
    estimate = SimpleNamespace(windows=2, reason='it is at rest')
    return SimpleNamespace(estimate=estimate)


def test_an_error_at_the_end_leaves_the_windows(learner, gear):
    ends = ReportWriter(gear, None, None, learner)(windows())
    assert ends.startswith('2 windows used; ')
    assert learner.knowledge.failed
    assert learner.knowledge.estimate is None


def test_who_ends_a_node_waits_for_no_fit(learner, gear):
    learner.at_end = False
    assert ReportWriter(gear, None, None, learner)(windows()).endswith(ENDED)
    assert not learner.knowledge.failed


def test_neither_windows_nor_motion_is_refused_with_both_reasons(learner, gear):
    learner._live.finish = lambda *_, **__: (_ for _ in ()).throw(TrawlError('lasts 9 s'))
    nothing = SimpleNamespace(estimate=None, why_not=lambda: 'no steady window was found, so')
    with pytest.raises(TrawlError, match='lasts 9'):
        ReportWriter(gear, None, None, learner)(nothing)


def test_what_came_before_a_restart_is_said_to_be_lost_until_a_new_tow_begins(gear):
    resumed = MotionLearner(gear, resumed=True)
    assert resumed.knowledge.lost == BEFORE
    resumed.reset()
    assert not resumed.knowledge.lost


def test_a_gear_without_boards_is_not_learned_from_in_motion(pair_gear):
    learner = MotionLearner(pair_gear)
    assert not learner.feed(SAMPLE, None)
    assert 'no boards' in learner.knowledge.why_not
    with pytest.raises(TrawlError, match='no boards'):
        learner.finish(None)
