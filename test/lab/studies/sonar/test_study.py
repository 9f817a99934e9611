"""How far the openings read off the image are from truth: as far as documented and stated."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.lab.studies.sonar.report import scatter
from trawl_ros.lab.studies.sonar.study import CASES, COMPANY, STATES, TOLD, SonarStudy, figures
from trawl_ros.model.gear_model import GearModel

SWEEPS = 40


@pytest.fixture(scope='module')
def study(default_model: GearModel) -> SonarStudy:
    return SonarStudy(SWEEPS, model=default_model, seed=11)


def test_with_the_speed_of_sound_set_right_the_reading_is_the_truth(study: SonarStudy) -> None:
    measured = study.measure(TOLD)
    height = figures(measured.height, measured.true_height)
    width = figures(measured.width, measured.true_width)
    assert (height.read, width.read) == (SWEEPS, SWEEPS)
    assert abs(height.bias) < 0.1
    assert abs(width.bias) < 0.3
    assert height.worst < 0.5
    assert width.worst < 1.0


def test_readings_scatter_as_stated_and_are_off_by_the_speed_of_sound(study: SonarStudy) -> None:
    stated = load_instruments().sonar
    measured = [study.measure(STATES[number]) for number in (2, 3, 5)]
    together = scatter(measured)
    assert 0.5 < together['height'] / stated.opening_height.stated_std_m < 1.6
    assert 0.5 < together['width'] / stated.opening_width.stated_std_m < 1.6
    for case in measured:
        height = figures(case.height, case.true_height)
        width = figures(case.width, case.true_width)
        assert height.unread == 0
        assert width.unread <= 0.1 * SWEEPS
        # 1500 m/s are set where it is about 1483 m/s.
        assert height.bias == pytest.approx(0.0115 * case.true_height.mean(), abs=0.15)
        # The widest meshes lie between two beams: a side of the net is seen as 0.5 m nearer.
        assert width.bias == pytest.approx(0.0115 * case.true_width.mean(), abs=1.0)


def test_fish_between_the_ropes_change_nothing_and_around_the_net_nothing_is_read(
    study: SonarStudy,
) -> None:
    alone, dense, around = (study.measure(case) for case in (STATES[3], COMPANY[1], COMPANY[3]))
    for name in ('height', 'width'):
        clear = figures(getattr(alone, name), getattr(alone, f'true_{name}'))
        fishy = figures(getattr(dense, name), getattr(dense, f'true_{name}'))
        assert fishy.unread <= 0.05 * SWEEPS
        assert fishy.bias == pytest.approx(clear.bias, abs=0.1)
        assert fishy.worst < clear.worst + 1.0
        assert np.isnan(getattr(around, name)).mean() > 0.95


def test_figures_leave_out_what_was_not_read() -> None:
    found = figures(np.array([1.0, math.nan, 4.0]), np.array([0.0, 0.0, 1.0]))
    assert (found.bias, found.scatter, found.worst) == (2.0, 1.0, 3.0)
    assert (found.read, found.unread) == (2, 1)
    assert math.isnan(figures(np.array([math.nan]), np.zeros(1)).bias)


def test_the_command_writes_the_table_and_the_picture(coarse_gear: Path, tmp_path: Path) -> None:
    out = tmp_path / 'report'
    arguments = ['study', 'sonar', '--out', str(out), '--sweeps', '2', '--gear', str(coarse_gear)]
    result = CliRunner().invoke(trawl, arguments)
    assert result.exit_code == 0, result.output
    assert f'2 sweeps of each of {len(CASES)} cases' in result.output
    assert sorted(p.name for p in out.iterdir()) == [
        f'sonar.{kind}' for kind in ('html', 'json', 'md', 'png')
    ]
    record = json.loads((out / 'sonar.json').read_text())
    assert [row['name'] for row in record['cases']] == [case.name for case in CASES]
    assert all(case.name in (out / 'sonar.md').read_text() for case in CASES)
    refused = CliRunner().invoke(trawl, arguments)
    assert refused.exit_code == 1
    assert 'force' in refused.output
