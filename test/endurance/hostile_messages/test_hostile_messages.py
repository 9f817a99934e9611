"""Every subscription of every node bears messages that make no sense."""

import math

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from endurance.hostile_messages.attack import RANGE, unsound  # noqa: E402
from endurance.hostile_messages.mutations import hostile_bytes  # noqa: E402
from endurance.hostile_messages.rows import measured_rows  # noqa: E402
from endurance.hostile_messages.run import run_hostile  # noqa: E402
from endurance.table import FULL  # noqa: E402
from trawl_ros.core.errors import MessageError  # noqa: E402
from trawl_ros.messages.cdr import deserialize, serialize  # noqa: E402
from trawl_ros.messages.commands import winch_command  # noqa: E402
from trawl_ros.messages.fields import beyond  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.records.rights import NODE_RIGHTS  # noqa: E402
from trawl_ros.records.samples import RangeSample  # noqa: E402

pytestmark = pytest.mark.ros
JOINTS = 'sensor_msgs/msg/JointState'


def test_hostile_messages_are_of_many_kinds():
    sound = serialize(winch_command(5_000_000_000, 300.0, 301.0)[1])
    rng = np.random.default_rng(4)
    unread, stamps, nonsense = 0, set(), 0
    for _ in range(500):
        try:
            message = deserialize(hostile_bytes(sound, JOINTS, rng), JOINTS)
        except MessageError:
            unread += 1
            continue
        stamps.add(message.header.stamp.sec)
        nonsense += bool(beyond(message))
    assert unread > 50
    assert nonsense > 10
    assert {-5, 2**31 - 1} <= stamps


@pytest.mark.parametrize(('distance', 'fields'), [
    (math.inf, set()), (-math.inf, set()), (math.nan, {RANGE}), (120.0, set()),
])  # fmt: skip
def test_an_infinite_range_is_beyond_the_sensor_and_nan_is_nonsense(distance, fields):
    sample = RangeSample(0, 'spread', distance, 1.0, 5.0, 400.0)
    _, message = sample_message(sample)
    assert unsound(message) == fields


@pytest.mark.slow
@pytest.mark.timeout(0 if FULL else 240)
def test_no_node_ends_and_nothing_moves_silently(show):
    steps = []
    messages, minutes = (100_000, 8.0) if FULL else (2000, 3.0)
    found = run_hostile(messages, 7, steps.append, minutes=minutes)
    rows = measured_rows(found)
    show('Hostile messages', rows)
    attacked = {tally.node for tally in found.tallies}
    # The viewers' nodes need libraries of the extra `view`.
    assert set(NODE_RIGHTS) - attacked <= {'foxglove_node', 'view_node'}
    assert [step.done for step in steps] == list(range(len(attacked) + 2))
    assert not [row for row in rows[0 if FULL else 1 :] if not row.ok]
    assert found.moved.windows[0] > 0
