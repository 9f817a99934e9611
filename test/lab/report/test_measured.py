"""A measured value says truly whether its target is reached."""

import math

import pytest

from trawl_ros.lab.report.measured import (
    MeasuredValue,
    at_least,
    at_most,
    between,
    within,
    within_share,
)
from trawl_ros.lab.validation.run import check_record


@pytest.mark.parametrize(
    ('target', 'value', 'ok'),
    [
        (at_least(100.0), 100.0, True),
        (at_least(100.0), 99.9, False),
        (at_most(100.0), 100.0, True),
        (at_most(100.0), 100.1, False),
        (at_least(100.0), math.nan, False),
        (at_most(100.0), math.nan, False),
        (within(0.1, of=1.0), 1.05, True),
        (within(0.1, of=1.0), 1.15, False),
        (within(1.0, of=0.0), math.nan, False),
        (within_share(0.1, of=100.0), 105.0, True),
        (within_share(0.1, of=-100.0), -115.0, False),
        (between(0.0, 1.0), 0.5, True),
        (between(0.0, 1.0), 1.5, False),
        (between(0.0, 1.0), math.nan, False),
        (between(None, 1.0), 2.0, False),
        (between(1.0, None), 2.0, True),
        (between(None, None), math.nan, True),
        (None, math.nan, True),
    ],
)
def test_it_is_reached_where_the_value_lies_in_it(target, value, ok):
    assert MeasuredValue('speed', value, '×', target).ok is ok


def test_a_target_is_shown_with_its_side():
    assert MeasuredValue('warm', 40.0, 'ms', at_most(50.0)).wanted == '≤ 50 ms'
    assert MeasuredValue('ratio', 6.0, '', at_least(5.0)).wanted == '≥ 5'
    assert MeasuredValue('share', 6.0, '%', between(5.0, 7.0)).wanted == '5 to 7 %'
    assert MeasuredValue('depth', 6.0, 'm', within_share(0.01, of=5.0)).wanted == '5 m ± 1 %'
    assert MeasuredValue('depth', 6.0, 'm', within(0.5, of=5.0)).wanted == '5 m ± 0.5'
    assert MeasuredValue('count', 6.0, '', within(0.0, of=5.0)).wanted == '5'
    assert MeasuredValue('memory', 6.0, 'MB').wanted == ''


def test_records_keep_the_keys_of_their_reports_and_have_no_numbers_that_json_lacks():
    row = MeasuredValue('speed', math.nan, '×', at_least(100.0), 'no MoorDyn', key='speed')
    assert row.record() == {
        'what': 'speed', 'value': None, 'low': None, 'high': None, 'unit': '×',
        'target': (100.0, None), 'ok': False, 'note': 'no MoorDyn',
    }  # fmt: skip
    assert check_record(row) == {
        'what': 'speed', 'measured': None, 'expected': 100.0, 'tolerance': 0.0, 'rule': 'at_least',
        'unit': '×', 'ok': False, 'note': 'no MoorDyn',
    }  # fmt: skip
