"""``trawl diagnose`` and ``trawl effects`` from outside."""

import json
from dataclasses import replace

import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.effects.registry import catalogue
from trawl_ros.records.samples import RangeSample


@pytest.fixture
def run():
    return lambda *args: CliRunner().invoke(trawl, [str(arg) for arg in args])


def test_a_bag_of_two_states_cannot_tell(run, steady_tow, coarse_gear, tmp_path):
    bag = steady_tow.bag(tmp_path / 'bag')
    out = tmp_path / 'out'
    done = run('diagnose', bag, '--out', out, '--gear', coarse_gear)
    assert done.exit_code == 11, done.output
    assert 'NOT_TESTABLE' in done.output
    found = json.loads((out / 'diagnosis.json').read_text())
    assert found['verdict'] == 'NOT_TESTABLE'
    assert found['reason'] in done.output
    assert len(found['bags'][0]['sha256']) == 64
    again = run('diagnose', bag, '--out', out, '--gear', coarse_gear)
    assert again.exit_code == 1
    assert str(tmp_path / 'out') in again.output


def test_one_channel_cannot_tell(run, steady_tow, coarse_gear, tmp_path):
    alone = [s for s in steady_tow.samples(leg_s=60) if type(s).__name__ == 'WinchSample']
    bag = steady_tow.write(tmp_path / 'bag', alone)
    done = run('diagnose', bag, '--out', tmp_path / 'out', '--gear', coarse_gear)
    assert done.exit_code == 11, done.output
    assert (tmp_path / 'out' / 'report.html').exists()


@pytest.mark.parametrize('spread', [float('nan'), 120.0])
def test_a_dead_sensor_cannot_tell(run, steady_tow, coarse_gear, tmp_path, spread):
    """All NaN, and the same number all the time."""
    samples = [
        replace(sample, distance=spread) if isinstance(sample, RangeSample) else sample
        for sample in steady_tow.samples()
    ]
    bag = steady_tow.write(tmp_path / 'bag', samples)
    done = run('diagnose', bag, '--out', tmp_path / 'out', '--gear', coarse_gear)
    assert done.exit_code == 11, done.output
    assert 'door_spread' in done.output or 'frozen' in done.output


def test_what_is_no_bag_is_refused(run, tmp_path):
    done = run('diagnose', tmp_path / 'nowhere', '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert 'nowhere' in done.output
    assert not (tmp_path / 'out').exists()


def test_effects_are_listed_and_told(run):
    listed = run('effects')
    assert listed.exit_code == 0
    assert 'warp_strumming' in listed.output
    told = run('effects', 'heave')
    assert catalogue()['heave'].sentence in told.output.replace('\n', ' ')
    assert 'warp_strumming' not in told.output
    wrong = run('effects', 'ghost')
    assert wrong.exit_code == 2
    assert 'ghost' in wrong.output
