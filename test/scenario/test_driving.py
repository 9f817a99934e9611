"""Autopilot and autotrawl in a trial: they go by the published readings, and end where told."""

import math

import numpy as np
import pytest

from trawl_ros.control.autopilot import Autopilot, FollowTrack
from trawl_ros.control.autotrawl import Autotrawl
from trawl_ros.core.errors import NoSteadyState, ScenarioError
from trawl_ros.core.geodesy import Datum
from trawl_ros.instruments.suite import InstrumentSuite
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.samples import FixSample, HeadingSample, VelocitySample, WinchSample
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import load_scenario
from trawl_ros.scenario.steadiness import require_steady_states

TRIAL = """\
description: a turn, and both warps equally taut
gear: {gear}
seed: 4
heading_deg: 10
start: {{port_warp_length_m: 402.0, starboard_warp_length_m: 398.0, speed_m_s: 2.2}}
faults:
  - {{at_min: 0.6, for_min: 0.2, where: vessel/heading, what: offset 0.02}}
  - {{at_min: 0.3, for_min: 0.3, where: winch/joint_states/port/tension, what: scale 1.1}}
steps:
  - {{name: hold, minutes: 0.2}}
  - {{name: drive, minutes: 0.8, steer: {{course_deg: 25}}, autotrawl: {{mode: tension}}}}
  - {{name: veer, minutes: 0.3, warp_length_m: 404.0}}
  - {{name: straight on by hand, minutes: 0.2, turn_deg_s: 0.0, autotrawl: {{mode: 'off'}}}}
truth_rate_hz: 2.0
"""


@pytest.fixture
def scenario(tmp_path, coarse_gear):
    def load(text=TRIAL):
        path = tmp_path / 'trial.yaml'
        path.write_text(text.format(gear=coarse_gear))
        return load_scenario(path)

    return load


def test_ship_and_winches_are_driven_by_the_readings_that_are_published(scenario):
    scenario = scenario()
    trial = Trial(scenario)
    suite = InstrumentSuite(
        scenario.instruments,
        surroundings=scenario.surroundings,
        draws=scenario.draws,
        faults=scenario.faults,
    )
    drive = scenario.record.steps[1]
    acceleration = math.radians(scenario.plant.ship.max_turn_acceleration_deg_s2)
    winch = scenario.plant.winch
    pilot = Autopilot(drive.steer.settings(acceleration), Datum(60.0, 2.0))
    pilot.steer(drive.steer.target(Datum(60.0, 2.0)))
    work = drive.autotrawl.settings(winch.max_speed_m_s, winch.max_acceleration_m_s2)
    trawl = Autotrawl(work, (402.0, 398.0))
    expected, given = [], []
    while (truth := trial.step()) is not None:
        given.append(trial.simulation.command)
        time = truth.stamp / 1e9
        for sample in suite.observe(truth):
            if isinstance(sample, WinchSample) and time > 12.0:
                trawl.update(sample)
            elif isinstance(sample, HeadingSample | FixSample | VelocitySample):
                pilot.take(sample)
        rate = pilot.turn_rate(truth.stamp) if time > 12.0 else 0.0
        length = (404.0, 404.0) if time >= 60.0 else (402.0, 398.0)
        trawl.set_lengths(*length)
        expected.append((rate, *trawl.wanted) if time < 78.0 else (0.0, 404.0, 404.0))
    driven = [(c.turn_rate, c.port_length, c.starboard_length) for c in given[1:]]
    # A step that begins at a truth drives with what comes after it.
    assert driven == pytest.approx(np.array(expected[:-1]), abs=1e-12)
    assert max(abs(rate) for rate, *_ in driven) > 0.0025
    assert driven[110][1] != driven[110][2]


def test_after_a_reset_the_same_way_is_gone_again(scenario):
    trial = Trial(scenario())
    first = [trial.step() for _ in range(60)]
    trial.reset()
    for before in first:
        after = trial.step()
        assert before.stamp == after.stamp
        assert np.array_equal(before.vessel.position, after.vessel.position)
        assert before.winches == after.winches


def test_what_is_steered_goes_on_until_another_rate_or_target_is_named(scenario):
    loaded = scenario()
    steers = [driving.steer is not None for driving in loaded.drivings]
    modes = [driving.autotrawl.mode for driving in loaded.drivings]
    assert steers == [False, True, True, False]
    assert modes == ['off', 'tension', 'tension', 'off']
    assert loaded.state_changes_s == pytest.approx((12.0, 60.0, 78.0))


def test_a_track_in_degrees_is_the_same_track_in_metres(scenario):
    text = TRIAL.replace('course_deg: 25', 'track_deg: [[60.0, 2.0], [60.01, 2.02]]')
    target = scenario(text).record.steps[1].steer.target(Datum(60.0, 2.0))
    assert isinstance(target, FollowTrack)
    assert target.waypoints[0] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert target.waypoints[1] == pytest.approx([1115.7, 1114.3], abs=0.5)


@pytest.mark.parametrize(
    ('old', 'new', 'sentence'),
    [
        ('course_deg: 25', '', 'steps[1].steer: found none'),
        ('course_deg: 25', 'course_deg: 2, heading_deg: 2', 'found heading_deg and course_deg'),
        ('course_deg: 25', 'track_m: []', 'steps[1].steer.track_m'),
        ('course_deg: 25', 'track_m: [[1, 2], [1, 2]]', 'found waypoint [1.0, 2.0] twice'),
        ('course_deg: 25', 'to_school: false', 'steps[1].steer.to_school'),
        ('course_deg: 25', 'course_deg: 25, max_turn_deg_s: 9', 'max_turn_deg_s: found 9'),
        ('mode: tension', 'mode: magic', "steps[1].autotrawl.mode: found 'magic'"),
        ('mode: tension', 'mode: lengths, tension_kn: 90', "tension_kn: found in mode 'lengths'"),
        ('turn_deg_s: 0.0', 'turn_deg_s: 0.0, steer: {{heading_deg: 1}}', 'turn_deg_s: '),
    ],
)
def test_a_mistake_is_named(scenario, old, new, sentence):
    with pytest.raises(ScenarioError) as caught:
        scenario(TRIAL.replace(old, new))
    assert sentence in str(caught.value)


CURRENT = 'water: {{current: [{{depth_m: 0, east_m_s: 0.1, north_m_s: 0.3}}]}}\n'


@pytest.fixture
def asked(monkeypatch):
    """The states that a check of steadiness looks at: lengths and heading in degrees."""
    seen = []

    def look(model, lengths, speed, *, heading, start=None):
        seen.append((*lengths, round(math.degrees(heading), 1)))
        if min(lengths) < 100:
            raise NoSteadyState('too short')
        return type('State', (), {'equilibrium': None})()

    monkeypatch.setattr('trawl_ros.scenario.steadiness.steady_state', look)
    return seen


def test_states_are_looked_for_on_the_heading_that_the_current_asks_for(scenario, asked):
    loaded = scenario(TRIAL + CURRENT)
    require_steady_states(loaded, build_model(loaded.plant))
    assert asked[0] == (402.0, 398.0, 10.0)
    across = 0.3 * math.cos(math.radians(25)) - 0.1 * math.sin(math.radians(25))
    drift = round(25 - math.degrees(math.asin(across / 2.2)), 1)
    assert (400.0, 400.0, drift) in asked
    assert asked[-1] == (404.0, 404.0, drift)


def test_each_leg_of_a_track_is_looked_at_and_the_way_to_fish_is_not(scenario, asked):
    track = 'track_m: [[0, 0], [900, 0], [900, 900]]'
    loaded = scenario(TRIAL.replace('course_deg: 25', track) + CURRENT)
    require_steady_states(loaded, build_model(loaded.plant))
    headings = [heading for *_, heading in asked]
    assert headings[:3] == [10.0, -7.8, 92.6]
    del asked[:]
    loaded = scenario(TRIAL.replace('course_deg: 25', 'to_school: true') + CURRENT)
    require_steady_states(loaded, build_model(loaded.plant))
    assert {heading for *_, heading in asked} == {10.0}
    del asked[:]
    # In still water every heading is as good as another.
    loaded = scenario(TRIAL.replace('course_deg: 25', 'to_school: true'))
    require_steady_states(loaded, build_model(loaded.plant))
    assert (404.0, 404.0, 10.0) in asked


def test_a_driven_step_without_a_steady_state_is_named(scenario, asked):
    loaded = scenario(TRIAL.replace('warp_length_m: 404.0', 'warp_length_m: 50.0'))
    with pytest.raises(NoSteadyState, match="step 'veer': too short"):
        require_steady_states(loaded, build_model(loaded.plant))
