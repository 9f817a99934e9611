"""A trial starts in equilibrium, follows its steps, and ends; what cannot be towed is said."""

import numpy as np
import pytest

from trawl_ros.api.tows import tow
from trawl_ros.bags.check import check_bag
from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.scenario.run import Trial, periods_per_truth
from trawl_ros.scenario.scenario import load_scenario

SECOND = 1_000_000_000

STEPS = """\
description: six seconds
gear: coarse.yaml
start: {warp_length_m: 500.0, speed_m_s: 2.1}
steps:
  - {name: hold, minutes: 0.05}
  - {name: veer, minutes: 0.05, warp_length_m: 510.0}
"""


@pytest.fixture
def scenario(tmp_path, coarse_gear):
    def load(text=STEPS):
        path = tmp_path / 'trial.yaml'
        path.write_text(text)
        (tmp_path / 'coarse.yaml').write_bytes(coarse_gear.read_bytes())
        return load_scenario(path)

    return load


def towed(trial):
    truths = []
    while (truth := trial.step()) is not None:
        truths.append(truth)
    return truths


def test_truth_comes_at_its_rate_from_the_start_to_the_end(scenario):
    trial = Trial(scenario())
    truths = towed(trial)
    assert [truth.stamp for truth in truths] == [n * SECOND // 10 for n in range(61)]
    assert trial.time_s == trial.duration_s == 6.0
    assert trial.step() is None


def test_a_slower_truth_is_the_same_truth_less_often_to_what_longer_steps_allow(scenario):
    often = towed(Trial(scenario()))
    seldom = towed(Trial(scenario(f'{STEPS}truth_rate_hz: 2.0\n')))
    assert [truth.stamp for truth in seldom] == [truth.stamp for truth in often[::5]]
    for a, b in zip(seldom, often[::5], strict=True):
        np.testing.assert_allclose(a.doors[0].position, b.doors[0].position, atol=0.01)


def test_a_step_begins_when_it_should(scenario):
    truths = towed(Trial(scenario()))
    lengths = [truth.winches[0].length for truth in truths]
    assert lengths[30] == 500.0
    assert lengths[31] > 500.0
    assert lengths == sorted(lengths)


def test_the_start_is_steady(scenario):
    held = towed(Trial(scenario()))[:30]
    depths = [truth.net.headrope_depth for truth in held]
    assert np.ptp(depths) < 0.02


def test_after_a_reset_the_same_truth_comes_again(scenario):
    trial = Trial(scenario())
    first = [trial.step() for _ in range(40)]
    trial.reset()
    again = [trial.step() for _ in range(40)]
    for a, b in zip(first, again, strict=True):
        assert a.stamp == b.stamp
        assert np.array_equal(a.doors[1].position, b.doors[1].position)


def test_stamps_begin_where_one_wants(scenario):
    trial = Trial(scenario(), stamp=7 * SECOND)
    assert [trial.step().stamp for _ in range(2)] == [7 * SECOND, 71 * SECOND // 10]
    assert trial.time_s == pytest.approx(0.1)


@pytest.mark.parametrize(
    ('old', 'place'),
    [('warp_length_m: 500.0', 'start'), ('warp_length_m: 510.0', "step 'veer'")],
)
def test_a_state_that_is_not_steady_is_named_before_the_tow(scenario, old, place):
    with pytest.raises(NoSteadyState, match=rf'trial\.yaml: {place}: warp 10 m at 2\.1 m/s: '):
        Trial(scenario(STEPS.replace(old, 'warp_length_m: 10.0')))


def test_a_turning_step_needs_no_steady_state(scenario):
    turning = STEPS.replace('warp_length_m: 510.0', 'warp_length_m: 10.0, turn_deg_s: 0.5')
    assert Trial(scenario(turning)).duration_s == 6.0


@pytest.mark.parametrize(
    ('rate', 'periods'), [(10.0, 1), (5.0, 1), (2.0, 2), (1.0, 4), (10.0 / 3.0, 2), (10.0 / 7.0, 7)]
)
def test_a_rare_truth_is_computed_in_periods_of_a_quarter_second_at_most(
    rate: float, periods: int
) -> None:
    assert periods_per_truth(rate) == periods
    period = 1.0 / rate / periods
    assert period <= 0.25 + 1e-12
    # Stamps count nanoseconds: a period is a whole number of units of 0.05 s.
    assert round(period / 0.05) == pytest.approx(period / 0.05)


def test_a_bag_has_transforms_where_the_scenario_wants_them(scenario, tmp_path):
    scenario(f'{STEPS}record: [instruments, transforms]\n')
    path = tow(tmp_path / 'trial.yaml', tmp_path / 'bag').path
    found = list(Bag(path).messages(['/tf', '/tf_static']))
    parents = {
        entry.child_frame_id: entry.header.frame_id
        for message in found
        for entry in message.message.transforms
    }
    assert parents == {
        'vessel': 'map', 'sonar': 'map', 'door_port': 'map', 'door_starboard': 'map',
        'echo_sounder': 'vessel', 'door_port_spread': 'door_port', 'sonar_width': 'sonar',
        'slant_range': 'vessel',
    }  # fmt: skip
    assert check_bag(path).sound
