# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Measured value with its target range: the row of every report of the lab."""

import math
from dataclasses import dataclass
from typing import Literal

from trawl_ros.core.files import finite
from trawl_ros.report.rendering import number

Rule = Literal['within', 'relative', 'at_most', 'at_least', 'between']


@dataclass(frozen=True)
class TargetRange:
    """Range in which a value is asked to lie; made by `at_most`, `at_least`, `between`, `within`.

    Attributes
    ----------
    rule
        Of the comparison.
    expected
        Reference of the value; a pair (low, high) for the rule ``between``.
    tolerance
        ``within``: the largest absolute difference; ``relative``: the largest difference as
        a share of ``expected``. Unused, and zero, with the other rules.
    """

    rule: Rule
    expected: float | tuple[float, float]
    tolerance: float = 0.0

    def __contains__(self, value: float) -> bool:
        if isinstance(self.expected, tuple):
            low, high = self.expected
            return bool(low <= value <= high)
        if self.rule == 'at_most':
            return bool(value <= self.expected)
        if self.rule == 'at_least':
            return bool(value >= self.expected)
        allowed = self.tolerance * (abs(self.expected) if self.rule == 'relative' else 1.0)
        return bool(abs(value - self.expected) <= allowed)

    def words(self, unit: str = '') -> str:
        """Return the range in symbols: ``≤ 50 ms``."""
        unit = f' {unit}' if unit else ''
        if isinstance(self.expected, tuple):
            low, high = self.expected
            return f'{number(low)} to {number(high)}{unit}'
        text = f'{number(self.expected)}{unit}'
        if self.rule == 'relative':
            return f'{text} ± {number(100 * self.tolerance)} %'
        if self.rule == 'within':
            return f'{text} ± {number(self.tolerance)}' if self.tolerance else text
        return f'{"≤" if self.rule == "at_most" else "≥"} {text}'


def at_most(bound: float) -> TargetRange:
    """Return the range up to a bound."""
    return TargetRange('at_most', bound)


def at_least(bound: float) -> TargetRange:
    """Return the range from a bound on."""
    return TargetRange('at_least', bound)


def between(low: float | None, high: float | None) -> TargetRange | None:
    """Return the range between two bounds; where one is None the other alone bounds it."""
    if low is None or high is None:
        return at_least(low) if low is not None else None if high is None else at_most(high)
    return TargetRange('between', (low, high))


def within(tolerance: float, of: float) -> TargetRange:
    """Return the range of `tolerance` on both sides of a value."""
    return TargetRange('within', of, tolerance)


def within_share(share: float, of: float) -> TargetRange:
    """Return the range of a share of a value on both sides of it."""
    return TargetRange('relative', of, share)


@dataclass(frozen=True)
class MeasuredValue:
    """Measured value with its interval and its target.

    Attributes
    ----------
    what
        One phrase that says what was measured.
    value
        The value; NaN where it could not be measured.
    unit
        Of all its numbers; '' for ratios and counts.
    target
        The range it is asked to lie in; None where it only informs.
    note
        Method of measurement, or source of the target; where it is missed, the reason.
    low, high
        Ends of the interval it lies in, by what `note` says; NaN where there is none.
    key
        Short name, unique in its report, letters, digits and underscores; '' where none is needed.
    """

    what: str
    value: float
    unit: str = ''
    target: TargetRange | None = None
    note: str = ''
    low: float = math.nan
    high: float = math.nan
    key: str = ''

    @property
    def ok(self) -> bool:
        """True if the target is reached or there is none; NaN never reaches a target."""
        return self.target is None or self.value in self.target

    @property
    def wanted(self) -> str:
        """Target in symbols; '' without one."""
        return '' if self.target is None else self.target.words(self.unit)

    @property
    def figure(self) -> str:
        """Value with its unit, rounded for display."""
        return f'{number(self.value)} {self.unit}'.rstrip()

    def record(self) -> dict[str, object]:
        """Return it as plain values; unmeasured values are null.

        A target with a lower end is the pair of its ends.
        """
        target: object = None if self.target is None else self.target.expected
        if self.target is not None and self.target.rule == 'at_least':
            target = (target, None)
        return {
            'what': self.what,
            'value': finite(self.value),
            'low': finite(self.low),
            'high': finite(self.high),
            'unit': self.unit,
            'target': target,
            'ok': self.ok,
            'note': self.note,
        }
