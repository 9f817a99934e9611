"""The chain for a quarter of an hour at sea: memory stays, nothing lags, all fits on one core.

It is towed with a coarse net and truth every two seconds, which takes a minute; the day of
`docs/studies/soak.md` has truth four times as often.
"""

import pytest
from click.testing import CliRunner

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.cli.main import trawl
from trawl_ros.core.progress import ignore
from trawl_ros.lab.studies.soak.rows import soak_rows
from trawl_ros.lab.studies.soak.study import SoakPlan, run_soak

pytestmark = pytest.mark.ros


@pytest.mark.slow
@pytest.mark.timeout(400)
def test_a_quarter_of_an_hour_at_sea(coarse_gear, tmp_path):
    plan = SoakPlan(hours=0.25, gear=str(coarse_gear), real_time_s=5.0, truth_rate_hz=0.5)
    soak = run_soak(plan, tmp_path, ignore, lambda: False)
    rows = soak_rows(soak)
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


@pytest.mark.parametrize(
    ('options', 'sentence'),
    [
        (['--gear', 'unheard-of'], 'kaifuha.yaml'),
        (['--hours', '100'], '--hours'),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, options, sentence):
    out = tmp_path / 'out'
    result = CliRunner().invoke(trawl, ['study', 'soak', '--out', str(out), *options])
    assert result.exit_code != 0
    assert sentence in result.output
    assert not out.exists()
