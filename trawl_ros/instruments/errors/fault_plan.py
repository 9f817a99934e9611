# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Plan of faults at given times."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.faults import FaultPanel
from trawl_ros.instruments.errors.instrument import STAMP_TOLERANCE_NS


@dataclass(frozen=True)
class PlannedFault:
    """Planned fault from ``begin`` to ``end`` (s since the first truth; None for no end)."""

    begin: float
    end: float | None
    where: str
    what: str


class FaultPlan:
    """Plan that activates and deactivates faults in time.

    Parameters
    ----------
    faults
        All planned faults; those at places that the panel does not know are ignored.
    panel
        Panel of the instruments.
    """

    def __init__(self, faults: Sequence[PlannedFault], panel: FaultPanel) -> None:
        self._faults = [fault for fault in faults if panel.knows(fault.where)]
        self._panel = panel
        self._on: set[int] = set()
        self._first: int | None = None
        self._latest = 0

    def follow(self, stamp: int) -> None:
        """Advance the plan to a stamp (ns); a stamp before the last one restarts it."""
        if not self._faults:
            return
        if self._first is None or stamp < self._latest:
            self._first = stamp
        self._latest = stamp
        since = (stamp + STAMP_TOLERANCE_NS - self._first) / SECOND
        for number, fault in enumerate(self._faults):
            end = math.inf if fault.end is None else fault.end
            wanted = fault.begin <= since < end
            if wanted and number not in self._on:
                self._panel.switch(fault.where, fault.what)
                self._on.add(number)
            elif not wanted and number in self._on:
                self._panel.switch_off(fault.where, fault.what)
                self._on.discard(number)
