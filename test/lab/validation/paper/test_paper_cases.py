"""The small version of each case on section IV: complete, drawn, and every failure explained."""

from functools import cache

import pytest

from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.validation.cases import SECTIONS, load_case

FIGURES = {
    'warp_sweep': ('fig6',),
    'installation': ('fig7_to_12',),
    'degrees_of_freedom': ('fig13_to_16', 'all_states'),
    'identified': ('fig4', 'fig5'),
    'sentences': (),
    'board_frame': (),
}


LONG = ('degrees_of_freedom', 'identified', 'board_frame')
"""Cases that take more than ten seconds even in small."""


@cache
def quick(name: str) -> Findings:
    """The small version of a case, run once."""
    return load_case(name).run(True)


@pytest.mark.timeout(120)
@pytest.mark.parametrize(
    'name',
    [
        pytest.param(name, marks=pytest.mark.slow if name in LONG else ())
        for name in SECTIONS['paper']
    ],
)
def test_a_small_case_is_whole(name: str) -> None:
    found = quick(name)
    assert tuple(drawing.name for drawing in found.drawings) == FIGURES[name]
    for table in found.tables:
        assert all(len(row) == len(table.head) for row in table.rows)
    keys = [check.key for check in found.rows]
    assert len(set(keys)) == len(keys)
    for check in found.rows:
        assert check.value == check.value, check.key
        assert check.ok or check.note, check.key
    if name != 'sentences':
        assert all(check.ok for check in found.rows), found.rows


DIRECTIONS = (
    'lift_slope',
    'drag_slope',
    'tension_follows',
    'epsilon_inclination',
    'epsilon_rolling',
    'eta_attack',
    'eta_rolling',
    'lift_growth',
    'growth_door_depth',
    'growth_net_depth',
    'lean_growth',
    'upward_growth',
)
"""Sentences that hold for the coarser net of the small version too. The report states others as
misses: ε +5° raises α by 2.8° only, η +5° lowers δ by 0.4°, and ζ changes depth more than ε."""


@pytest.mark.timeout(120)
def test_directions_are_the_papers() -> None:
    checks = {check.key: check for check in quick('sentences').rows}
    for key in DIRECTIONS:
        assert checks[key].ok, checks[key]
