"""Records of a validation case: figures with their targets, drawings and tables."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from matplotlib.figure import Figure

Rule = Literal['within', 'relative', 'at_most', 'at_least', 'between']


@dataclass(frozen=True)
class Check:
    """Check: a measured figure with its target.

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
        """True if the figure meets its target; NaN never does."""
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
class CaseFigure:
    """Drawing: a figure with its file name (no suffix) and a caption of a sentence or two."""

    name: str
    caption: str
    figure: Figure


@dataclass(frozen=True)
class TextTable:
    """Table of text; all rows as long as ``head``."""

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class CaseOutcome:
    """Outcome of a case. ``text`` is a paragraph of plain words for the report."""

    checks: tuple[Check, ...]
    drawings: tuple[CaseFigure, ...] = ()
    tables: tuple[TextTable, ...] = ()
    text: str = ''


@dataclass(frozen=True)
class ValidationCase:
    """Case: a name for the command line, a title, and the function that runs it.

    ``run(small)`` does it; with ``small`` in seconds and on less, for the test suite.
    """

    name: str
    title: str
    run: Callable[[bool], CaseOutcome]
