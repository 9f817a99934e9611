"""Scores of known answers: names, probabilities, sizes, and the certified cut."""

import numpy as np
import pytest

from trawl_ros.lab.missing_effect.calibration import (
    CalibrationOptions,
    Claim,
    calibration_error,
    certificates,
    certified_cut,
    confusion,
    is_wrong_at,
    likeliest,
    log_score,
)
from trawl_ros.lab.missing_effect.plan import IN_LIBRARY, drawn_spec
from trawl_ros.lab.missing_effect.records import AnswerRecord, HeldOutRecord
from trawl_ros.lab.missing_effect.score_report import comparison_table, confusion_table
from trawl_ros.lab.missing_effect.scoring import (
    all_sections,
    is_right,
    is_worse,
    is_wrong,
)

OPTIONS = CalibrationOptions()
CHAIN = 'mouth/weight/footrope_weight'


def named(*paths, probability=0.97, **more):
    """Answer that names paths, each of the same probability."""
    return AnswerRecord(
        verdict='NAMED' if paths else 'NO_DISCREPANCY', named=paths,
        probabilities=dict.fromkeys(paths or ('nothing',), probability), **more,
    )  # fmt: skip


@pytest.mark.parametrize(
    ('path', 'right'),
    [
        (CHAIN, True),
        ('mouth/weight', True),
        ('mouth', True),
        ('mouth/weight/port_clump', False),
        ('mouth/lift', False),
        ('boards/rigging/board_rigging', False),
    ],
)
def test_a_path_holds_a_cause_that_is_below_it(truth, path, right):
    assert truth('footrope_chain').holds(path) == right
    assert not truth(series='clean').holds(path)


def test_a_leaf_or_its_node_is_right_and_another_wrong(truth):
    chain = truth('footrope_chain')
    cases = [
        (chain, answer)
        for answer in (
            named(CHAIN), named('mouth/weight'), named('mouth'), named('mouth/lift'),
            named(CHAIN, 'mouth/lift'), named(),
        )
    ]  # fmt: skip
    assert [is_right(own) for own in cases] == [True, True, False, False, False, False]
    assert [is_right(own, by_leaf=True) for own in cases] == [
        True,
        False,
        False,
        False,
        False,
        False,
    ]
    assert [is_wrong(own) for own in cases] == [False, False, False, True, True, False]


def test_both_of_a_pair_have_to_be_named(truth):
    pair = truth('rigging_epsilon', 'speed_log', series='pair')
    assert not is_right((pair, named('boards/rigging')))
    assert is_right((pair, named('boards/rigging', 'instruments/log')))


def test_the_likeliest_claim_is_right_where_it_holds_the_cause(truth):
    own = likeliest((truth('footrope_chain'), named(CHAIN, probability=0.8)))
    assert (own.path, own.probability, own.right) == ('mouth/weight', 0.8, True)
    assert likeliest((truth(series='clean'), named())).right
    assert not likeliest((truth('footrope_chain'), named())).right


def test_claims_that_come_true_as_often_as_stated_have_no_error():
    fair = [Claim('net', 0.8, number % 5 != 0) for number in range(100)]
    assert calibration_error(fair, OPTIONS) < 0.05
    sure = [Claim('net', 0.99, number % 2 == 0) for number in range(100)]
    assert calibration_error(sure, OPTIONS) > 0.4


def test_the_log_score_is_that_of_the_node(truth):
    cases = [(truth('footrope_chain'), named(CHAIN, probability=0.5))]
    assert log_score(cases, OPTIONS) == pytest.approx(np.log(0.5))


def test_a_hundred_trials_without_a_wrong_name_certify_a_cut_and_fifty_do_not(truth):
    right = (truth('footrope_chain'), named(CHAIN))
    wrong = (truth('footrope_chain'), named('mouth/lift'))
    assert certified_cut([right] * 99, OPTIONS) == 0.8
    assert certified_cut([right] * 98, OPTIONS) is None
    assert is_wrong_at(wrong, 0.95)
    assert not is_wrong_at(wrong, 0.98)
    # A wrong name of probability 0.97 is one from that cut on.
    tested = certificates([right] * 99 + [wrong], OPTIONS)
    assert [(own.cut, own.wrong) for own in tested][-1] == (0.97, 1)
    assert certified_cut([right] * 99 + [wrong], OPTIONS) == 0.98
    assert tested[0].bound == pytest.approx(0.0295, abs=1e-4)
    assert (tested[0].needed, tested[-1].needed) == (99, 157)


def test_pairs_that_are_confused_are_listed_with_the_likeliest_first(truth):
    cases = [
        (truth('footrope_chain'), named('mouth/lift', probability=0.6)),
        (truth('footrope_chain'), named(CHAIN, probability=0.6)),
        (truth(series='clean'), named()),
    ]
    assert confusion(cases)[0] == ('footrope_chain', 'mouth/lift', pytest.approx(0.3), 2)
    assert len(confusion_table(cases).rows) == 1


def test_a_repair_is_worse_only_beyond_the_errors_of_the_plant():
    own = HeldOutRecord(
        before={'door_spread': 2.0}, after={'door_spread': 3.0}, expected={'door_spread': 1.0}
    )
    assert is_worse(own, {'door_spread': 1.0})
    assert not is_worse(own, {'door_spread': 2.8})


def test_all_rows_are_made_of_few_answers_and_compared(truth):
    sizes = {CHAIN: {'value': -0.25, 'low': -0.32, 'high': -0.2}}
    cases = [
        (truth('footrope_chain'), named(CHAIN, sizes=sizes, among=(CHAIN,), seconds=2.0)),
        (truth(series='clean'), named(seconds=1.0)),
        (truth('block_angle', series='outside', strength=6.0), AnswerRecord(verdict='UNKNOWN')),
    ]
    rows = {row.what: row for section in all_sections(cases) for row in section.rows}
    assert rows['right leaf at 3 times'].value == 100.0
    assert rows['wrong name, of all trials'].value == 0.0
    assert rows['sizes within their 95 % interval'].value == 100.0
    assert rows['outside the library: UNKNOWN, or nothing above 0.5'].value == 100.0
    assert rows['processor time of a trial, median'].value == 1.5
    table = comparison_table({'mine': cases, 'other': cases[:1]})
    assert table.head == ('what', 'asked for', 'mine', 'other')
    assert all(len(row) == 4 for row in table.rows)


def test_trials_are_drawn_from_all_causes_and_the_same_again():
    specs = [drawn_spec(7, number) for number in range(400)]
    assert specs[3] == drawn_spec(7, 3)
    alone = {name for spec in specs if spec.series == 'alone' for name in spec.effects}
    assert alone == set(IN_LIBRARY)
    assert 50 < sum(spec.series == 'clean' for spec in specs) < 110
