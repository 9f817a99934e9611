"""What a case of validation says: figures beside what is expected of them, and pictures."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from matplotlib.figure import Figure

Rule = Literal['within', 'relative', 'at_most', 'at_least', 'between']


@dataclass(frozen=True)
class Check:
    """One measured figure beside what is expected of it.

    Attributes
    ----------
    key
        Short name, unique in its case, letters, digits and underscores.
    what
        One phrase that says what was measured.
    measured
        The figure; NaN when it could not be measured.
    expected
        What it is held against; a pair (low, high) for the rule ``between``.
    tolerance
        ``within``: the largest absolute difference; ``relative``: the largest difference as
        a share of ``expected``. Unused, and zero, with the other rules.
    rule
        How they are compared.
    unit
        Of ``measured`` and ``expected``; empty for ratios and counts.
    note
        A sentence on where the expectation is from; where the check fails, why it does.
    """

    key: str
    what: str
    measured: float
    expected: float | tuple[float, float]
    tolerance: float = 0.0
    rule: Rule = 'within'
    unit: str = ''
    note: str = ''

    @property
    def ok(self) -> bool:
        """Whether the figure is what was expected; NaN never is."""
        if isinstance(self.expected, tuple):
            low, high = self.expected
            return low <= self.measured <= high
        if self.rule == 'at_most':
            return self.measured <= self.expected
        if self.rule == 'at_least':
            return self.measured >= self.expected
        allowed = self.tolerance * (abs(self.expected) if self.rule == 'relative' else 1.0)
        return abs(self.measured - self.expected) <= allowed


@dataclass(frozen=True)
class Drawing:
    """A figure with its file name (no suffix) and what it shows, in a sentence or two."""

    name: str
    caption: str
    figure: Figure


@dataclass(frozen=True)
class Table:
    """A table of text; all rows as long as ``head``."""

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Outcome:
    """What a case found. ``text`` is a paragraph of plain words for the report."""

    checks: tuple[Check, ...]
    drawings: tuple[Drawing, ...] = ()
    tables: tuple[Table, ...] = ()
    text: str = ''


@dataclass(frozen=True)
class Case:
    """One case: a name for the command line, a title, and the work.

    ``run(small)`` does it; with ``small`` in seconds and on less, for the test suite.
    """

    name: str
    title: str
    run: Callable[[bool], Outcome]
