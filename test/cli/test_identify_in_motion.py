"""``trawl identify`` learns from all of the tow, or says why it cannot."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from trawl_ros.diagnosis.onset.knowledge import of_identification
from trawl_ros.estimation import bag_motion
from trawl_ros.estimation.from_gear import NET_STD
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.processes import ErrorSizes
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import EffectRecord
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.samples import VelocitySample, WinchSample
from trawl_ros.records.topics import NAMESPACE

pytestmark = pytest.mark.usefixtures('rough_pictures')

SECOND = 1_000_000_000


@pytest.fixture
def identify(run, coarse_gear):
    """Run ``trawl identify`` with the gear that the bags were made with."""
    return lambda *arguments: run('identify', '--gear', coarse_gear, *arguments)


@pytest.fixture(scope='module')
def still_bag(steady_tow, tmp_path_factory):
    """Eleven minutes in one steady state, of which the model is the plant."""
    still = replace(steady_tow, states=(steady_tow.states[0],))
    return still.bag(tmp_path_factory.mktemp('bags') / 'still', leg_s=661)


@pytest.fixture(scope='module')
def rolling_bag(steady_tow, tmp_path_factory):
    """The same in a swell, in which the tension swings by 5 % of itself."""
    still = replace(steady_tow, states=(steady_tow.states[0],))
    path = tmp_path_factory.mktemp('bags') / 'rolling'
    return still.write(path, swinging(still.samples(leg_s=661)))


def swinging(samples):
    for sample in samples:
        if isinstance(sample, WinchSample):
            wave = np.sin(2.0 * np.pi * sample.stamp / SECOND / 10.0)
            tensions = np.array(sample.tensions) * (1.0 + 0.05 * np.sqrt(2.0) * wave)
            sample = replace(sample, tensions=(float(tensions[0]), float(tensions[1])))
        yield sample


def result_in(folder):
    return json.loads((folder / 'identification.json').read_text())


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_still_tow_of_the_model_comes_to_rest(identify, still_bag, tmp_path):
    done = identify(still_bag, '--out', tmp_path / 'out')
    assert done.exit_code == 0, done.output
    found = result_in(tmp_path / 'out')
    assert found['converged'], found['reason']
    assert found['chain']['fitted'] == 'the whole tow'
    # What errors count for the model's own is not in it, as the model is the plant.
    assert found['misfit'] < 1.5


@pytest.mark.parametrize('option', ['--motion', '--steady'])
def test_the_estimate_is_that_of_the_chain(identify, rolling_bag, tmp_path, monkeypatch, option):
    # Any step is taken for rest, with errors as stated: it is enough to be shown.
    quick = partial(MotionOptions, iterations=3, tolerance=np.inf, estimate_sizes=False)
    monkeypatch.setattr(bag_motion, 'MotionOptions', quick)
    out = tmp_path / 'out'
    done = identify(option, rolling_bag, '--out', out)
    assert done.exit_code == 0, done.output
    found = result_in(out)
    assert list(found['coefficients']) == list(COEFFICIENTS)
    assert found['windows'] >= 1
    chain = found['chain']
    assert chain['sizes'] == ErrorSizes().record()
    assert of_identification(out / 'identification.json').sizes == ErrorSizes()
    prior = load_gear('kaifuha').identification.std
    for row, known in zip(found['coefficients'].values(), prior, strict=True):
        assert row['low'] <= row['value'] <= row['high']
        assert 0.0 < row['std'] <= 1.01 * known
    biases = found['tows'][0]['biases']
    assert {'port_length', 'speed', 'door_spread'} <= set(biases)
    assert all(bias['std'] <= 1.01 * bias['known'] for bias in biases.values())
    assert chain['left_out'][0]['why']
    assert chain['counted_s'] == (330.0 if option == '--steady' else 360.0)
    assert ('the steady parts' if option == '--steady' else 'the whole tow') in done.stdout
    # One tow in one state leaves nothing to learn from when it is left out.
    assert {row['mnae_held_out'] for row in found['channels'].values()} == {None}
    assert [each['swing'] for each in chain['swells']] == [pytest.approx(0.05, rel=0.15)]


def test_a_fit_that_does_not_come_to_rest_leaves_the_windows_and_that_is_told(
    identify, still_bag, tmp_path, monkeypatch
):
    never = partial(MotionOptions, iterations=1, tolerance=0.0, estimate_sizes=False)
    monkeypatch.setattr(bag_motion, 'MotionOptions', never)
    out = tmp_path / 'out'
    done = identify(still_bag, '--out', out)
    assert done.exit_code == 0, done.output
    found = result_in(out)
    assert found['windows'] >= 1
    assert '1 iterations' in found['chain']['refused']


@pytest.fixture(scope='module')
def restless_bag(steady_tow, tmp_path_factory):
    """Ten minutes of a ship that goes faster and slower all the time; no winch tells its speed."""
    still = replace(steady_tow, states=(steady_tow.states[0],))
    path = tmp_path_factory.mktemp('bags') / 'restless'
    return still.write(path, swaying(still.samples(leg_s=601)))


STRUMMING = """
effects:
  - name: warp_strumming
    values: {factor: 1.1}
"""


def swaying(samples):
    for sample in samples:
        if isinstance(sample, VelocitySample):
            share = 1.0 + 0.06 * np.sin(2.0 * np.pi * sample.stamp / SECOND / 90.0)
            sample = replace(sample, velocity=share * sample.velocity)
        elif isinstance(sample, WinchSample):
            sample = replace(sample, speeds=(np.nan, np.nan))
        yield sample


def test_without_one_steady_window_all_of_the_tow_is_learned_from_and_that_is_told(
    run, coarse_gear, restless_bag, tmp_path, monkeypatch
):
    quick = partial(MotionOptions, iterations=1, attempts=1, estimate_sizes=False)
    monkeypatch.setattr(bag_motion, 'MotionOptions', quick)
    out, laden = tmp_path / 'out', tmp_path / 'laden.yaml'
    laden.write_text(Path(coarse_gear).read_text() + STRUMMING)
    done = run('identify', '--net', '--gear', laden, restless_bag, '--out', out)
    assert done.exit_code == 0, done.output
    opening = done.stdout.splitlines()[0]
    assert '5 min' in opening
    assert opening.split(',')[0] in (out / 'report.html').read_text()
    found = result_in(out)
    assert found['windows'] == 0
    prior = load_gear('kaifuha').identification.std
    for row, known in zip(found['coefficients'].values(), prior, strict=True):
        assert 0.0 < row['std'] <= 1.01 * known
    assert found['chain']['tows'] == [str(restless_bag)]
    assert 0.0 < found['net']['drag']['std'] < NET_STD
    assert done.stdout.count('Drag of the net:') == 1


@pytest.mark.parametrize('option', ['--steady', '--no-prior'])
def test_without_one_steady_window_what_cannot_be_had_in_motion_is_refused(
    run, coarse_gear, restless_bag, tmp_path, option
):
    out = tmp_path / 'out'
    done = run('identify', option, '--gear', coarse_gear, restless_bag, '--out', out)
    assert done.exit_code == 1


def test_neither_windows_nor_motion_is_refused_with_both_reasons(
    run, coarse_gear, steady_tow, tmp_path
):
    short = steady_tow.bag(tmp_path / 'short', leg_s=250)
    done = run('identify', '--gear', coarse_gear, short, '--out', tmp_path / 'out')
    assert done.exit_code == 1
    assert all(figure in done.stderr for figure in (' 499 s', ' 600 s'))


def tows_of(gear, bag):
    """Tows in motion of a bag, and the sentences on what cannot be used."""
    tows, numbers, refused = bag_motion.moving_tows(
        gear, [SimpleNamespace(name=str(bag), windows=())], NAMESPACE, lambda progress: None
    )
    assert len(tows) == len(numbers)
    return tows, refused


def without_log(samples, begin, end):
    for sample in samples:
        if not (isinstance(sample, VelocitySample) and begin < sample.stamp / SECOND < end):
            yield sample


def test_a_tow_too_short_is_refused_and_told(gear, steady_tow, tmp_path):
    tows, refused = tows_of(gear, steady_tow.bag(tmp_path / 'bag', leg_s=250))
    assert not tows
    (told,) = refused
    assert all(part in told for part in (str(tmp_path / 'bag'), ' 499 s', ' 600 s'))


def test_a_log_that_falls_silent_divides_a_tow(gear, steady_tow, tmp_path):
    samples = list(steady_tow.samples(leg_s=700))
    bag = steady_tow.write(tmp_path / 'bag', without_log(samples, 690, 730))
    tows, refused = tows_of(gear, bag)
    assert not refused
    assert [tow.name for tow in tows] == [f'{bag}, part 1', f'{bag}, part 2']
    assert len(tows[0]) == 690 // 30
    assert 20 <= len(tows[1]) <= 22
    assert tows[1].start_ns >= 730 * SECOND
    # An effect that grows through a tow does not begin anew with its second part.
    away_h = (tows[1].start_ns - tows[0].start_ns) / SECOND / 3600.0
    assert [tow.inputs.hours for tow in tows] == pytest.approx([0.0, away_h])
    assert np.all(tows[1].counts[:, tows[1].channels.index('door_spread')] >= 28)


def test_a_log_that_leaves_no_part_long_enough_is_told(gear, steady_tow, tmp_path):
    bag = steady_tow.write(tmp_path / 'bag', without_log(steady_tow.samples(), 390, 430))
    tows, refused = tows_of(gear, bag)
    assert not tows
    assert ' 600 s' in refused[0]


def test_what_is_asked_for_beside_and_cannot_be_had_in_motion_is_told(gear, pair_gear):
    assert bag_motion.why_windows_alone(gear, prior=True) is None
    assert 'prior' in bag_motion.why_windows_alone(gear, prior=False)
    assert 'no boards' in bag_motion.why_windows_alone(pair_gear, prior=True)


def test_effects_of_the_gear_file_and_an_unknown_net_are_towed(gear):
    sheared = EffectRecord(name='current_shear', values={'along': 0.05})
    towed = bag_motion.towed_gear(gear.model_copy(update={'effects': (sheared,)}), net=True)
    assert [active.name for active in towed.acting.effects] == ['current_shear']
    assert towed.net_std == NET_STD
    assert bag_motion.towed_gear(gear, net=False).net_std == 0.0


def test_who_stops_it_on_the_way_has_the_results_of_the_windows(
    identify, still_bag, tmp_path, monkeypatch
):
    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(bag_motion, 'fit_motion', stopped)
    out = tmp_path / 'out'
    done = identify(still_bag, '--out', out)
    assert done.exit_code != 0
    found = result_in(out)
    assert found['windows'] >= 1
    assert 'chain' not in found
    assert (out / 'report.html').exists()


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_of_several_bags_all_are_learned_from_and_one_that_cannot_be_is_told(
    identify, steady_tow, still_bag, tmp_path, monkeypatch
):
    quick = partial(MotionOptions, iterations=3, tolerance=np.inf, estimate_sizes=False)
    monkeypatch.setattr(bag_motion, 'MotionOptions', quick)
    other = replace(steady_tow, states=(steady_tow.states[1],))
    second = other.bag(tmp_path / 'second', leg_s=661, seed=1)
    short = other.bag(tmp_path / 'short', leg_s=500, seed=2)
    done = identify(still_bag, second, short, '--out', tmp_path / 'out')
    assert done.exit_code == 0, done.output
    found = result_in(tmp_path / 'out')
    assert found['chain']['tows'] == [str(still_bag), str(second)]
    (told,) = found['chain']['not_used']
    assert all(part in told for part in (str(short), ' 499 s', ' 600 s'))
    assert all(np.isfinite(row['mnae_held_out']) for row in found['channels'].values())
