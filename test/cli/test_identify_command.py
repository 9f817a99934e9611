"""``trawl identify`` uses what a bag holds, and says what it lacks."""

import json
import math

import pytest

from trawl_ros.bags.writer import BagWriter
from trawl_ros.identification.objective import PAPER_CHANNELS
from trawl_ros.instruments.samples import RangeSample
from trawl_ros.model.board import COEFFICIENTS


@pytest.fixture
def identify(run, coarse_gear):
    """Run ``trawl identify`` with the gear that the bags were made with."""
    return lambda *arguments: run('identify', '--gear', coarse_gear, *arguments)


@pytest.fixture(scope='module')
def bag(steady_tow, tmp_path_factory):
    return steady_tow.bag(tmp_path_factory.mktemp('bags') / 'steady')


def test_writes_the_result_and_figures_and_prints_tables(identify, bag, trial, tmp_path):
    out = tmp_path / 'out'
    done = identify(bag, '--out', out, '--truth', trial)
    assert done.exit_code == 0, done.output
    found = json.loads((out / 'identification.json').read_text())
    assert found['windows'] >= 2
    assert set(found['objective']) == {'start', 'end', 'truth'}
    assert list(found['coefficients']) == list(COEFFICIENTS)
    for coefficient in found['coefficients'].values():
        assert {'start', 'value', 'std', 'low', 'high', 'shrink', 'determined'} == set(coefficient)
        assert coefficient['low'] <= coefficient['value'] <= coefficient['high']
    assert list(found['channels']) == [channel.name for channel in PAPER_CHANNELS]
    for channel in found['channels'].values():
        assert set(channel) == {'unit', 'mnae_start', 'mnae_end', 'mnae_held_out'}
        assert channel['mnae_end'] < 0.02
        assert math.isfinite(channel['mnae_held_out'])
    assert {'rejected', 'condition_number', 'undetermined'} <= set(found)
    assert len(list(out.glob('*.png'))) >= 3
    assert 'truth' in done.stdout
    assert 'Objective of eq. 35' in done.stdout


def test_results_are_not_written_over_unless_asked(identify, bag, tmp_path):
    (tmp_path / 'identification.json').write_text('mine')
    done = identify(bag, '--out', tmp_path)
    assert done.exit_code == 1
    assert f'{tmp_path}: holds files already' in done.stderr
    assert (tmp_path / 'identification.json').read_text() == 'mine'
    assert identify(bag, '--out', tmp_path, '--force').exit_code == 0
    assert json.loads((tmp_path / 'identification.json').read_text())


def test_what_is_readable_of_a_damaged_bag_is_used_and_said(identify, steady_tow, tmp_path):
    bag = steady_tow.bag(tmp_path / 'bag', leg_s=600)  # long enough for several chunks
    whole = (bag / 'bag_0.mcap').read_bytes()
    cut = tmp_path / 'cut.mcap'
    cut.write_bytes(whole[: len(whole) * 3 // 4])
    done = identify(cut, '--out', tmp_path / 'out')
    assert done.exit_code == 0, done.output
    assert f'Damaged: {cut}: cut short' in done.stderr
    assert json.loads((tmp_path / 'out' / 'identification.json').read_text())['windows'] >= 1


def test_without_the_prior_the_interval_is_wider(identify, bag, tmp_path):
    widths = []
    for name, flags in (('with', ()), ('without', ('--no-prior',))):
        assert identify(bag, '--out', tmp_path / name, *flags).exit_code == 0
        found = json.loads((tmp_path / name / 'identification.json').read_text())
        widths.append(sum(entry['std'] for entry in found['coefficients'].values()))
    assert widths[1] > widths[0]


def test_a_missing_bag_and_an_empty_one(identify, tmp_path):
    done = identify(tmp_path / 'none', '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert f'{tmp_path / "none"}: no such bag' in done.stderr
    with BagWriter(tmp_path / 'empty'):
        pass
    done = identify(tmp_path / 'empty', '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert f'{tmp_path / "empty"}: holds no message' in done.stderr
    assert not (tmp_path / 'out').exists()


def test_channels_that_are_not_there_are_named(identify, steady_tow, tmp_path):
    deaf = (sample for sample in steady_tow.samples() if not isinstance(sample, RangeSample))
    bag = steady_tow.write(tmp_path / 'bag', deaf)
    done = identify(bag, '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert 'without door_spread from door/spread (no readings)' in done.stderr
    assert not (tmp_path / 'out').exists()


def test_topics_of_another_namespace_are_found_when_it_is_named(identify, bag, tmp_path):
    done = identify(bag, '--out', tmp_path / 'out', '--namespace', 'other')
    assert done.exit_code == 1
    assert 'nothing is estimated' in done.stderr
