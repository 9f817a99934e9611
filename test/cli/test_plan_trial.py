"""``trawl plan-trial`` prints a plan, and writes it so that it can be towed."""

import json

import pytest
import yaml

from trawl_ros.estimation.fit.laws import QUANTITIES
from trawl_ros.scenario.scenario import load_scenario

FEW = ('--warps', '200', '--speeds', '2.5,2.3', '--hours', '0.6')


@pytest.fixture
def done(run, coarse_gear, tmp_path):
    return run('plan-trial', coarse_gear, *FEW, '--out', tmp_path / 'out')


def test_prints_and_writes_a_plan_that_can_be_towed(done, run, coarse_gear, tmp_path):
    assert done.exit_code == 0, done.output
    assert all(name in done.stdout for name in QUANTITIES)
    found = json.loads((tmp_path / 'out' / 'plan.json').read_text())
    assert found['minutes'] <= found['budget_minutes'] == 36.0
    assert tuple(found['quantities']) == QUANTITIES
    for one in found['quantities'].values():
        assert (one['limited_by'] is None) == one['well_known']
    assert found['trials'][0]['name'] == 'plan'
    assert (
        found['well_known_by_steady_parts'] <= found['well_known_by_whole_tow'] <= len(QUANTITIES)
    )
    assert found['windows_only'] is None

    scenario = load_scenario(tmp_path / 'out' / 'trial.yaml')
    assert scenario.duration_s == 60.0 * found['minutes']
    towed = [
        (command.port_length, command.starboard_length, command.speed)
        for step, (_, command) in zip(scenario.record.steps, scenario.commands, strict=True)
        if 'on the way' not in step.name
    ]
    planned = [(leg['port_length'], leg['starboard_length'], leg['speed']) for leg in found['legs']]
    assert towed == planned
    assert (scenario.start.port_length, scenario.start.speed) == (towed[0][0], towed[0][2])
    assert yaml.safe_load((tmp_path / 'out' / coarse_gear.name).read_text())['name'] == 'kaifuha'
    assert (tmp_path / 'out' / 'plan.png').stat().st_size > 10_000

    again = run('plan-trial', coarse_gear, *FEW, '--out', tmp_path / 'out')
    assert again.exit_code == 1
    assert str(tmp_path / 'out') in again.stderr


def test_says_what_is_wrong_with_the_question(run, coarse_gear):
    done = run('plan-trial', 'no-such-gear')
    assert done.exit_code == 1
    assert 'no-such-gear' in done.stderr
    few = ('--warps', '200', '--speeds', '2.5')
    done = run('plan-trial', coarse_gear, *few, '--hours', '0.05')
    assert done.exit_code == 1
    assert '0.05 h' in done.stderr
    done = run('plan-trial', coarse_gear, *few, '--max-tension', '20')
    assert done.exit_code == 1
    assert 'tension' in done.stderr
    for wrong in (('--warps', '5'), ('--speeds', 'fast'), ('--hours', '0')):
        assert run('plan-trial', coarse_gear, *wrong).exit_code == 2


def test_reads_and_prints_the_units_of_a_bridge(run, coarse_gear):
    words = ('--warps', '110fm', '--speeds', '4.5,4.9', '--hours', '0.6', '--max-tension', '30')
    done = run('plan-trial', coarse_gear, *words, '--units', 'sea,warp=fm')
    assert done.exit_code == 0, done.output
    head, leg = done.stdout.splitlines()[:2]
    assert 'warps, fm' in head
    assert 'speed, kn' in head
    assert leg.split()[1].split('/')[-1] == '110'
    assert float(leg.split()[2]) in {4.5, 4.9}
