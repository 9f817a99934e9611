"""Sentences beside checks: what agrees, what does not, and that the reason is told."""

import numpy as np

from trawl_ros.lab.report.measured import MeasuredValue, at_least, between
from trawl_ros.lab.validation.paper.claim import claim, claim_table


def test_a_sentence_agrees_in_full_in_part_or_not() -> None:
    holds = MeasuredValue('a growth', 0.2, 'm', at_least(0.0), 'never told', key='one')
    fails = MeasuredValue('a size', 3.0, '%', between(5.0, 10.0), 'it is small.', key='two')
    assert claim('IV', 'it grows', holds).agrees == 'yes'
    assert claim('IV', 'it grows by 5-10 %', holds, fails).agrees == 'in part'
    assert claim('IV', 'by 5-10 %', fails).agrees == 'no'


def test_only_what_fails_is_told_why() -> None:
    holds = MeasuredValue('a growth', 0.2, 'm', at_least(0.0), 'never told', key='one')
    fails = MeasuredValue('a size', 3.0, '%', between(5.0, 10.0), 'it is small.', key='two')
    both = claim('IV.C, Fig. 9', 'it grows by 5-10 %', holds, fails)
    ((where, says, gives, agrees, why),) = claim_table([both]).rows
    assert (where, says, agrees) == ('IV.C, Fig. 9', 'it grows by 5-10 %', 'in part')
    assert 'a growth: 0.2 m (≥ 0 m)' in gives
    assert 'a size: 3 % (5 to 10 %)' in gives
    assert why == 'it is small.'
    first, second = (check.note for check in both.checks)
    assert 'IV.C, Fig. 9: it grows' in first
    assert second == 'it is small.'


def test_what_could_not_be_measured_does_not_hold() -> None:
    unknown = MeasuredValue('a growth', np.nan, target=at_least(0.0), note='why', key='one')
    assert claim('IV', 'it grows', unknown).agrees == 'no'
