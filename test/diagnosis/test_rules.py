"""Each rule alone keeps an effect from being named."""

import re
from dataclasses import replace

import pytest

from trawl_ros.diagnosis.rules import Grounds, judge, judge_beside, judge_form

SOUND = Grounds(
    delta_bic=40.0,
    gain=5.0,
    gain_low=2.0,
    share=1.0,
    at_bound=False,
    left_over=0.4,
    left_share=0.5,
    rivals=(),
)


def test_an_effect_with_all_grounds_is_named():
    assert judge(SOUND)[0] == 'NAMED'


@pytest.mark.parametrize(
    ('change', 'verdict', 'why'),
    [
        ({'left_over': 1e-5}, 'UNKNOWN', 'does not look like errors'),
        ({'left_over': 1e-5, 'left_share': 0.05, 'rivals': ('heave',)}, 'AMBIGUOUS', 'heave'),
        ({'left_over': 1e-10, 'left_share': 0.01}, 'UNKNOWN', 'does not look like errors'),
        ({'noise': 1.8}, 'UNKNOWN', '1.8 times what is stated'),
        ({'rivals': ('heave',)}, 'AMBIGUOUS', 'heave would explain it nearly as well'),
        ({'delta_bic': 9.0}, 'AMBIGUOUS', 'too weak to name it: .* lowers BIC by 9.0 only'),
        ({'delta_bic': -1.0}, 'UNKNOWN', 'does not help to predict'),
        ({'at_bound': True}, 'UNKNOWN', 'stronger than is possible'),
        ({'gain_low': -0.1}, 'AMBIGUOUS', 'too weak to name it: not all'),
        ({'gain': -0.1, 'gain_low': -3.0}, 'UNKNOWN', 'does not help to predict'),
        (
            {'worse': ('tension', 'vertical_opening')},
            'UNKNOWN',
            'makes tension and vertical opening worse than the boards alone',
        ),
        ({'worse': ('tension',), 'rivals': ('heave',)}, 'AMBIGUOUS', 'makes tension worse'),
        ({'share': 0.7}, 'AMBIGUOUS', 'in 30% of the resampled trials'),
    ],
)
def test_each_ground_is_needed(change, verdict, why):
    found, reason = judge(replace(SOUND, **change))
    assert found == verdict
    assert re.search(why, reason)


def test_a_change_of_the_gear_file_that_explains_as_much_makes_a_name_doubtful():
    mimics = {'larger boards, by about 11 %': -1.0, 'thicker warps, by about 25 %': -5.0}
    verdict, reason = judge_beside(*judge(SOUND), mimics)
    assert verdict == 'AMBIGUOUS'
    assert '; or '.join(mimics) in reason
    assert 'it alone' not in reason
    assert judge_beside(*judge(SOUND), {}) == judge(SOUND)


def test_it_is_told_too_where_a_name_is_doubtful_already():
    doubtful = judge(replace(SOUND, rivals=('heave',)))
    verdict, reason = judge_beside(*doubtful, {'thicker warps, by about 25 %': 9.0})
    assert verdict == 'AMBIGUOUS'
    assert reason.startswith(doubtful[1])
    assert 'thicker warps, by about 25 %' in reason.removeprefix(doubtful[1])
    assert judge_beside(*doubtful, {}) == doubtful


def test_what_explains_it_far_better_and_is_in_no_catalogue_leaves_no_name():
    mimics = {'readings of door spread that drift by about 3 m per h': 30.0, 'larger boards': 2.0}
    verdict, reason = judge_beside(*judge(SOUND), mimics)
    assert verdict == 'UNKNOWN'
    assert reason.endswith(f': {next(iter(mimics))}')
    assert 'larger boards' not in reason


def test_an_effect_with_a_form_that_explains_more_is_told_with_it_and_not_named():
    form = 'thinner twine, by about 6 %'
    verdict, reason = judge_form(form)
    assert verdict == 'AMBIGUOUS'
    assert reason.endswith(f': {form}')
