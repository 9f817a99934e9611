"""Each door to a tow has the same limits: files, commands, Python and messages."""

import math

import click
import pytest

from trawl_ros.cli.options import SPEED, WARP
from trawl_ros.core.errors import NoSteadyState, ScenarioError
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.towing_limits import LIMITS
from trawl_ros.scenario.records import SteadyStartRecord
from trawl_ros.simulation.command import Command
from trawl_ros.solver.equilibrium import steady_state

BEYOND = [0.0, -500.0, 0.5, 3000.5, 5000.0, 1e300, math.inf, -math.inf, math.nan]
TOO_FAST = [0.0, -2.1, 0.4, 4.1, 1e300, math.inf, math.nan]


@pytest.fixture(scope='module')
def model():
    return build_model(load_gear('kaifuha').refined(net=0.25))


@pytest.mark.parametrize('length', BEYOND)
def test_no_door_takes_a_warp_beyond_the_limits(model, length):
    assert 'expected 1 to 3000' in LIMITS.objection((500.0, length))
    for lengths in (length, (500.0, length), (length, 500.0)):
        with pytest.raises(NoSteadyState, match='warp length'):
            steady_state(model, lengths, 2.1)
    with pytest.raises(ScenarioError, match='warp length'):
        Command(500.0, length, 2.1)
    with pytest.raises(ValueError, match='warp_length_m'):
        SteadyStartRecord(warp_length_m=length, speed_m_s=2.1)
    with pytest.raises(click.BadParameter):
        WARP.convert(str(length), None, None)


@pytest.mark.parametrize('speed', TOO_FAST)
def test_no_door_takes_a_speed_beyond_the_limits(model, speed):
    with pytest.raises(NoSteadyState, match='a speed of'):
        steady_state(model, 500.0, speed)
    with pytest.raises(ScenarioError, match='a speed of'):
        Command(500.0, 500.0, speed)
    with pytest.raises(ValueError, match='speed_m_s'):
        SteadyStartRecord(warp_length_m=500.0, speed_m_s=speed)
    with pytest.raises(click.BadParameter):
        SPEED.convert(str(speed), None, None)


@pytest.mark.parametrize('turn', [0.06, -0.06, math.inf, math.nan])
def test_no_command_takes_a_turn_beyond_the_limits(turn):
    with pytest.raises(ScenarioError, match='rate of turn'):
        Command(500.0, 500.0, 2.1, turn)


def test_the_limits_themselves_are_within():
    for length in LIMITS.warp_m:
        for speed in LIMITS.speed_m_s:
            for sign in (-1.0, 1.0):
                Command(length, length, speed, sign * math.radians(LIMITS.turn_deg_s))
            SteadyStartRecord(warp_length_m=length, speed_m_s=speed)
