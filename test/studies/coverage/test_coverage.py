"""The study of identification counts what it says, and its parts are as they are described."""

import math

import numpy as np
import pytest

from studies.coverage.costs import NODE, Replay, live_rows, replay_rows
from studies.coverage.rows import coverage_rows, held_out_rows, spread_rows
from studies.coverage.study import STUDY, CoveragePlan
from studies.coverage.trial import ROWS, EstimationTrial, _covariance, information, run_trial
from studies.harness import Work, run_study
from studies.kept import KeptTrials
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.trials.linearised_plant import LinearisedState
from trawl_ros.lab.trials.readings import (
    AS_STATED,
    SENSED_CHANNELS,
    SENSOR_KINDS,
    Sensors,
    steady_windows,
    wrong_by,
)
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
    rng = np.random.default_rng(3)
    trials = [
        trial(n, error=rng.standard_normal(12), half=quantile * np.ones(12)) for n in range(300)
    ]
    rows = coverage_rows(trials, 'a plant', asked=True)
    assert rows[0].ok is ok
    assert rows[0].low <= rows[0].value <= rows[0].high
    assert len(rows) == 13


@pytest.mark.parametrize(('factor', 'ok'), [(1.0, True), (1.5, False), (0.7, False)])
def test_the_spread_is_that_over_the_bound(factor, ok):
    rng = np.random.default_rng(4)
    std = 0.1 * PRIOR.std
    trials = [trial(n, error=factor * std * rng.standard_normal(12), std=std) for n in range(200)]
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
    rng = np.random.default_rng(9)
    size = {name: CHANNELS[name].noise for name in SENSED_CHANNELS}
    scale = np.array([size.get(name, 1.0) for name in OBSERVABLES])[:, None]
    return [
        LinearisedState(
            (300.0 + 100.0 * n, 2.0 + 0.1 * n),
            50.0 + 10.0 * n + np.arange(len(OBSERVABLES)),
            scale * rng.standard_normal((len(OBSERVABLES), 3)) * (0.5, 0.5, 20.0),
            scale * rng.standard_normal((len(OBSERVABLES), 12)),
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
        measured = np.array([window.means[name] for name in SENSED_CHANNELS])
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
    assert {sensors.factor(name) for name in (*SENSED_CHANNELS, *INPUTS)} <= {0.7, 1.3}
    loud = Sensors(dict.fromkeys(SENSOR_KINDS, 3.0))
    quiet, noisy = (
        [window.means['port_door_depth'] for window in
         steady_windows([looks(1)] * 400, case, np.random.default_rng(6))]
        for case in (AS_STATED, loud)
    )  # fmt: skip
    assert np.std(noisy) / np.std(quiet) == pytest.approx(3.0, rel=1e-6)


def test_costs_are_held_against_what_is_asked():
    pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
    from studies.live_nodes import LiveNodes

    motion = Replay(3600.0, 119.0, 120.0), Replay(3600.0, 121.0, 122.0)
    assert [row.ok for row in replay_rows(Replay(3600.0, 17.0, 18.0), motion[0])] == [True, True]
    assert [row.ok for row in replay_rows(Replay(3600.0, 19.0, 18.0), motion[1])] == [False, False]
    late, share = live_rows(LiveNodes({NODE: 12.0}, (0.2, 1.4), (), 2, 600.0))
    assert (late.value, late.ok, share.ok) == (1.4, False, True)
    assert not live_rows(LiveNodes({NODE: math.nan}, (), (), 0, 0.0))[0].ok


@pytest.mark.slow
def test_a_trial_is_made_reported_and_kept(tmp_path):
    plan = CoveragePlan(coverage=1, bound=0, mouth=0, around=12, tows=1, trials_only=True)
    rows = run_study(STUDY, plan, Work(tmp_path))
    text = (tmp_path / 'identification.md').read_text()
    assert all(row.what in text for row in rows)
    made = (tmp_path / 'trials.jsonl').read_text()
    run_study(STUDY, plan, Work(tmp_path))
    assert (tmp_path / 'trials.jsonl').read_text() == made
    (one,) = KeptTrials(tmp_path, plan.asked(), EstimationTrial).series('finer')
    (task,) = plan.tasks()
    assert run_trial(task) == one, 'the same in this process as in a worker'
