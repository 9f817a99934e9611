"""A gear with effects is towed, and shown, as it is predicted."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.sensor_effects import SensorEffects
from trawl_ros.estimation.from_gear import board_prior, predictor_for
from trawl_ros.gear.records import EffectRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import (
    AttitudeSample,
    PressureSample,
    RangeSample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation

EFFECTS = (
    EffectRecord(name='counter_scale', values={'scale': 0.03}),
    EffectRecord(name='counter_offset', values={'offset': 13.0}),
    EffectRecord(name='speed_log', values={'bias': 0.1}),
    EffectRecord(name='warp_strumming', values={'factor': 1.5}),
    EffectRecord(name='tension_cell', values={'scale': 0.1}),
    EffectRecord(name='depth_sensor', values={'net_offset': 4.0, 'drift': 2.0}),
    EffectRecord(name='spread_sensor', values={'scale': -0.05}),
)
COMMAND = Command(480.0, 480.0, 2.3)


@pytest.fixture(scope='module')
def affected(gear):
    netting = gear.netting.model_copy(update={'around': 12})
    return gear.model_copy(update={'netting': netting, 'effects': EFFECTS})


@pytest.fixture(scope='module')
def truth(affected):
    simulation = Simulation(build_model(affected), COMMAND, effect_set=effects_of(affected))
    first = simulation.truth()
    for _ in range(4):
        simulation.advance()
    second = simulation.truth()
    assert second.net.headrope_depth == pytest.approx(first.net.headrope_depth, abs=1e-3)
    return second


def test_winches_and_ship_follow_counters_and_log(truth):
    for winch in truth.winches:
        assert winch.length == pytest.approx(480.0 / 1.03 - 13.0)
    assert truth.vessel.velocity_water[0] == pytest.approx(2.2)


def test_what_is_shown_is_what_is_predicted(affected, truth):
    showing = SensorEffects(effects_of(affected), build_water(affected))
    water = build_water(affected)
    lengths = tuple(winch.length for winch in truth.winches)
    tensions = tuple(winch.tension for winch in truth.winches)
    winch = showing(WinchSample(0, lengths, (0.0, 0.0), tensions))
    log = showing(VelocitySample(0, 'water', truth.vessel.velocity_water, 0.0))
    depth = truth.net.headrope_depth
    net = showing(PressureSample(0, 'sonar', water.pressure(depth), 1.0))
    apart = float(np.linalg.norm(truth.doors[0].position - truth.doors[1].position))
    spread = showing(RangeSample(0, 'spread', apart, 1.0, 1.0, 500.0))
    assert winch.lengths == pytest.approx((480.0, 480.0))
    assert log.velocity[0] == pytest.approx(2.3)

    board = build_model(affected).coefficients
    found = predictor_for(affected).predict(board, *winch.lengths, log.velocity[0])
    predicted = dict(zip(OBSERVABLES, found.values, strict=True))
    assert winch.tensions[0] == pytest.approx(predicted['port_tension'], rel=1e-4)
    assert water.depth(net.pressure) == pytest.approx(predicted['net_depth'], abs=0.02)
    assert spread.distance == pytest.approx(predicted['door_spread'], rel=1e-4)


def test_a_drift_goes_on_from_the_first_sample(affected):
    water = build_water(affected)
    showing = SensorEffects(effects_of(affected), water)
    first = PressureSample(10**12, 'sonar', water.pressure(100.0), 1.0)
    later = replace(first, stamp=first.stamp + 1800 * 10**9)
    assert water.depth(showing(first).pressure) == pytest.approx(104.0)
    assert water.depth(showing(later).pressure) == pytest.approx(105.0)


def test_an_empirical_term_of_attitude_is_shown(gear):
    record = EffectRecord(name='empirical_port_pitch_offset', values={'size': 0.05})
    tilted = gear.model_copy(update={'effects': (record,)})
    showing = SensorEffects(effects_of(tilted), build_water(tilted))
    port = showing(AttitudeSample(0, 'port', 0.1, 0.2, 0.01))
    assert (port.pitch, port.roll) == pytest.approx((0.15, 0.2))
    starboard = AttitudeSample(0, 'starboard', 0.1, 0.2, 0.01)
    assert showing(starboard) == starboard


def test_without_effects_samples_pass_unchanged(gear):
    showing = SensorEffects(effects_of(gear), build_water(gear))
    sample = PressureSample(0, 'sonar', 1e6, 1.0)
    assert showing(sample) is sample


def test_an_estimate_starts_from_the_effects_of_its_gear(affected):
    assert predictor_for(affected).fixed
    assert np.all(board_prior(affected).std > 0.0)
