"""``trawl identify --steady`` uses what a bag holds, and says what it lacks."""

import itertools
import json
import math

import pytest

from trawl_ros.bags.writer import BagWriter
from trawl_ros.estimation.bag_windows import BagTask, read_tow, read_tows
from trawl_ros.estimation.fit.laws import LAWS, QUANTITIES
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.gear.load import load_gear
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.samples import RangeSample
from trawl_ros.records.topics import NAMESPACE


@pytest.fixture
def identify(run, coarse_gear):
    """Run ``trawl identify --steady`` with the gear that the bags were made with."""
    return lambda *arguments: run('identify', '--steady', '--gear', coarse_gear, *arguments)


@pytest.fixture(scope='module')
def bag(steady_tow, tmp_path_factory):
    return steady_tow.bag(tmp_path_factory.mktemp('bags') / 'steady')


def result_in(folder):
    return json.loads((folder / 'identification.json').read_text())


def test_writes_the_result_and_figures_and_prints_tables(identify, bag, trial, tmp_path):
    out = tmp_path / 'out'
    done = identify(bag, '--out', out, '--truth', trial)
    assert done.exit_code == 0, done.output
    found = result_in(out)
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
    assert found['held_out_by'] == 'state'
    assert 10.0 < found['laws']['attack_deg'] < 40.0
    assert list(found['laws']['quantities']) == list(QUANTITIES)
    assert len(list(out.glob('*.png'))) == 9
    page = (out / 'report.html').read_text()
    assert all(law.name in page for law in LAWS)
    assert 'truth' in done.stdout
    assert 'eq. 35' in done.stdout


@pytest.mark.usefixtures('rough_pictures')
def test_of_several_bags_each_is_left_out_and_what_is_readable_of_a_damaged_one_is_used(
    identify, steady_tow, bag, tmp_path
):
    other = steady_tow.bag(tmp_path / 'other', seed=1, leg_s=600)  # long enough for several chunks
    whole = (other / 'other_0.mcap').read_bytes()
    cut = tmp_path / 'cut.mcap'
    cut.write_bytes(whole[: len(whole) * 3 // 4])
    out = tmp_path / 'out'
    out.mkdir()
    (out / 'identification.json').write_text('mine')
    done = identify(bag, cut, '--out', out)
    assert done.exit_code == 1
    assert str(out) in done.stderr
    assert (out / 'identification.json').read_text() == 'mine'
    done = identify(bag, cut, '--out', out, '--force')
    assert done.exit_code == 0, done.output
    assert str(cut) in done.stderr
    found = result_in(out)
    assert found['held_out_by'] == 'tow'
    assert [tow['name'] for tow in found['tows']] == [str(bag), str(cut)]
    assert sum(tow['windows'] for tow in found['tows']) == found['windows']
    for tow in found['tows']:
        assert all(math.isfinite(error) for error in tow['mnae_held_out'].values())


@pytest.mark.slow
def test_bags_read_at_once_and_in_turn_hold_the_same(steady_tow, bag, coarse_gear, tmp_path):
    gear = load_gear(coarse_gear)
    bags = [bag, steady_tow.bag(tmp_path / 'other', seed=1), bag]
    at_once = read_tows(bags, gear, NAMESPACE)
    in_turn = [read_tow(BagTask(path, gear, NAMESPACE)) for path in bags]
    assert [part.name for part in at_once] == [str(path) for path in bags]
    for one, other in zip(at_once, in_turn, strict=True):
        assert one.windows == other.windows
        assert len(one.windows) >= 2
        assert one.rejections.counts == other.rejections.counts
        assert one.readings == other.readings


@pytest.mark.usefixtures('rough_pictures')
def test_a_bag_without_windows_is_named_and_without_the_prior_all_is_less_known(
    identify, steady_tow, bag, tmp_path
):
    short = steady_tow.write(tmp_path / 'short', itertools.islice(steady_tow.samples(), 500))
    done = identify(bag, short, '--out', tmp_path / 'out', '--no-prior')
    assert done.exit_code == 0, done.output
    assert str(short) in done.stderr
    # 1.8 times 200 m of warp and as much for the net, at 2.3 m/s.
    assert '313 s' in done.stderr
    found = result_in(tmp_path / 'out')
    assert not found['prior_used']
    assert [tow['name'] for tow in found['tows']] == [str(bag)]
    prior = load_gear('kaifuha').identification.std
    wider = [entry['std'] > std for entry, std in zip(found['coefficients'].values(), prior)]
    assert any(wider)


def test_a_missing_bag_and_an_empty_one(identify, tmp_path):
    done = identify(tmp_path / 'none', '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert str(tmp_path / 'none') in done.stderr
    with BagWriter(tmp_path / 'empty'):
        pass
    done = identify(tmp_path / 'empty', '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert str(tmp_path / 'empty') in done.stderr
    assert not (tmp_path / 'out').exists()


def test_channels_that_are_not_there_are_named(identify, steady_tow, tmp_path):
    deaf = (sample for sample in steady_tow.samples() if not isinstance(sample, RangeSample))
    bag = steady_tow.write(tmp_path / 'bag', deaf)
    done = identify(bag, '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert 'door/spread' in done.stderr
    assert not (tmp_path / 'out').exists()


def test_topics_of_another_namespace_are_found_when_it_is_named(identify, bag, tmp_path):
    done = identify(bag, '--out', tmp_path / 'out', '--namespace', 'other')
    assert done.exit_code == 1
    assert not (tmp_path / 'out').exists()
