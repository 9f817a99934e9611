"""Rows of a soak tell a leak from steady memory, and a growing delay from a changing one."""

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from endurance.soak.rows import WARM_SHARE, soak_rows
from endurance.soak.run import Soak, SoakPlan
from endurance.watching import Glance
from trawl_ros.lab.report.measured import at_most
from trawl_ros.lab.running.chain import CHAIN, CONSUMERS

HOURS = 10.0
NUMBER = 200


def glances(memory=lambda share: 100.0, delay=lambda share: 0.5, cpu=0.1, pace=36.0):
    """Glances of a tow on which all nodes do alike, but for one's memory and another's delay."""
    rng = np.random.default_rng(7)
    for share in np.linspace(0.0, 1.0, NUMBER):
        data_s = 3600.0 * HOURS * share
        yield Glance(
            data_s=data_s,
            wall_s=data_s / pace,
            memory_mb={
                **dict.fromkeys(CHAIN, 200.0),
                'winch_node': memory(share) + rng.normal(0.0, 0.2),
            },
            cpu_s=dict.fromkeys(CHAIN, cpu * data_s / pace),
            delay_s={
                **dict.fromkeys(CONSUMERS, 0.5),
                'vessel_node': delay(share) + rng.exponential(0.3),
            },
        )


def rows_of(**kinds):
    plan = SoakPlan(HOURS, 'kaifuha', 60.0)
    seen = tuple(glances(**kinds))
    return {row.what: row for row in soak_rows(Soak(plan, seen, tuple(glances(pace=1.0)), 50.0))}


def test_what_is_steady_meets_every_target():
    rows = rows_of()
    assert all(row.ok for row in rows.values())
    assert rows['winch_node: growth of memory'].value == pytest.approx(0.0, abs=0.2)
    assert rows['times real time'].value == pytest.approx(36.0)
    assert rows['bag'].value == pytest.approx(5.0)


@pytest.mark.parametrize(('whole', 'ok'), [(4.0, True), (8.0, False)])
def test_memory_that_grows_is_found(whole, ok):
    row = rows_of(memory=lambda share: 100.0 + whole * share)['winch_node: growth of memory']
    assert row.low <= row.value <= row.high
    mean = 100.0 + whole * (1.0 + WARM_SHARE) / 2
    assert row.value == pytest.approx(100.0 * whole * (1.0 - WARM_SHARE) / mean, rel=0.1)
    assert row.ok is ok


def test_what_memory_does_while_it_warms_up_does_not_count():
    grown = rows_of(memory=lambda share: 100.0 if share > WARM_SHARE else 50.0)
    assert grown['winch_node: growth of memory'].ok


def test_a_delay_that_grows_is_found_and_one_that_only_varies_is_not():
    rows = rows_of(delay=lambda share: 0.5 + 2.0 * share)
    assert not rows['vessel_node: growth of the delay'].ok
    assert rows['winch_node: growth of the delay'].ok


def test_shares_of_a_core_add_up():
    rows = rows_of()
    assert rows['sim_node: in real time'].value == pytest.approx(10.0)
    assert rows['the chain in real time'].value == pytest.approx(10.0 * len(CHAIN))
    assert rows['the chain in real time'].target == at_most(100.0)


def test_a_tow_that_ended_early_says_so():
    plan = SoakPlan(HOURS, 'kaifuha', 60.0)
    rows = soak_rows(Soak(plan, tuple(glances())[: NUMBER // 2], (), 50.0))
    (missing,) = (row for row in rows if row.what == 'tow that is missing to the whole')
    assert missing.value == pytest.approx(HOURS / 2, rel=0.02)
    assert not missing.ok
    assert not soak_rows(Soak(plan, (), (), 0.0))[0].ok
