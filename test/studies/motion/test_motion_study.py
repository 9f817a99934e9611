"""The study of fits in motion counts what it says, and resumes where it was."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from studies.harness import Work, run_study
from studies.motion.plant import PlantTow
from studies.motion.rows import BAND, differing, motion_rows
from studies.motion.study import STUDY, MotionPlan
from studies.motion.trial import MotionTrial, draw_windowed
from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.gear.load import load_gear


def trial(number, rng, *, ratio=0.5, narrow=1.0, off=0.0):
    """A trial with normal errors; intervals in motion are too narrow by a factor."""
    std = np.array([np.ones(12), np.full(12, ratio)])
    values = std * rng.standard_normal((2, 12))
    std[1] /= narrow
    measured = np.full((4, 4), 100.0)
    away = np.array([0.4, 0.2 * (1.0 + off), 0.2])
    return MotionTrial(
        series='finer', number=number, truth=[0.0] * 12, values=values.tolist(), std=std.tolist(),
        low=(values - 1.96 * std).tolist(), high=(values + 1.96 * std).tolist(),
        squared=np.sum((values / std) ** 2, axis=1).tolist(), refused='', reason='',
        iterations=5, windows=5, left_out_s=300.0, duration_s=2820.0, rejected={'collapsed': 1},
        measured=measured.tolist(),
        predicted=(measured + away[:, None, None]).tolist(), sizes={}, cpu_s=50.0,
    )  # fmt: skip


def rows_of(**changes):
    rng = np.random.default_rng(8)
    trials = [trial(number, rng, **changes) for number in range(60)]
    return {row.what: row for row in motion_rows(trials, 'x', asked=True)}


def test_intervals_as_wide_as_the_errors_reach_their_targets():
    rows = rows_of()
    assert all(row.ok for row in rows.values())
    assert rows['x: std of all of the tow over that of its steady parts, geometric mean'].value == (
        pytest.approx(0.5)
    )
    squared = rows['x: squared normalised error of twelve coefficients by all of the tow, median']
    assert BAND[0] < squared.value < BAND[1]


def test_intervals_too_narrow_miss_them_and_the_steady_parts_do_not():
    rows = rows_of(narrow=1.8)
    assert not rows['x: 95 % intervals of all of the tow that cover the truth'].ok
    assert rows['x: 95 % intervals of its steady parts that cover the truth'].value > 92.0
    name = 'x: coefficients whose coverage by {} is not 95 %, after Holm'
    assert rows[name.format('all of the tow')].value >= 6
    assert rows[name.format('its steady parts')].value == 0


def test_errors_in_states_not_towed_are_set_over_those_by_the_truth():
    what = 'x: states not towed, error in warp tension by {} over that by the truth'
    rows = rows_of(off=0.3)
    assert rows[what.format('all of the tow')].value == pytest.approx(1.3)
    assert rows[what.format('its steady parts')].value == pytest.approx(2.0)
    assert not rows[what.format('all of the tow')].ok


def test_states_without_a_prediction_are_left_out_of_all_three():
    rng = np.random.default_rng(8)
    trials = [trial(number, rng) for number in range(3)]
    gone = [[[None] * 4, *part[1:]] if who == 1 else part
            for who, part in enumerate(trials[0].predicted)]  # fmt: skip
    trials[0] = replace(trials[0], predicted=gone)
    row = next(r for r in motion_rows(trials, 'x', asked=True) if 'warp tension' in r.what)
    assert row.value == pytest.approx(1.0)
    assert '1 states have no prediction' in row.note


def test_holms_procedure_stops_at_the_first_that_is_likely():
    assert differing([0.5, 0.001, 0.02, 0.9]) == 1
    assert differing([0.001] * 4) == 4
    assert differing([0.013, 0.2, 0.3, 0.4]) == 0


def test_boards_without_a_steady_window_are_drawn_again_and_counted(steady_tow, coarse_gear):
    still, short = (tuple(steady_tow.samples(leg_s=leg_s)) for leg_s in (400, 60))
    drawn = iter([(short, 2), (short, 0), (still, 1)])

    def draw():
        samples, before = next(drawn)
        return PlantTow(load_gear(coarse_gear), 0.0, samples, (), Counter(collapsed=before))

    found = draw_windowed(draw, lambda plant: identification_for(plant.gear), 'finer 3')
    assert found.plant.samples is still
    assert found.rejected == {'without a steady window': 2, 'collapsed': 3}
    assert found.estimate.windows == len(steady_tow.states)


def test_a_trial_none_of_whose_boards_has_a_steady_window_says_which_and_why():
    tow = PlantTow(load_gear('kaifuha'), 0.0, (), (), Counter())
    with pytest.raises(TrawlError, match='finer 3: '):
        draw_windowed(lambda: tow, lambda plant: identification_for(plant.gear), 'finer 3')


@pytest.mark.slow
def test_a_trial_is_towed_fitted_and_kept(tmp_path):
    plan = MotionPlan(trials=1, seed=6, around=12)
    rows = run_study(STUDY, plan, Work(tmp_path, workers=1))
    kept = (tmp_path / 'trials.jsonl').read_text('utf-8')
    assert len(kept.splitlines()) == 2
    # Of one trial intervals are no numbers, which equal nothing.
    assert repr(run_study(STUDY, plan, Work(tmp_path, workers=1))) == repr(rows)
    assert (tmp_path / 'trials.jsonl').read_text('utf-8') == kept
