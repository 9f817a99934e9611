"""One measured figure of a study, the range it lies in, and what was asked of it."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A measured figure.

    Parameters
    ----------
    what
        What was measured, in words.
    value
        The figure, in `unit`; NaN where it could not be measured.
    low, high
        Ends of the range it lies in, by what `note` says; NaN where there is none.
    unit
        Of the figures; '' for a pure number.
    target
        What the value may be at most; None where it only informs.
    note
        How it was measured, or why the target is missed.
    """

    what: str
    value: float
    low: float = math.nan
    high: float = math.nan
    unit: str = ''
    target: float | None = None
    note: str = ''

    @property
    def ok(self) -> bool:
        """Whether the target is met; true where there is none. NaN never meets one."""
        return self.target is None or self.value <= self.target

    def record(self) -> dict[str, object]:
        """The row as plain values; what could not be measured is null."""
        numbers = {'value': self.value, 'low': self.low, 'high': self.high}
        known = {key: value if math.isfinite(value) else None for key, value in numbers.items()}
        return {
            'what': self.what,
            **known,
            'unit': self.unit,
            'target': self.target,
            'ok': bool(self.ok),
            'note': self.note,
        }
