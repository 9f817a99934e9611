"""Numbers of a message beyond a bound are named by their field, wherever they stand in it."""

import math

import numpy as np
import pytest

from trawl_ros.messages.cdr import STORE
from trawl_ros.messages.fields import beyond
from trawl_ros.messages.pieces import joint_state, vector
from trawl_ros.messages.stamps import header

SCAN = STORE.types['sensor_msgs/msg/LaserScan']


@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_named(value):
    message = joint_state(0, 'truth/winch', (1.0, 2.0), (0.0, value), (3e300, 4.0))
    assert beyond(message) == {'sensor_msgs__msg__JointState.velocity'}


def test_infinity_among_short_numbers_is_named():
    values = {'ranges': np.array([1.0, np.inf], np.float32), 'intensities': np.zeros(2, np.float32)}
    scan = SCAN(header(0, 'sonar'), *np.zeros(7), **values)
    assert beyond(scan) == {'sensor_msgs__msg__LaserScan.ranges'}


def test_what_is_finite_and_larger_than_asked_is_named():
    assert beyond(vector((1.0, -2e9, 1e9)), 1e9) == {'geometry_msgs__msg__Vector3.y'}


def test_an_unknown_number_passes_where_it_may_and_a_huge_one_does_not():
    assert beyond(vector((math.nan, math.inf, 0.0)), 1e9, unknown=True) == set()
    assert beyond(vector((math.inf, 1e300, 0.0)), 1e9, unknown=True) == {
        'geometry_msgs__msg__Vector3.y'
    }
