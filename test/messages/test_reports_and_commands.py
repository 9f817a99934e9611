"""Commands, estimates, innovations and diagnostics keep to the contract."""

import math

import numpy as np
import pytest

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.commands import (
    read_vessel_command,
    read_winch_command,
    vessel_command,
    winch_command,
)
from trawl_ros.messages.diagnostics import (
    OK,
    STALE,
    WARN,
    Status,
    diagnostic_array,
    read_number,
    read_statuses,
)
from trawl_ros.messages.estimates import (
    ChannelInnovation,
    coefficients_message,
    covariance_message,
    estimate_message,
    innovation_message,
    innovations_message,
    read_covariance,
    read_estimate,
    read_innovations,
)
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.topics import TOPICS

VALUES = np.linspace(-1.0, 1.0, 12)
MATRIX = np.arange(144.0).reshape(12, 12)


def through_bytes(topic, message):
    return deserialize(serialize(message), TOPICS[topic].type)


def test_the_estimate_is_labelled_in_the_order_of_eq_36():
    message = through_bytes(*estimate_message(VALUES))
    (dimension,) = message.layout.dim
    assert dimension.label == 'a1,c1,a2,c2,b3,c3,a4,c4,b5,c5,a6,c6'
    assert (dimension.size, dimension.stride) == (12, 12)
    np.testing.assert_array_equal(read_estimate(message), VALUES)


def test_the_covariance_is_row_major():
    message = through_bytes(*covariance_message(MATRIX))
    assert [(d.size, d.stride) for d in message.layout.dim] == [(12, 144), (12, 12)]
    assert message.data[12] == MATRIX[1, 0]
    np.testing.assert_array_equal(read_covariance(message), MATRIX)


def test_an_estimate_in_another_order_is_refused():
    _, message = estimate_message(VALUES)
    message.layout.dim[0].label = 'a1,a2'
    with pytest.raises(MessageError, match="identification/estimate: label 'a1,a2'"):
        read_estimate(message)


def test_an_estimate_of_another_size_is_refused():
    _, message = estimate_message(VALUES)
    message.data = message.data[:11]
    with pytest.raises(MessageError, match='11 values'):
        read_estimate(message)


def test_innovations_come_back():
    sent = (
        ChannelInnovation('door_spread', -1.5, 0.8, 0.3),
        ChannelInnovation('net_depth', 2.0, 1.0, 1.2),
    )
    assert read_innovations(through_bytes(*innovation_message(5, sent))) == sent


def test_coefficients_have_names_and_a_stamp():
    known = [True] * 11 + [False]
    message = through_bytes(*coefficients_message(7_000_000_001, VALUES, 0.1 * VALUES**2, known))
    assert stamp_of(message) == 7_000_000_001
    statuses = read_statuses(message)
    assert tuple(status.name for status in statuses) == COEFFICIENTS
    assert [read_number(status, 'value') for status in statuses] == list(VALUES)
    assert [read_number(status, 'std') for status in statuses] == list(0.1 * VALUES**2)
    assert [status.level for status in statuses] == [OK] * 11 + [WARN]


def test_innovations_are_statuses_with_a_unit_too():
    sent = (
        ChannelInnovation('door_spread', -1.5, 0.8, 0.3),
        ChannelInnovation('net_depth', 2.0, 1.0, 1.2),
    )
    message = through_bytes(*innovations_message(5, sent))
    spread, depth = read_statuses(message)
    assert (spread.name, spread.level, depth.level) == ('door_spread', OK, WARN)
    assert spread.values == {'innovation': '-1.5', 'std': '0.8', 'test ratio': '0.3', 'unit': 'm'}


def test_statuses_come_back():
    sent = (
        Status('sim_node: solver', OK, 'running', {'steps': '120', 'rate_hz': '10.0'}, 'trawl'),
        Status('winch_node: truth', STALE, 'no truth'),
    )
    message = through_bytes('/diagnostics', diagnostic_array(7_000_000_001, sent))
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 1)
    assert message.status[1].level == 3
    assert read_statuses(message) == sent


def test_winch_commands_come_back():
    assert read_winch_command(through_bytes(*winch_command(0, 400.0, 410.0))) == (400.0, 410.0)


def test_a_winch_that_is_not_named_is_left_alone():
    assert read_winch_command(through_bytes(*winch_command(0, math.nan, 410.0))) == (None, 410.0)


def test_vessel_commands_come_back():
    assert read_vessel_command(through_bytes(*vessel_command(0, 2.1, -0.01))) == (2.1, -0.01)


@pytest.mark.parametrize(('port', 'found'), [(-5.0, '-5'), (0.0, '0'), (math.inf, 'inf')])
def test_a_warp_length_that_cannot_be_is_refused(port, found):
    with pytest.raises(MessageError, match=f'command/winch: position {found} of port_warp'):
        read_winch_command(winch_command(0, port, 400.0)[1])


def test_an_unknown_winch_is_refused():
    _, message = winch_command(0, 400.0, 400.0)
    message.name[0] = 'net_drum'
    with pytest.raises(MessageError, match='net_drum'):
        read_winch_command(message)


def test_a_speed_that_is_no_number_is_refused():
    with pytest.raises(MessageError, match=r'command/vessel: linear\.x nan'):
        read_vessel_command(vessel_command(0, math.nan, 0.0)[1])
