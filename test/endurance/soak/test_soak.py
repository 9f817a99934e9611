"""The chain for a quarter of an hour at sea: memory stays, nothing lags, all fits on one core.

It is towed with a coarse net and truth every two seconds, which takes a minute; a day at full size
has truth four times as often.
"""

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from endurance.soak.rows import soak_rows
from endurance.soak.run import SoakPlan, run_soak
from endurance.table import FULL
from trawl_ros.core.progress import ignore

pytestmark = pytest.mark.ros


@pytest.mark.slow
@pytest.mark.timeout(0 if FULL else 400)
def test_a_tow_through_the_graph_grows_in_nothing(coarse_gear, tmp_path, show):
    plan = SoakPlan(hours=0.25, gear=str(coarse_gear), real_time_s=5.0, truth_rate_hz=0.5)
    if FULL:
        plan = SoakPlan(hours=24.0, gear='kaifuha', real_time_s=60.0)
    soak = run_soak(plan, tmp_path, ignore, lambda: False)
    rows = soak_rows(soak)
    show(f'{plan.hours:g} h at sea', rows)
    missed = [f'{row.what}: {row.value:.3g} {row.unit}' for row in rows if not row.ok]
    assert not missed
    assert sum(row.target is not None for row in rows) == 13
    assert [path.name for path in tmp_path.iterdir()] == ['log'], 'the bag is gone again'


def test_it_may_be_ended_early(coarse_gear, tmp_path):
    plan = SoakPlan(hours=5.0, gear=str(coarse_gear), real_time_s=5.0)
    asked = iter(range(10**6))
    soak = run_soak(plan, tmp_path, ignore, lambda: next(asked) > 20)
    assert not soak.real
    assert all(glance.data_s < 3600.0 for glance in soak.fast)
    assert not soak_rows(soak)[0].ok
    assert [path.name for path in tmp_path.iterdir()] == ['log'], 'the bag is gone again'
