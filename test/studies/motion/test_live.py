"""Figures of the live chain: both nodes count together, and no estimate at all is a miss."""

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from studies.live_nodes import LiveNodes
from studies.motion.live import live_chain_rows

SHARES = {'identification_node': 6.0, 'discrepancy_node': 5.5}


def test_both_nodes_count_together_and_the_latest_estimate_counts():
    share, delay = live_chain_rows(LiveNodes(SHARES, (), (4.2, 4.8, 4.5), 3, 300.0))
    assert share.value == pytest.approx(11.5)
    assert share.ok
    assert 'discrepancy_node 5.5 %' in share.note
    assert (delay.value, delay.low, delay.high) == (4.8, 4.2, 4.8)
    assert delay.ok


def test_no_estimate_and_a_chain_too_dear_are_misses():
    dear = {name: 2.0 * share for name, share in SHARES.items()}
    share, delay = live_chain_rows(LiveNodes(dear, (), (), 0, 300.0))
    assert not share.ok
    assert not delay.ok
