# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Modules of the benchmark, in the order of the report."""

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from types import MappingProxyType

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.report.measured import MeasuredValue, at_least
from trawl_ros.lab.report.page import Findings

TITLES: Mapping[str, str] = MappingProxyType(
    {
        'gear': 'The full gear in motion',
        'derivatives': 'Derivatives of the motion',
        'motion': 'Estimates from a tow in motion',
        'web': 'MoorDyn on a web as large as the gear',
        'wire': 'One wire in motion',
        'equilibrium': 'Steady states of the full gear',
        'fit': 'One fit of twelve coefficients to fifteen states',
        'commands': 'From recorded bags to a result',
        'growth': 'Growth with the number of net nodes',
        'start': 'Cold start of the nodes',
        'recording': 'Recording the full chain',
    }
)
"""Title by module of this folder; each module has ``measure(small) -> Findings``."""

NAMES: tuple[str, ...] = tuple(TITLES)


def check_names(names: tuple[str, ...]) -> None:
    """Reject names of modules that do not exist.

    Raises
    ------
    TrawlError
        If there is no such module.
    """
    for name in names:
        if name not in TITLES:
            raise TrawlError(f'{name}: no such benchmark; expected one of {", ".join(NAMES)}')


def measure(name: str, *, quick: bool) -> Findings:
    """Run one module; ``quick`` is a version for the test suite, which takes seconds.

    A module that fails becomes a missed row and does not end the report.
    """
    module = import_module(f'trawl_ros.lab.benchmark.{name}')
    try:
        found = module.measure(quick)
    except TrawlError as error:
        return Findings(
            (MeasuredValue(f'{name}: runs to its end', 0.0, target=at_least(1.0), note=str(error)),)
        )
    assert isinstance(found, Findings)
    return found


def without_ros(asked: MeasuredValue) -> Findings | None:
    """Return findings that say ROS 2 is missing for this row; None where it is installed."""
    if find_spec('rclpy') is not None:
        return None
    note = 'rclpy is not installed; it is part of ROS 2, or of the extra `ros`'
    return Findings((replace(asked, note=note),))
