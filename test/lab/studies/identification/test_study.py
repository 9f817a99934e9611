"""The study of identification counts what it says, and its parts are as they are described."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.running.live_nodes import LiveNodes
from trawl_ros.lab.studies.identification.bound import ROWS, _covariance, information
from trawl_ros.lab.studies.identification.costs import NODE, Replay, live_rows, replay_rows
from trawl_ros.lab.studies.identification.kept import FILE, KeptTrials
from trawl_ros.lab.studies.identification.plant import Cut, Look
from trawl_ros.lab.studies.identification.readings import (
    AS_STATED,
    KINDS,
    SENSED,
    Sensors,
    steady_windows,
    wrong_by,
)
from trawl_ros.lab.studies.identification.report import REPORT
from trawl_ros.lab.studies.identification.rows import coverage_rows, held_out_rows, spread_rows
from trawl_ros.lab.studies.identification.trial import EstimationTrial, Task, run_trial
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.records.observables import OBSERVABLES

PRIOR = board_prior(load_gear('kaifuha'))


def trial(number, *, error=0.0, half=1.0, std=1.0, held_out=0.02, floor=0.02):
    """A trial whose estimate is off by ``error``, with intervals of ``half`` to both sides."""
    values = PRIOR.start + error
    measured = np.full((4, 4), 100.0)
    return EstimationTrial(
        series='finer',
        number=number,
        truth=PRIOR.start.tolist(),
        values=values.tolist(),
        std=np.full(12, std).tolist(),
        low=(values - half).tolist(),
        high=(values + half).tolist(),
        converged=True,
        windows=20,
        rejected={'collapsed': 1},
        information=np.diag(std**-2 - PRIOR.std**-2).tolist(),
        measured=measured.tolist(),
        predicted=(measured * (1.0 + held_out)).tolist(),
        perfect=(measured * (1.0 + floor)).tolist(),
        noise_scales={},
    )


@pytest.mark.parametrize(('quantile', 'ok'), [(1.96, True), (1.2, False), (3.5, False)])
def test_intervals_too_narrow_or_too_wide_miss_the_target(quantile, ok):
    chance = np.random.default_rng(3)
    trials = [
        trial(n, error=chance.standard_normal(12), half=quantile * np.ones(12)) for n in range(300)
    ]
    rows = coverage_rows(trials, 'a plant', asked=True)
    assert rows[0].ok is ok
    assert rows[0].low <= rows[0].value <= rows[0].high
    assert len(rows) == 13


@pytest.mark.parametrize(('factor', 'ok'), [(1.0, True), (1.5, False), (0.7, False)])
def test_the_spread_is_that_over_the_bound(factor, ok):
    chance = np.random.default_rng(4)
    std = 0.1 * PRIOR.std
    trials = [
        trial(n, error=factor * std * chance.standard_normal(12), std=std) for n in range(200)
    ]
    rows = spread_rows(trials, PRIOR)
    assert rows[0].value == pytest.approx(factor, rel=0.05)
    assert rows[0].ok is ok
    named = {row.what: row for row in rows}
    assert named['bound of each board over that of all'].value == pytest.approx(1.0)
    assert named['bound of each board over that of all'].target is None
    median = named['spread of estimates over the bound of each board, the median trial']
    assert median.value == pytest.approx(factor, rel=0.08)


def test_errors_are_set_beside_those_of_a_perfect_model():
    rows = {row.what: row for row in held_out_rows([trial(n, held_out=0.03) for n in range(3)])}
    spread = rows['tows left out: error in door spread']
    assert (spread.value, spread.ok) == (pytest.approx(3.0), False)
    over = rows['tows left out: error in door spread over that of a perfect model']
    assert (over.value, over.ok) == (pytest.approx(1.5), False)


def test_a_state_that_the_model_lacks_is_counted_and_left_out():
    gap = trial(0)
    gap.predicted[1] = [None] * 4
    row = held_out_rows([gap])[0]
    assert row.value == pytest.approx(2.0)
    assert '1 states have none' in row.note


def looks(number=3):
    chance = np.random.default_rng(9)
    size = {name: CHANNELS[name].noise for name in SENSED}
    scale = np.array([size.get(name, 1.0) for name in OBSERVABLES])[:, None]
    return [
        Look(
            (300.0 + 100.0 * n, 2.0 + 0.1 * n),
            50.0 + 10.0 * n + np.arange(len(OBSERVABLES)),
            scale * chance.standard_normal((len(OBSERVABLES), 3)) * (0.5, 0.5, 20.0),
            scale * chance.standard_normal((len(OBSERVABLES), 12)),
        )
        for n in range(number)
    ]


def test_simulated_windows_have_the_covariance_that_the_bound_assumes():
    seen = looks(2)
    sensors = wrong_by(0.3, np.random.default_rng(1))
    windows = steady_windows([seen] * 800, sensors, np.random.default_rng(2))
    rest = []
    for window, look in zip(windows, seen * 800, strict=True):
        wrong = np.array([window.means[name] for name in INPUTS]) - look.inputs
        measured = np.array([window.means[name] for name in SENSED])
        rest.append(measured - look.values[ROWS] - look.by_inputs[ROWS] @ wrong)
    found = np.cov(np.reshape(rest, (800, -1)).T)
    expected = _covariance(seen, sensors)
    std = np.sqrt(np.diag(expected))
    assert np.sqrt(np.diag(found)) == pytest.approx(std, rel=0.1)
    apart = (found - expected) / np.outer(std, std)
    assert np.abs(apart).max() < 0.16


def test_biases_of_a_tow_are_not_worn_down_by_more_windows():
    seen = looks(1)
    once, often, tows = (
        np.trace(information(case, AS_STATED)) for case in ([seen], [seen * 50], [seen] * 50)
    )
    assert tows == pytest.approx(50.0 * once)
    assert once < often < 0.3 * tows


def test_noise_is_as_much_larger_than_stated_as_asked():
    sensors = wrong_by(0.3, np.random.default_rng(5))
    assert {sensors.factor(name) for name in (*SENSED, *INPUTS)} <= {0.7, 1.3}
    loud = Sensors(dict.fromkeys(KINDS, 3.0))
    quiet, noisy = (
        [window.means['port_door_depth'] for window in
         steady_windows([looks(1)] * 400, case, np.random.default_rng(6))]
        for case in (AS_STATED, loud)
    )  # fmt: skip
    assert np.std(noisy) / np.std(quiet) == pytest.approx(3.0, rel=1e-6)


def test_trials_are_kept_and_a_line_without_its_end_is_made_again(tmp_path):
    asked = {'seed': 1, 'around': 12}
    kept = KeptTrials(tmp_path, asked, EstimationTrial)
    kept.add(trial(0))
    kept.add(trial(1))
    path = tmp_path / FILE
    path.write_text(path.read_text() + '{"series": "finer", "num')
    again = KeptTrials(tmp_path, asked, EstimationTrial)
    assert again.series('finer') == (trial(0), trial(1))
    again.add(trial(2))
    assert [one.number for one in KeptTrials(tmp_path, asked, EstimationTrial).series('finer')] == [
        0,
        1,
        2,
    ]
    assert not KeptTrials(tmp_path, asked, EstimationTrial, force=True).has('finer', 0)


def test_trials_of_other_settings_are_refused(tmp_path):
    KeptTrials(tmp_path, {'seed': 1, 'around': 12}, EstimationTrial)
    with pytest.raises(TrawlError, match=r'seed 1.*expected seed 2.*--force'):
        KeptTrials(tmp_path, {'seed': 2, 'around': 12}, EstimationTrial)
    (tmp_path / FILE).unlink()
    (tmp_path / REPORT).write_text('of somebody else')
    with pytest.raises(TrawlError, match='holds files already'):
        KeptTrials(tmp_path, {'seed': 1, 'around': 12}, EstimationTrial)
    (tmp_path / FILE).write_text('notes\n')
    with pytest.raises(TrawlError, match='not a file of trials'):
        KeptTrials(tmp_path, {'seed': 1, 'around': 12}, EstimationTrial)


def test_costs_are_held_against_what_is_asked():
    motion = Replay(3600.0, 119.0, 120.0), Replay(3600.0, 121.0, 122.0)
    assert [row.ok for row in replay_rows(Replay(3600.0, 17.0, 18.0), motion[0])] == [True, True]
    assert [row.ok for row in replay_rows(Replay(3600.0, 19.0, 18.0), motion[1])] == [False, False]
    late, share = live_rows(LiveNodes({NODE: 12.0}, (0.2, 1.4), (), 2, 600.0))
    assert (late.value, late.ok, share.ok) == (1.4, False, True)
    assert not live_rows(LiveNodes({NODE: math.nan}, (), (), 0, 0.0))[0].ok


@pytest.mark.slow
def test_the_command_makes_a_report_and_goes_on_where_it_was(tmp_path):
    out = tmp_path / 'report'
    few = ['study', 'identification', '--out', str(out), '--small', '--seed', '1', '--around',
           '12', '--tows', '1', '--bound', '0', '--mouth', '0', '--coverage']  # fmt: skip
    first = CliRunner().invoke(trawl, [*few, '1'])
    assert first.exit_code == 0, first.output
    assert 'targets are reached' in first.output
    records = json.loads((out / 'identification.json').read_text())['rows']
    assert {'what', 'value', 'low', 'high', 'target', 'ok', 'note'} <= set(records[0])
    for name in (REPORT, 'identification.html'):
        text = (out / name).read_text()
        assert all(record['what'] in text for record in records)
    made = (out / FILE).read_text()
    again = CliRunner().invoke(trawl, [*few, '1'])
    assert again.exit_code == 0, again.output
    assert (out / FILE).read_text() == made
    one = KeptTrials(out, json.loads(made.split('\n')[0])['asked'], EstimationTrial).series(
        'finer'
    )[0]
    task = Task('finer', 0, 1, 'kaifuha', Cut(12, lines=2, unjoined=True), tows=1, stated=False)
    assert run_trial(task) == one, 'the same in this process as in a worker'
