"""A row says truly whether its target is reached."""

import math

import pytest

from trawl_ros.lab.benchmark.row import BenchmarkRow
from trawl_ros.lab.benchmark.writing import row_record, target


@pytest.mark.parametrize(
    ('value', 'rule', 'ok'),
    [
        (100.0, 'at_least', True),
        (99.9, 'at_least', False),
        (100.0, 'at_most', True),
        (100.1, 'at_most', False),
        (math.nan, 'at_least', False),
        (math.nan, 'at_most', False),
    ],
)
def test_a_target_is_a_bound_on_one_side(value, rule, ok):
    assert BenchmarkRow('speed', value, '×', 100.0, rule).ok is ok


def test_without_a_target_a_row_only_informs():
    assert BenchmarkRow('memory', math.nan, 'MB').ok


@pytest.mark.parametrize(('bound', 'rule'), [(1.0, None), (None, 'at_least')])
def test_target_and_rule_go_together(bound, rule):
    with pytest.raises(ValueError, match='go together'):
        BenchmarkRow('speed', 1.0, '×', bound, rule)


def test_a_record_has_no_numbers_that_json_lacks():
    record = row_record(
        BenchmarkRow('speed', math.nan, '×', 100.0, 'at_least', 'MoorDyn is absent')
    )
    assert record == {
        'what': 'speed', 'value': None, 'unit': '×', 'target': 100.0, 'ok': False,
        'note': 'MoorDyn is absent',
    }  # fmt: skip


def test_a_target_is_shown_with_its_side():
    assert target(BenchmarkRow('warm', 40.0, 'ms', 50.0, 'at_most')) == '≤ 50 ms'
    assert target(BenchmarkRow('ratio', 6.0, '', 5.0, 'at_least')) == '≥ 5'
    assert target(BenchmarkRow('memory', 6.0, 'MB')) == ''
