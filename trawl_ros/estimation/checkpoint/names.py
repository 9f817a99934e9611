# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Names that classes had in checkpoints of version 0.1.0."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from trawl_ros.estimation.windows.sounder import KEPT
from trawl_ros.records.coefficients import COEFFICIENTS

MODULES: Mapping[str, str] = MappingProxyType(
    {
        'trawl_ros.identification.buffers': 'trawl_ros.estimation.windows.buffers',
        'trawl_ros.identification.channels': 'trawl_ros.records.channels',
        'trawl_ros.identification.error_terms': 'trawl_ros.estimation.fit.error_terms',
        'trawl_ros.identification.estimate': 'trawl_ros.estimation.fit.estimate',
        'trawl_ros.identification.estimator': 'trawl_ros.estimation.fit.estimator',
        'trawl_ros.identification.estimator_options': 'trawl_ros.estimation.fit.estimator_options',
        'trawl_ros.identification.fit': 'trawl_ros.estimation.fit.fit',
        'trawl_ros.identification.guard': 'trawl_ros.estimation.window_gate',
        'trawl_ros.identification.linearised': 'trawl_ros.estimation.fit.linearised',
        'trawl_ros.identification.operation': 'trawl_ros.estimation.windows.operation',
        'trawl_ros.identification.order': 'trawl_ros.estimation.windows.timestamp_check',
        'trawl_ros.identification.over_ground': 'trawl_ros.estimation.windows.over_ground',
        'trawl_ros.identification.pipeline': 'trawl_ros.estimation.pipeline',
        'trawl_ros.identification.prior': 'trawl_ros.estimation.fit.parameters',
        'trawl_ros.identification.rejections': 'trawl_ros.estimation.windows.records',
        'trawl_ros.identification.screening': 'trawl_ros.estimation.screening',
        'trawl_ros.identification.timeline': 'trawl_ros.estimation.windows.watermark',
        'trawl_ros.identification.window_records': 'trawl_ros.estimation.windows.records',
        'trawl_ros.identification.windows': 'trawl_ros.estimation.windows.finder',
    }
)

CLASSES: Mapping[str, str] = MappingProxyType(
    {
        'Guard': 'WindowGate',
        'Order': 'TimestampCheck',
        'Judgement': 'ScreeningResult',
        'Timeline': 'Watermark',
        'BoardPrior': 'ParameterVector',
    }
)


FIELDS: Mapping[str, str] = MappingProxyType(
    {
        'freedom': 'degrees_of_freedom',
        'misfit': 'birge_ratio',
        'guard': 'gate',
        '_timeline': '_winch_watermark',
    }
)


ADDED: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        'Estimate': {'names': {'number': -6, 'tuple': list(COEFFICIENTS)}},
        'SteadyWindow': {'seabed': None},
        'SteadyWindowFinder': {
            '_sounder': {
                'number': -5,
                'object': 'trawl_ros.estimation.windows.sounder.Sounder',
                'has': {'_soundings': {'number': -4, 'deque': [], 'most': KEPT}},
            }
        },
    }
)
"""Attributes, packed, that classes had not: all boards followed eq. 14, and the water's depth was
not known. No packer gives a negative number."""


def present(name: str, has: Mapping[str, Any]) -> tuple[str, Mapping[str, Any]]:
    """Give the name that a class has now, and its attributes as they are called now.

    A class that has not moved keeps its own.
    """
    module, _, own = name.rpartition('.')
    if module not in MODULES:
        return name, has
    now = {FIELDS.get(key, key): value for key, value in has.items()}
    if own == 'BoardPrior' and 'names' in now:
        now['groups'] = _groups(now.pop('names'))
    return f'{MODULES[module]}.{CLASSES.get(own, own)}', {**ADDED.get(own, {}), **now}


def _groups(names: Any) -> Any:
    """Groups of a parameter vector, packed, of packed names of coefficients: all there was."""
    units = {'number': -3, 'tuple': [''] * len(COEFFICIENTS)}
    has = {'kind': 'coefficients', 'names': names, 'units': units}
    name = 'trawl_ros.estimation.fit.parameters.ParameterGroup'
    # No packer gives a negative number.
    return {'number': -1, 'tuple': [{'number': -2, 'object': name, 'has': has}]}
