"""A tow learned from while it goes on: the same in any order, and at its end as from a bag."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from trawl_ros.api.tows import tow
from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import ignore
from trawl_ros.estimation import bag_motion, live_motion
from trawl_ros.estimation.bag_motion import learn_from_motion
from trawl_ros.estimation.bag_windows import read_tows
from trawl_ros.estimation.live_motion import LiveMotion
from trawl_ros.estimation.motion import stretches, tracking
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.gear.load import load_gear
from trawl_ros.records.samples import VelocitySample, WinchSample
from trawl_ros.records.topics import NAMESPACE

SECOND = 1_000_000_000
MINUTES = 12
QUICK = partial(MotionOptions, iterations=1, attempts=1, estimate_sizes=False)
"""Options of a fit that is compared with itself."""


@pytest.fixture(scope='module')
def record(coarse_gear):
    return load_gear(coarse_gear)


@pytest.fixture(scope='module')
def still(steady_tow):
    """Minutes in one steady state, of which the model is the plant."""
    state = replace(steady_tow, states=steady_tow.states[:1])
    return list(state.samples(start=1000 * SECOND, leg_s=60 * MINUTES))


def updates(live, samples):
    found = [live.feed(sample) for sample in samples]
    return [update for update in found if update is not None]


@pytest.fixture(scope='module')
def at_once():
    """All of a tow is towed along again with the next stretch."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tracking, 'AHEAD', 60)
        yield


@pytest.fixture(scope='module')
def learned(record, still, at_once):
    return updates(LiveMotion(record, QUICK()), still)


def same(found, expected):
    assert [update.stamp for update in found] == [update.stamp for update in expected]
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one.outcome.fit.values, other.outcome.fit.values, atol=1e-9)
        np.testing.assert_allclose(
            one.outcome.estimate.covariance, other.outcome.estimate.covariance, atol=1e-9
        )


def test_each_half_minute_brings_an_estimate(learned):
    stamps = [update.stamp for update in learned]
    assert len(stamps) >= 3
    assert set(np.diff(stamps)) == {30 * SECOND}
    assert [update.outcome.duration_s for update in learned] == [
        (stamp - 1000 * SECOND) / SECOND - 300.0 for stamp in stamps
    ]
    assert np.all(learned[-1].outcome.estimate.std <= learned[-1].outcome.prior.std)


def test_at_its_end_a_tow_gives_what_its_bag_gives(
    record, still, steady_tow, tmp_path, monkeypatch
):
    # Without a step: it is enough to be compared.
    none = partial(MotionOptions, iterations=0, estimate_sizes=False)
    monkeypatch.setattr(bag_motion, 'MotionOptions', none)
    bag = steady_tow.write(tmp_path / 'bag', still)
    expected = learn_from_motion(
        record, None, read_tows([bag], record, NAMESPACE), NAMESPACE, ignore
    )
    live = LiveMotion(record)
    for _, sample in SampleStream([bag], NAMESPACE):
        live.record(sample)
    found = live.finish(None)
    np.testing.assert_allclose(found.fit.values, expected.fit.values, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        found.estimate.covariance, expected.estimate.covariance, rtol=0, atol=1e-9
    )


def test_the_order_in_which_topics_arrive_changes_nothing_nor_what_was_before_a_reset(
    record, still, learned
):
    def arrival(sample):
        late = 0.5 if isinstance(sample, WinchSample) else 1.5
        return sample.stamp + (0 if isinstance(sample, VelocitySample) else late * SECOND)

    live = LiveMotion(record, QUICK())
    updates(live, still[:2000])
    live.reset()
    assert live.why_not == LiveMotion(record, QUICK()).why_not
    same(updates(live, sorted(still, key=arrival)), learned)


def test_a_tow_that_has_just_begun_says_what_it_needs(record, still):
    live = LiveMotion(record)
    assert not updates(live, still[: len(still) // 3])
    assert '600 s' in live.why_not
    with pytest.raises(TrawlError, match='600 s'):
        live.finish(None)


def test_of_a_tow_that_is_too_long_the_beginning_is_learned_from(record, still, monkeypatch):
    for module in (live_motion, stretches):
        monkeypatch.setattr(module, 'LONGEST_S', 650.0)
    live = LiveMotion(record)
    # One false stamp is no end of it.
    assert live.record(replace(still[0], stamp=still[0].stamp + 10_000 * SECOND))
    taken = [live.record(sample) for sample in still]
    assert 620 < sum(taken) / len(taken) * 60 * MINUTES < 630
    assert live.refusal() == ''
    assert 'the most' in live.why_not


MOVING = """\
description: Warps and speed change all the time
gear: {gear}
seed: 11
start: {{warp_length_m: 420.0, speed_m_s: 2.3}}
record: [instruments]
steps:
  - {{name: at rest, minutes: 2.0}}
  - {{name: hauled to 340 m, minutes: 3.0, warp_length_m: 340.0}}
  - {{name: slower, minutes: 3.0, speed_m_s: 2.05}}
  - {{name: faster, minutes: 3.0, speed_m_s: 2.4}}
  - {{name: veered to 400 m, minutes: 3.0, warp_length_m: 400.0}}
  - {{name: veered to 460 m, minutes: 3.0, warp_length_m: 460.0}}
  - {{name: slower again, minutes: 3.0, speed_m_s: 2.15}}
  - {{name: hauled to 380 m, minutes: 3.0, warp_length_m: 380.0}}
"""


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_what_is_known_on_the_way_ends_near_what_all_of_it_tells(record, coarse_gear, tmp_path):
    scenario = tmp_path / 'moving.yaml'
    scenario.write_text(MOVING.format(gear=coarse_gear))
    bag = tow(scenario, tmp_path / 'bag')
    live = LiveMotion(record)
    samples = [sample for _, sample in SampleStream([bag.path], NAMESPACE)]
    last = updates(live, samples)[-1]
    assert last.holds
    whole = live.finish(None)
    assert whole.fit.converged
    assert np.max(np.abs(last.outcome.fit.values - whole.fit.values) / whole.estimate.std) < 0.5
    np.testing.assert_allclose(last.outcome.estimate.std / whole.estimate.std, 1.0, atol=0.1)
