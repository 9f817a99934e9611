"""Row of a study: a measured figure with its interval and target."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class StudyRow:
    """Row: a measured figure.

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
        What the value may be at most; None where there is no such limit.
    note
        How it was measured, or why the target is missed.
    least
        What the value must be at least; None where there is no such limit.
    """

    what: str
    value: float
    low: float = math.nan
    high: float = math.nan
    unit: str = ''
    target: float | None = None
    note: str = ''
    least: float | None = None

    @property
    def asked(self) -> bool:
        """True if the row has a target; else it only informs."""
        return self.target is not None or self.least is not None

    @property
    def ok(self) -> bool:
        """True if the target is met; true without one. NaN never meets any."""
        return (self.target is None or self.value <= self.target) and (
            self.least is None or self.value >= self.least
        )

    def record(self) -> dict[str, object]:
        """Return the row as plain values; what could not be measured is null.

        A target with a lower end is the pair of its ends.
        """
        numbers = {'value': self.value, 'low': self.low, 'high': self.high}
        known = {key: value if math.isfinite(value) else None for key, value in numbers.items()}
        return {
            'what': self.what,
            **known,
            'unit': self.unit,
            'target': self.target if self.least is None else [self.least, self.target],
            'ok': bool(self.ok),
            'note': self.note,
        }
