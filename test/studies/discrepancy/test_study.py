"""The blind tests hide what they say, keep the key away, and count what was said."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from studies.discrepancy.costs import cost_rows, keep_cost
from studies.discrepancy.figure import kind_of
from studies.discrepancy.plan import BlindStudyPlan
from studies.discrepancy.rows import (
    all_sections,
    bag_rows,
    clean_rows,
    inside_rows,
    outside_rows,
    pair_rows,
    poor_rows,
    shuffled_rows,
)
from studies.discrepancy.stages import fit_quietly, rules_hash, run_blind
from studies.discrepancy.study import STUDY
from studies.discrepancy.worth import repair_rows
from studies.harness import Work, run_study
from trawl_ros.core.errors import TrawlError
from trawl_ros.diagnosis.mimics.table import mimic_table
from trawl_ros.diagnosis.procedure import diagnose_windows
from trawl_ros.effects.registry import catalogue
from trawl_ros.lab.trials.hidden_effects.inside import INSIDE
from trawl_ros.lab.trials.hidden_effects.on_deck import ON_DECK, RIGHT
from trawl_ros.lab.trials.hidden_effects.other_keys import (
    CAUSES,
    RIGHT_CHANGES,
    RIGHT_NAMES,
)
from trawl_ros.lab.trials.hidden_effects.outside import OUTSIDE
from trawl_ros.lab.trials.making import make
from trawl_ros.lab.trials.plant import FINER
from trawl_ros.lab.trials.tows import FULL, POOR, SEA
from trawl_ros.lab.trials.trial import Scored, Spec
from trawl_ros.lab.trials.verdicts import reported, right
from trawl_ros.records.coefficients import COEFFICIENTS

SEED = 5
ALONE = {name: (name,) for name in INSIDE} | {'heave': ('heave', 'speed_log')}
"""Classes."""


def scored(verdict, names=(), hidden=('catch_build_up',), series='inside', strength=3.0, **more):
    """A trial of which that was said."""
    spec = Spec(series, 0, tuple(hidden), strength, (1.0,) * len(hidden), 0)
    truth = np.ones(len(COEFFICIENTS))
    key = {
        'spec': asdict(spec) | {'effects': list(hidden)},
        'sizes': [2.0] * len(hidden),
        'coefficients': truth.tolist(),
        'why_not': '',
        'floor': {'net_depth': 1.0},
    }
    diagnosis = {
        'verdict': verdict,
        'effects': [
            {'name': name, 'class': [name], 'parameters': {'one': {'low': 1.5, 'high': 2.5}}}
            for name in names
        ],
        'ambiguous_with': more.get('ambiguous', []),
        'channels': {
            'net_depth': {'before': 3.0, 'after': 1.2, 'placebo': 2.9, 'expected': 1.0},
        },
        'excess_removed': more.get('removed', 0.9),
        'excess_removed_by_placebo': 0.1,
        'coefficients': {
            name: {'before': {'value': 2.0, 'std': 0.1}, 'after': {'value': 1.1, 'std': 0.1}}
            for name in COEFFICIENTS
        },
    }
    return Scored(key, diagnosis)


def value(rows, what):
    (row,) = [row for row in rows if row.what == what]
    return row


def test_everything_of_the_catalogue_that_shows_in_steady_tows_is_hidden():
    shows = {name for name, effect in catalogue().items() if effect.fitted}
    right = {name for names in RIGHT_NAMES.values() for name in names}
    assert set(RIGHT) == set(ON_DECK)
    assert set(INSIDE) <= shows
    # Both boards alike are damaged as their coefficients say; one side stands for the other.
    mirrored = {
        'port_bridle_length', 'starboard_board_rigging', 'starboard_clump',
        'starboard_net_damage',
    }  # fmt: skip
    assert set(INSIDE) | right | mirrored == shows
    assert len(OUTSIDE) >= 10
    assert not (set(OUTSIDE) | set(CAUSES)) & set(catalogue())


def test_every_cause_on_deck_has_names_or_changes_that_count_as_right():
    assert set(RIGHT_NAMES) == set(CAUSES)
    assert set(RIGHT_CHANGES) <= set(CAUSES)
    assert {name for names in RIGHT_NAMES.values() for name in names} <= set(catalogue())
    known = {change.name for change in mimic_table()}
    assert {name for names in RIGHT_CHANGES.values() for name in names} <= known
    assert all(RIGHT_NAMES[name] or RIGHT_CHANGES[name] for name in CAUSES)


def test_a_set_that_holds_the_changed_key_is_right():
    beside = scored('AMBIGUOUS', ['board_rigging'], ['other_boards'], 'deck')
    assert reported(beside) == {'board_rigging'}
    assert not right(beside, reported(beside), ALONE)
    listed = beside.diagnosis | {'mimics': [{'name': 'board_area'}]}
    held = replace(beside, diagnosis=listed)
    assert reported(held) == {'board_rigging', 'board_area'}
    assert right(held, reported(held), ALONE)
    unknown = replace(beside, diagnosis=listed | {'verdict': 'UNKNOWN'})
    assert 'board_area' not in reported(unknown)


def test_rates_count_what_was_said():
    trials = [
        scored('NAMED', ['catch_build_up']),
        scored('NAMED', ['net_drag']),
        scored('AMBIGUOUS', ['net_drag'], ambiguous=['catch_build_up']),
        scored('UNKNOWN'),
        scored('NO_DISCREPANCY', strength=1.5),
    ]
    rows = inside_rows(trials, ALONE)
    assert value(rows, 'right single name, or class, at 3 times').value == 25.0
    assert value(rows, 'wrong single name').value == 20.0
    assert value(rows, 'truth within the set that is reported').value == pytest.approx(200 / 3)
    assert value(rows, 'detected at 1.5 times').value == 0.0
    assert value(rows, 'mean size of the set at 3 times').value == pytest.approx(4 / 3)
    assert not value(rows, 'wrong single name').ok


def test_alarms_and_foreign_effects_are_counted():
    clean = [
        scored('NO_DISCREPANCY', hidden=(), series='clean', strength=0.0),
        scored('NAMED', ['net_drag'], hidden=(), series='clean', strength=0.0),
    ]
    assert [row.value for row in clean_rows(clean)] == [50.0, 50.0]
    outside = [
        scored('UNKNOWN', hidden=('jet',), series='outside', strength=6.0),
        scored('NAMED', ['current_shear'], hidden=('jet',), series='outside', strength=6.0),
    ]
    assert value(outside_rows(outside), 'UNKNOWN at 6 times').value == 50.0
    assert value(outside_rows(outside), 'wrong name').value == 50.0


def test_of_two_effects_both_count_and_one_is_told_apart():
    hidden = ('net_drag', 'heave')
    pairs = [
        scored('NAMED', ['heave', 'net_drag'], hidden=hidden, series='pair'),
        scored('NAMED', ['heave'], hidden=hidden, series='pair'),
        scored('NAMED', ['kite'], hidden=hidden, series='pair'),
        scored('AMBIGUOUS', ['heave'], hidden=hidden, series='pair', ambiguous=['net_drag']),
    ]
    assert [row.value for row in pair_rows(pairs, ALONE)[:2]] == [25.0, 25.0]
    assert [kind_of(trial, ALONE) for trial in pairs] == [
        'right name', 'a part of what is hidden', 'wrong name',
        'several names, the right one among them',
    ]  # fmt: skip
    beside = scored('NAMED', ['catch_build_up', 'heave'])
    assert kind_of(beside, ALONE) == 'right name and another beside it'


def test_of_three_effects_two_are_to_be_found_and_no_other():
    hidden = ('net_drag', 'spread_sensor', 'tension_cell')
    triples = [
        scored('NAMED', hidden, hidden=hidden, series='triple'),
        scored('NAMED', hidden[:2], hidden=hidden, series='triple'),
        scored('NAMED', hidden[:1], hidden=hidden, series='triple'),
        scored('NAMED', [*hidden[:2], 'kite'], hidden=hidden, series='triple'),
    ]
    rows = pair_rows(triples, ALONE)
    assert value(rows, 'two of three effects at least, and no other, at 3 times').value == 50.0
    assert value(rows, 'anything else named where three are hidden').value == 25.0
    assert [kind_of(trial, ALONE) for trial in triples] == [
        'right name', 'a part of what is hidden', 'a part of what is hidden', 'wrong name',
    ]  # fmt: skip


def test_a_repair_that_makes_a_channel_worse_is_counted():
    good, bad = scored('NAMED', ['net_drag']), scored('NAMED', ['net_drag'])
    bad.diagnosis['channels']['net_depth'].update(before=1.0, after=1.6, expected=1.0)
    unlucky = scored('NAMED', ['net_drag'])
    unlucky.diagnosis['channels']['net_depth'].update(before=1.0, after=1.6, expected=1.0)
    unlucky.key['floor'] = {'net_depth': 1.7}
    rows = repair_rows([good, good, bad, unlucky], ALONE)
    worse = 'repairs that make a channel worse'
    assert value(rows, f'{worse} on what was kept back').value == 50.0
    assert value(rows, 'the plant itself, by the same count').value == 25.0
    assert value(rows, f'{worse}, and worse than the plant itself does').value == 25.0


def test_a_repair_that_readings_do_not_want_is_told_from_one_that_calibration_makes_look_so():
    unwanted, unlucky, blind = (scored('NAMED', ['net_drag']) for _ in range(3))
    for trial, part, std in ((unwanted, 0.1, 0.1), (unlucky, 0.1, 0.3), (blind, 1.0, None)):
        trial.diagnosis['held_out'] = {'net_depth': {'part': part, 'part_std': std}}
    rows = repair_rows([unwanted, unlucky, blind, blind], ALONE)
    what = 'repairs of which readings kept back want less than half, in any quantity'
    assert value(rows, what).value == 25.0


def test_a_repair_is_measured_against_the_truth():
    trial = scored('NAMED', ['catch_build_up'])
    quiet = {'parameters': {'one': 1.2}, 'coefficients': dict.fromkeys(COEFFICIENTS, 1.1)}
    rows = repair_rows([replace(trial, quiet=quiet)], ALONE)
    assert [row.value for row in rows] == pytest.approx(
        [94.5, 7.375, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 100.0]
    )


def test_what_is_alike_in_every_such_trial_is_as_good_as_the_name():
    named = [
        scored('NAMED', ['speed_log'], hidden=('heave',)),
        scored('NAMED', ['heave'], hidden=('speed_log',)),
    ]
    rows = inside_rows(named, ALONE)
    assert value(rows, 'right single name, or class, at 3 times').value == 50.0
    assert value(rows, 'wrong single name').value == 50.0


def test_a_tow_that_parts_leaves_one_name():
    followed = [
        scored('NAMED', ['counter_scale'], hidden=('counter_scale',), series='followed'),
        scored('AMBIGUOUS', ['counter_scale'], hidden=('counter_scale',), series='followed',
               ambiguous=['counter_offset']),
    ]  # fmt: skip
    rows = poor_rows(followed, ALONE)
    assert value(rows, 'the proposed tow parts what could not be told apart').value == 50.0
    # Both counters can be read against marks on the warp.
    either = 'the proposed tow, or a check on deck, parts what could not be told apart'
    assert value(rows, either).value == 100.0


def test_bags_are_set_beside_their_windows():
    first, other = scored('NAMED', ['catch_build_up']), scored('UNKNOWN')
    again = scored('NAMED', ['catch_build_up'])
    again.key['spec'].update(number=1, form='bags', like=0)
    rows = bag_rows([first, again], ALONE)
    assert rows[0].value == 100.0
    other.key['spec'].update(number=1, form='bags', like=0)
    rows = bag_rows([first, other], ALONE)
    assert rows[0].value == 0.0
    assert 'catch_build_up NAMED UNKNOWN' in rows[0].note
    rows = bag_rows([replace(first, diagnosis=None), other], ALONE)
    assert rows[0].note == 'no trials'


def test_trials_of_a_day_are_right_by_name_or_small_set():
    def at_sea(*said, hidden=('kite_gone',), **more):
        trial = scored(*said, hidden=hidden, series='sea', **more)
        trial.key['spec'].update(form='dynamic', plan='two tows', like=9)
        return trial

    trials = [
        at_sea('NAMED', ['kite']),
        at_sea('AMBIGUOUS', ['floats'], ambiguous=['kite']),
        at_sea('NO_DISCREPANCY', hidden=()),
        at_sea('UNKNOWN'),
        at_sea('NAMED', ['floats']),
    ]
    rows = bag_rows(trials, ALONE)
    assert value(rows, 'towed in time: verdict right').value == 60.0
    assert value(rows, 'towed in time: a wrong name').value == 20.0


def test_shuffled_keys_score_as_chance_would():
    trials = [
        scored('NAMED', [name], hidden=(name,)) for name in list(INSIDE)[:10] for _ in range(10)
    ]
    (row,) = shuffled_rows(trials, ALONE)
    assert row.value < 30.0
    assert any(section.rows for section in all_sections(trials, ALONE))


def test_another_plan_in_the_same_folder_is_refused(tmp_path):
    (tmp_path / 'plan.json').write_text(json.dumps(asdict(BlindStudyPlan(seed=1))))
    with pytest.raises(TrawlError, match=r'another seed.*--force'):
        run_blind(BlindStudyPlan(seed=2), Work(tmp_path, pytest.fail))


def test_other_rules_than_those_of_the_first_trials_are_refused(tmp_path):
    plan = BlindStudyPlan(seed=1)
    (tmp_path / 'plan.json').write_text(json.dumps(asdict(plan)))
    (tmp_path / 'rules.json').write_text(json.dumps({'diagnosis_sha256': 'others'}))
    with pytest.raises(TrawlError, match=r'rules\.json: the rules .* have changed .*--force'):
        run_blind(plan, Work(tmp_path, pytest.fail))
    assert len(rules_hash()) == 64


def test_trials_per_hour_count_all_stages_of_a_trial(tmp_path):
    assert cost_rows(tmp_path) == []
    for stage, name, seconds in (
        ('making trials', 'a', 2.0), ('making trials', 'b', 4.0), ('diagnosing', 'a', 6.0)
    ):  # fmt: skip
        keep_cost(tmp_path, stage, name, seconds)
    (row,) = cost_rows(tmp_path)
    assert row.value == pytest.approx(2 * 3600.0 * 2 / 12.0)
    assert row.ok
    assert 'making trials 3.0 s, diagnosing 3.0 s' in row.note


def test_trials_of_a_day_are_made_as_windows_and_towed_in_time():
    specs = BlindStudyPlan(dynamic=16).specs()
    windows = {spec.number: spec for spec in specs if spec.form == 'windows'}
    in_time = [spec for spec in specs if spec.form == 'dynamic']
    assert len(in_time) == 16
    assert {spec.plan for spec in in_time} == set(SEA)
    clean = [spec for spec in in_time if not spec.effects]
    assert len(clean) == 4
    assert len({spec.plan for spec in clean}) == 4
    assert all(windows[spec.like].series == 'sea' for spec in in_time)
    assert BlindStudyPlan(dynamic=3).specs()[-1].plan == in_time[2].plan


def test_one_in_twenty_is_made_as_bags():
    specs = BlindStudyPlan(dynamic=3).specs()
    windows = {spec.number: spec for spec in specs if spec.form == 'windows'}
    bags = [spec for spec in specs if spec.form == 'bags']
    in_time = [spec for spec in specs if spec.form == 'dynamic']
    # Poor trials are towed on, and not made as bags.
    full = [spec for spec in windows.values() if spec.plan == 'full']
    assert len(bags) == pytest.approx(len(full) / 20, abs=1.0)
    assert len(in_time) == 3
    assert {spec.like for spec in (*bags, *in_time)} <= set(windows)
    for spec in (*bags, *in_time):
        own = windows[spec.like]
        assert replace(spec, number=own.number, form='windows', like=None) == own
    assert len({spec.number for spec in specs}) == len(specs)


@pytest.mark.slow
def test_the_study_makes_a_page_and_goes_on_where_it_was(tmp_path):
    out = tmp_path / 'report'
    plan = BlindStudyPlan(
        seed=1, clean=1, inside=0, outside=0, pairs=0, poor=0, deck=0, triples=0, dynamic=0
    )
    rows = run_study(STUDY, plan, Work(out))
    text = (out / 'discrepancy.md').read_text()
    assert all(row.what in text for row in rows)
    seen = {path: path.stat().st_mtime_ns for path in (out / 'diagnoses').iterdir()}
    assert len(seen) == 1
    assert len((out / 'scorings.jsonl').read_text().splitlines()) == 1
    costs = [json.loads(line) for line in (out / 'costs.jsonl').read_text().splitlines()]
    assert [cost['stage'] for cost in costs] == ['making trials', 'diagnosing']
    rate = next(row for row in rows if row.what == 'trials per hour on 2 cores')
    assert rate.value == pytest.approx(7200.0 / sum(cost['s'] for cost in costs))
    run_study(STUDY, plan, Work(out))
    assert {path: path.stat().st_mtime_ns for path in (out / 'diagnoses').iterdir()} == seen
    first, second = (out / 'scorings.jsonl').read_text().splitlines()
    assert json.loads(first)['plan'] == json.loads(second)['plan']
    assert 'kinds of effects outside the catalogue' in json.loads(first)['missed']


@pytest.mark.slow
def test_without_errors_the_size_is_what_was_hidden():
    spec = Spec('poor', 0, ('counter_offset',), 6.0, (1.0,), 0, 'poor')
    key, made = make(spec, 'kaifuha', FINER, SEED)
    baseline = frozenset(range(POOR.baseline))
    found = fit_quietly(FINER.model('kaifuha'), made.quiet, 'counter_offset', baseline)
    assert found['parameters']['offset'] == pytest.approx(key.sizes[0], rel=0.25)


@pytest.mark.slow
def test_three_effects_at_once_are_all_named():
    hidden = ('current_shear', 'tension_cell', 'spread_sensor')
    spec = Spec('triple', 64, hidden, 3.0, (1.0, 1.0, 1.0), 0)
    key, made = make(spec, 'kaifuha', FINER, 64)
    assert key.testable
    tows = [f'tow {number + 1}' for number in range(len(FULL.tows))]
    found = diagnose_windows(
        FINER.model('kaifuha'), made.windows, tows, frozenset(range(FULL.baseline))
    )
    assert found.verdict == 'NAMED'
    assert set(found.best.refit.names) == set(hidden)
