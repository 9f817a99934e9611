# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of nodes that estimate: windows, and advice on the next manoeuvre."""

import math

from trawl_ros.estimation.planning.states import Limits
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.nodes.runtime.parameters import Flag, Number, ParameterError, Parameters, Text
from trawl_ros.records.towing_limits import LIMITS

MOST_MANOEUVRES = 200
"""Manoeuvres that are looked up at most; each is a steady state to be solved and ranked."""

CHOICE = Limits()


def _listed(values: tuple[float, ...]) -> str:
    return ', '.join(f'{value:g}' for value in values)


ADVICE_SPECS = (
    Flag('advise', True, 'Whether to look for the manoeuvre that would teach most.'),
    Number('advise_share', 0.03, 'of a core', 0.01, 1.0, 'Most of a core that looking manoeuvres '
           'up takes; a simulation that runs fast wants more.'),
    Text('advise_lengths_m', _listed(CHOICE.lengths), 'Warp lengths among which to choose, m.'),
    Text('advise_speeds_m_s', _listed(CHOICE.speeds), 'Speeds among which to choose, m/s.'),
)  # fmt: skip


def advice_limits(parameters: Parameters) -> Limits:
    """Return the limits of the choice of a node that declares `ADVICE_SPECS`.

    Raises
    ------
    ParameterError
        If lengths or speeds are no list of numbers in their range, or are too many.
    """
    limits = Limits(
        lengths=_numbers(parameters, 'advise_lengths_m', *LIMITS.warp_m),
        speeds=_numbers(parameters, 'advise_speeds_m_s', *LIMITS.speed_m_s),
    )
    number = len(limits.lengths) * len(limits.speeds) * (1 + len(limits.shorter))
    if number > MOST_MANOEUVRES:
        raise ParameterError(
            f'parameters advise_lengths_m and advise_speeds_m_s: found {number} manoeuvres, '
            f'expected {MOST_MANOEUVRES} at most'
        )
    return limits


def _numbers(parameters: Parameters, name: str, low: float, high: float) -> tuple[float, ...]:
    text = parameters[name]
    try:
        values = tuple(sorted({float(part) for part in text.split(',')}))
    except ValueError:
        values = ()
    if not values or not all(math.isfinite(value) and low <= value <= high for value in values):
        raise ParameterError(
            f'parameter {name}: found {text!r}, expected numbers from {low:g} to {high:g}, '
            'with commas between them'
        )
    return values


WINDOW_SPECS = (
    Number('settle_s', WindowOptions.settle_s, 's', 0.0, 3600.0, 'Least time the gear is given '
           'after each change of warp length, speed or heading.'),
    Number('settle_passages', WindowOptions.settle_passages, 'times', 0.0, 10.0, 'How often the '
           'ship passes the length of her gear before it counts as settled.'),
    Number('window_s', WindowOptions.window_s, 's', 20.0, 3600.0, 'Length of a steady window.'),
)  # fmt: skip


def window_options(parameters: Parameters) -> WindowOptions:
    """Return the window options of a node that declares `WINDOW_SPECS`."""
    return WindowOptions(**{spec.name: parameters[spec.name] for spec in WINDOW_SPECS})
