"""Row of the benchmark: a measured figure with its target."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Rule = Literal['at_least', 'at_most']


@dataclass(frozen=True)
class BenchmarkRow:
    """Row: a measured figure with its target.

    Parameters
    ----------
    what
        What was measured, in words.
    value
        The measured figure, in `unit`; NaN where it could not be measured.
    unit
        Unit of `value` and `target`; '' for a pure number.
    target
        Bound asked of the value; None where the figure only informs.
    rule
        Side of `target` the value must lie on; given exactly when `target` is.
    note
        How it was measured, or why the target is missed.
    """

    what: str
    value: float
    unit: str
    target: float | None = None
    rule: Rule | None = None
    note: str = ''

    def __post_init__(self) -> None:
        if (self.target is None) != (self.rule is None):
            raise ValueError(f'{self.what}: a target and a rule go together')

    @property
    def ok(self) -> bool:
        """True if the target is met; true without one. NaN never meets one."""
        if self.target is None:
            return True
        if self.rule == 'at_least':
            return self.value >= self.target
        return self.value <= self.target
