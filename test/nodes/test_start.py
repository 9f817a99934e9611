"""Start of a tow under command, where the default cannot be towed."""

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.records import EffectRecord
from trawl_ros.nodes.towing import DEFAULT_START, OTHER_STARTS, commanded_tow


@pytest.fixture(scope='module')
def slow_log(gear):
    """A gear with heavy boards and a log that shows too much: it falls at what seems 2 m/s."""
    bias = EffectRecord(name='speed_log', values={'bias': 0.8})
    netting = gear.netting.model_copy(update={'around': 12})
    heavy = gear.board.model_copy(update={'mass_kg': 5200.0})
    return gear.model_copy(update={'board': heavy, 'netting': netting, 'effects': (bias,)})


def test_it_starts_where_the_gear_can_be_towed_and_says_so(slow_log):
    warnings = []
    tow = commanded_tow(
        slow_log, DEFAULT_START, heading=0.0, truth_rate_hz=10.0, warn=warnings.append
    )
    command = tow.simulation.command
    assert (command.port_length, command.speed) in OTHER_STARTS
    assert len(warnings) == 1
    assert f'starts at {command.port_length:g} m and {command.speed:g} m/s' in warnings[0]
    assert 'warp 500 m at' in warnings[0]


def test_a_start_that_was_asked_for_is_not_replaced(slow_log):
    with pytest.raises(NoSteadyState, match='warp 500 m at'):
        commanded_tow(slow_log, (500.0, 1.9), heading=0.0, truth_rate_hz=10.0, warn=print)
