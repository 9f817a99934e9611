"""Counts of lines that could not be read, by reason, with the last of them."""

from collections import Counter

from trawl_ros.core.foreign import one_line

MOST_REASONS = 40
"""Different reasons that are counted apart; what is sent may name what it likes."""

SHOWN = 100
"""Characters of a line that are kept."""

OTHERS = 'for other reasons'


class Tally:
    """Tally of lines: how many were understood, and why others were not.

    Attributes
    ----------
    understood, foreign
        Lines that were, and whole sentences that no table has.
    reasons
        Counts by reason, at most `MOST_REASONS` and `OTHERS`.
    last
        The last line that was not, printable and cut, with its reason.
    """

    def __init__(self) -> None:
        self.understood = 0
        self.foreign = 0
        self.reasons: Counter[str] = Counter()
        self.last: tuple[str, str] | None = None

    def refuse(self, reason: str, line: bytes, count: int = 1) -> None:
        """Count lines that were not understood."""
        known = reason in self.reasons or len(self.reasons) < MOST_REASONS
        self.reasons[reason if known else OTHERS] += count
        if line:
            self.last = (one_line(line[: 2 * SHOWN].decode('latin-1').strip(), SHOWN), reason)

    @property
    def refused(self) -> int:
        """Number of lines that were not understood."""
        return self.reasons.total()
