# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The cases of ``trawl validate``, in the order of the report."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.report.page import Findings

SECTIONS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        'sea': ('hauls',),
        'tank': ('flume',),
        'closed_forms': (
            'towed_wire',
            'catenary',
            'sinking_line',
            'board_law',
            'free_rotation',
            'energy_budget',
        ),
        'convergence': ('time_step', 'refinement'),
        'paper': (
            'warp_sweep',
            'installation',
            'degrees_of_freedom',
            'identified',
            'sentences',
            'board_frame',
        ),
        'peers': ('moordyn_wire', 'moorpy_wire'),
        'branches': ('steady_states', 'fastening_points'),
        'panels': ('netting',),
    }
)
"""Modules by sub-package of `trawl_ros.lab.validation`; each has a ``CASE`` of its name."""

TITLES: Mapping[str, str] = MappingProxyType(
    {
        'sea': 'Hauls at sea',
        'tank': 'A flume tank',
        'closed_forms': 'Closed forms',
        'convergence': 'Convergence',
        'paper': 'The paper, section IV',
        'peers': 'Peers',
        'branches': 'Branches',
        'panels': 'Netting panels',
    }
)


@dataclass(frozen=True)
class ValidationCase:
    """Case: a name for the command line, a title, and the function that runs it.

    ``run(small)`` runs it; ``quick`` is a version for the test suite, which takes seconds.
    """

    name: str
    title: str
    run: Callable[[bool], Findings]


FIGURES: Mapping[int, str] = MappingProxyType(
    {
        **dict.fromkeys((4, 5), 'identified'),
        6: 'warp_sweep',
        **dict.fromkeys(range(7, 13), 'installation'),
        **dict.fromkeys(range(13, 17), 'degrees_of_freedom'),
    }
)
"""Case that remakes a figure of the paper; figures 1 to 3 are drawings."""

NAMES: tuple[str, ...] = tuple(name for names in SECTIONS.values() for name in names)


def report_section(name: str) -> str:
    """The section a case belongs to.

    Raises
    ------
    TrawlError
        If there is no such case.
    """
    for section, names in SECTIONS.items():
        if name in names:
            return section
    raise TrawlError(f'{name}: no such case; expected one of {", ".join(NAMES)}')


def case_of_figure(number: int) -> str:
    """Name of the case that remakes a figure of the paper.

    Raises
    ------
    TrawlError
        If none does.
    """
    if number not in FIGURES:
        raise TrawlError(
            f'figure {number}: found no case, expected a figure of the paper that shows results, '
            f'{min(FIGURES)} to {max(FIGURES)}'
        )
    return FIGURES[number]


def load_case(name: str) -> ValidationCase:
    """Import one case."""
    module = import_module(f'trawl_ros.lab.validation.{report_section(name)}.{name}')
    case = module.CASE
    assert isinstance(case, ValidationCase)
    return case
