# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Watermark by the stamps of the winches: without warp lengths there are no windows."""

from dataclasses import dataclass

NANO = 1_000_000_000

PAUSE_NS = 10 * NANO
"""A silence (ns) of the winches after which all channels are waited for again."""


@dataclass
class Watermark:
    """Watermark: the stretches of time in which the winches report, of which the last two count.

    Attributes
    ----------
    first, lead
        First and newest stamp (ns) of the tow, None before any.
    start
        First stamp (ns) of the present stretch.
    """

    first: int | None = None
    lead: int | None = None
    start: int = 0
    _before: int | None = None

    def advance(self, stamp: int) -> None:
        """Advance to a stamp (ns) of the winches."""
        if self.lead is None:
            self.first = self.start = stamp
        elif stamp > self.lead + PAUSE_NS:
            self._before, self.start = self.lead, stamp
        self.lead = stamp if self.lead is None else max(self.lead, stamp)

    def speaks_at(self, stamp: int) -> bool:
        """True if the winches report at a stamp (ns), as far as is known."""
        if self.lead is None:
            return False
        if stamp > self.lead:
            return stamp <= self.lead + PAUSE_NS
        if stamp >= self.start:
            return True
        return self._before is not None and stamp <= self._before + PAUSE_NS
