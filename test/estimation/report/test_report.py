"""What is said of an identification: numbers, figures, page and tables."""

import json
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from trawl_ros.estimation.fit.estimator import Estimator
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.report.figures import drawings
from trawl_ros.estimation.report.holdout import hold_out
from trawl_ros.estimation.report.page import objective_line, report_page, write_report
from trawl_ros.estimation.report.report import report
from trawl_ros.estimation.report.residuals import residuals
from trawl_ros.estimation.report.result import result
from trawl_ros.estimation.report.sensors import compare_sensors
from trawl_ros.estimation.report.spectrum import spectrum
from trawl_ros.estimation.report.table import (
    channel_table,
    closing_lines,
    coefficient_table,
    opening_line,
)
from trawl_ros.estimation.report.verdict import verdict
from trawl_ros.estimation.windows.records import REASONS
from trawl_ros.model.board_laws import EQ14
from trawl_ros.records.channels import CHANNELS, INPUTS


def fitted(sea, model, prior, windows):
    identification = Identification(model, prior, sea.OBSERVABLES, sea.pressure_to_depth)
    identification.take(windows)
    identification.estimator.finish()
    return identification


def three_tows(windows):
    """Windows dealt to three tows, each with all warp lengths."""
    return [replace(window, tow=window.index % 3) for window in windows]


@pytest.fixture
def windows(sea, model):
    return sea.trial_windows(model, np.random.default_rng(5), noise=0.3)


@pytest.fixture
def one_tow(sea, model, prior, windows):
    return fitted(sea, model, prior, windows)


@pytest.fixture
def tows(sea, model, prior, windows):
    return fitted(sea, model, prior, three_tows(windows))


def test_the_result_has_what_was_promised(sea, tows):
    found = result(report(tows, truth=sea.TRUTH, tows=('a', 'b', 'c')))
    assert {
        'windows', 'rejected', 'objective', 'coefficients', 'channels', 'condition_number',
        'undetermined', 'converged', 'reason', 'active_bounds', 'covariance', 'singular_values',
        'weak_combinations', 'misfit', 'noise_scales', 'net', 'prior_used', 'held_out_by',
        'accepted', 'tows', 'residuals', 'innovations', 'laws', 'rejected_last',
        'noise_densities', 'sensors',
    } == set(found)  # fmt: skip
    assert set(found['objective']) == {'start', 'end', 'truth'}
    assert found['objective']['end'] < found['objective']['start'] / 3.0
    assert set(found['coefficients']['a1']) == {
        'start', 'value', 'std', 'low', 'high', 'shrink', 'determined',
    }  # fmt: skip
    assert {name: row['unit'] for name, row in found['channels'].items()} == {
        'door_spread': 'm', 'door_depth': 'm', 'warp_tension': 'N', 'net_depth': 'm',
    }  # fmt: skip
    for row in found['channels'].values():
        assert row['mnae_held_out'] < row['mnae_start']
    assert np.array(found['covariance']).shape == (12, 12)
    assert set(found['noise_densities']) == set(tows.estimator.windows[0].noise)
    assert found['accepted'] == {
        'windows': 15, 'readings': dict.fromkeys(tows.estimator.windows[0].counts, 15 * 90)
    }  # fmt: skip
    assert [(tow['name'], tow['windows'], tow['states']) for tow in found['tows']] == [
        ('a', 5, 5), ('b', 5, 5), ('c', 5, 5),
    ]  # fmt: skip
    assert set(found['tows'][0]['biases']['door_spread']) == {'unit', 'value', 'std', 'known'}
    assert set(found['residuals']) == set(found['innovations']) <= set(CHANNELS)
    assert set(found['residuals']['net_depth']) == {
        'unit', 'windows', 'mean', 'std', 'stated_std', 'test_ratio', 'whiteness',
    }  # fmt: skip
    assert json.loads(json.dumps(found, allow_nan=False)) == found


def test_numbers_that_do_not_exist_are_null(sea, model, prior, windows):
    found = result(report(fitted(sea, model, prior, windows[:1])))
    assert found['channels']['door_spread']['mnae_held_out'] is None
    assert found['residuals']['door_spread']['std'] is None
    assert found['residuals']['door_spread']['whiteness'] is None
    assert set(found['objective']) == {'start', 'end'}
    assert json.loads(json.dumps(found, allow_nan=False)) == found


def test_a_tow_with_false_readings_is_predicted_as_if_never_seen(sea, model, prior, windows):
    false = []
    for window in three_tows(windows):
        wrong = 1.05 if window.tow == 1 else 1.0
        means = {**window.means, 'door_spread': wrong * window.means['door_spread']}
        false.append(replace(window, means=means))
    exact = fitted(sea, model, prior, three_tows(windows))
    held, true = hold_out(fitted(sea, model, prior, false).estimator), hold_out(exact.estimator)
    assert (held.by, held.groups) == ('tow', 3)
    rows = [i for i, window in enumerate(false) if window.tow == 1]
    np.testing.assert_allclose(held.predicted[rows, 0], true.predicted[rows, 0], rtol=1e-3)


def test_each_fit_of_the_hold_out_is_told(tows, one_tow):
    told = []
    hold_out(tows.estimator, on_progress=told.append)
    assert [(progress.done, progress.total) for progress in told] == [(0, 3), (1, 3), (2, 3)]
    assert hold_out(one_tow.estimator).by == 'state'


def test_residuals_are_measured_less_modelled(sea, model, prior, windows):
    exact = sea.trial_windows(model, np.random.default_rng(0), noise=0.0)
    for window in exact:
        window.means['vertical_opening'] += 3.0
    parts = fitted(sea, model, prior, exact).estimator.solve(sea.TRUTH)
    found = {row.channel: row for row in residuals(parts)}
    opening, spread = found['vertical_opening'], found['door_spread']
    assert opening.mean == pytest.approx(3.0)
    assert opening.std == pytest.approx(0.0, abs=1e-9)
    part = parts[0]
    row = part.channels.index('vertical_opening')
    inputs = [part.window.std(name) for name in ('port_length', 'starboard_length', 'speed')]
    expected = math.hypot(
        part.window.std('vertical_opening'), *(part.by_inputs[row] * np.array(inputs))
    )
    assert opening.stds[0] == pytest.approx(expected)
    assert opening.test_ratio == pytest.approx(np.mean((3.0 / (3.0 * opening.stds)) ** 2))
    assert spread.mean == pytest.approx(0.0, abs=1e-9)
    assert spread.whiteness is None


def test_sensors_are_compared_in_units_of_the_field(sea, model, prior, windows):
    estimator = fitted(sea, model, prior, windows).estimator
    start, end = (estimator.solve(at) for at in (prior.start, sea.TRUTH))
    found = {
        row.channel: row for row in compare_sensors({'start': [None, *start[1:]], 'refitted': end})
    }
    tension, depth = found['port_tension'], found['net_depth']
    assert (tension.unit, depth.unit) == ('t', 'm')
    assert {row.windows for row in found.values()} == {len(windows) - 1}
    means = np.array([window.means['port_tension'] for window in windows[1:]])
    assert tension.measured == pytest.approx(means.mean() / 9806.65)
    solved = np.array([one.solved[one.channels.index('net_depth')] for one in start[1:]])
    read = np.array([window.means['net_depth'] for window in windows[1:]])
    assert depth.predicted['start'].mean == pytest.approx(solved.mean())
    assert depth.predicted['start'].error == pytest.approx(np.abs(read - solved).mean())
    assert depth.predicted['refitted'].error < depth.predicted['start'].error
    assert compare_sensors({'start': [None], 'refitted': [None]}) == ()


def test_the_page_has_its_parts_in_the_order_of_their_weight(tows):
    page = report_page(report(tows), ())
    order = [
        'class="verdict', 'Measured and predicted', 'The coefficients', 'cannot be determined',
        '<details>', 'Residuals by channel', '</details>',
    ]  # fmt: skip
    places = [page.index(words) for words in order]
    assert places == sorted(places)


def test_a_state_without_steady_state_is_tried_once(sea, model, windows):
    repeated = [*windows[:2], *(replace(window, index=9 + window.index) for window in windows[:2])]
    fit = SimpleNamespace(windows=repeated, predictor=model, observables=sea.OBSERVABLES)
    model.stops_at, model.calls = sea.TRUTH[0] - 1.0, 0
    assert Estimator.solve(fit, sea.TRUTH) == [None] * 4
    # With unequal warps for one, and with equal ones, as a counter may be wrong.
    assert model.calls <= 2 * 2


def test_errors_as_stated_make_a_test_ratio_of_a_ninth(sea, model, windows):
    rng = np.random.default_rng(3)
    noisy = []
    for _ in range(20):
        for window in windows:
            inputs = [window.means[name] for name in INPUTS]
            seen = zip(sea.OBSERVABLES, model.predict(sea.TRUTH, *inputs).values, strict=True)
            means = {name: value for name, value in seen if name in window.means}
            means |= dict(zip(INPUTS, inputs, strict=True))
            means = {name: means[name] + window.std(name) * rng.normal() for name in means}
            noisy.append(replace(window, means=means))
    fit = SimpleNamespace(windows=noisy, predictor=model, observables=sea.OBSERVABLES)
    ratios = [row.test_ratio for row in residuals(Estimator.solve(fit, sea.TRUTH))]
    np.testing.assert_allclose(ratios, 1.0 / 9.0, rtol=0.25)


@pytest.mark.parametrize('weight', [1.0, 0.0])
def test_the_spectrum_is_that_of_the_sensitivities(prior, weight):
    rows = np.random.default_rng(6).normal(size=(30, 12)) * np.logspace(-1, 2, 12)
    scaled = np.linalg.inv(rows.T @ rows + weight * np.eye(12))
    found = spectrum(scaled * np.outer(prior.std, prior.std), prior, weight)
    _, singular, directions = np.linalg.svd(rows)
    np.testing.assert_allclose(found.singular, singular, rtol=1e-6)
    np.testing.assert_allclose(np.abs(np.sum(found.directions * directions, axis=1)), 1.0)
    assert found.name(0) == 'c6'
    assert found.name(11) == 'a1'


def test_start_values_without_a_steady_state_are_told_in_words():
    start = {'start': math.nan, 'end': 0.04}
    told = objective_line(SimpleNamespace(objectives=start))
    assert 'no steady state' in told
    assert 'nan' not in told


def test_the_verdict_speaks_of_tows_where_there_are_several(tows, one_tow):
    several, single = verdict(report(tows)), verdict(report(one_tow))
    assert several.fit.startswith('Tows ')
    assert several.holds
    assert 'door spread' in several.fit
    assert single.fit.startswith('Steady states ')
    assert any('one tow only' in sentence for sentence in single.concerns)
    assert not any('one tow only' in sentence for sentence in several.concerns)


def test_a_fit_that_predicts_badly_is_called_so(tows):
    good = report(tows)
    bad = replace(good, held_out=replace(good.held_out, predicted=1.06 * good.held_out.measured))
    judged = verdict(bad)
    assert not judged.holds
    assert judged.fit.endswith('in door spread and door depth and warp tension.')
    fair = replace(good, held_out=replace(good.held_out, predicted=1.02 * good.held_out.measured))
    assert 'no more than' in verdict(fair).fit


def test_what_speaks_against_a_fit_is_listed(tows):
    good = report(tows)
    coloured = replace(
        good.residuals[0],
        values=np.sin(np.arange(30.0)),
        stds=np.full(30, 0.2),
        tows=np.zeros(30, int),
    )
    scales = {**good.estimate.noise_scales, 'roll': 2.5}
    estimate = replace(
        good.estimate, converged=False, reason='still moving', noise_scales=scales,
        values=np.concatenate((good.prior.low[:1], good.estimate.values[1:])),
    )  # fmt: skip
    feet = {'wrong unit': 'door/port/pressure is plausible in feet'}
    bad = replace(good, estimate=estimate, residuals=(coloured,), found=feet)
    said = ' '.join(verdict(bad).concerns)
    assert not verdict(bad).holds
    words = coloured.channel.replace('_', ' ')
    for part in (
        'Refused, wrong unit: door/port/pressure is plausible in feet.',
        'not converged: still moving', f'a1 at its lower bound {good.prior.low[0]:g}',
        f'beyond what the stated errors allow in {words} (test ratio {coloured.test_ratio:.1f})',
        f'follow each other, rather than scatter, in {words}', 'roll (2.5 times)',
    ):  # fmt: skip
        assert part in said


def test_nothing_left_out_leaves_the_fit_unknown(sea, model, prior, windows):
    judged = verdict(report(fitted(sea, model, prior, windows[:1])))
    assert 'remains unknown' in judged.fit
    assert not judged.holds


@pytest.mark.usefixtures('rough_pictures')
def test_the_page_needs_nothing_beside_it_and_begins_with_the_verdict(sea, tows, tmp_path):
    tows.finder.rejected['outlier'] = 7
    found = report(tows, truth=sea.TRUTH)
    write_report(found, tmp_path / 'out', advice=('900 m at 2.0 m/s',))
    text = (tmp_path / 'out' / 'report.html').read_text()
    # Pictures are letters and digits, which may spell anything.
    assert '://' not in text
    assert 'href=' not in text
    sources = re.findall(r'src="([^"]{22})', text)
    assert len(sources) == len(list((tmp_path / 'out').glob('*.png'))) == len(drawings(found))
    assert set(sources) == {'data:image/png;base64,'}
    body = text[text.index('<h1>') :]
    assert body.index(verdict(found).fit) < body.index('<h2>')
    assert body.index('900 m at 2.0 m/s') > body.index('<h2>What to tow next')
    assert REASONS['outlier'] in text
    assert '<h2>What to tow next' not in report_page(found, [])
    named = replace(found, found={'outlier': '<script>'})
    hostile = report_page(named, [], ['<script>'])
    assert '<script' not in hostile
    assert hostile.count('&lt;script&gt;') == 2


def test_figures_are_drawn_for_whatever_there_is(sea, model, prior, windows, tmp_path):
    gone = [replace(window, means=dict(window.means)) for window in windows[:1]]
    del gone[0].means['vertical_opening']
    write_report(replace(report(fitted(sea, model, prior, gone)), law=EQ14), tmp_path)
    drawn = {path.name: path.stat().st_size for path in tmp_path.glob('*.png')}
    assert {
        'coefficients.png', 'channels.png', 'objective.png', 'lift_drag.png', 'residuals.png',
        'spectrum.png', 'convergence.png', 'held_out.png', 'tow_biases.png',
    } == set(drawn)  # fmt: skip
    assert min(drawn.values()) > 10_000


def test_tables_and_lines_for_the_console(sea, tows):
    found = report(tows, truth=sea.TRUTH)
    console = Console(record=True, width=120)
    console.print(opening_line(found))
    console.print(coefficient_table(found), channel_table(found), *closing_lines(found))
    text = console.export_text()
    for word in ('a1', 'c6', 'truth', 'door spread', 'tows held out', 'Objective of eq. 35'):
        assert word in text
    assert '15 steady windows' in text
    assert '3 tows' in text
