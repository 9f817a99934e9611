# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Interface of a controller of both winches, by which one is replaced by another."""

from typing import Protocol

from trawl_ros.records.samples import WinchSample


class WinchController(Protocol):
    """Controller of both winches."""

    @property
    def wanted(self) -> tuple[float, float]:
        """Wanted lengths (port, starboard), m."""

    def set_lengths(self, port: float, starboard: float) -> None:
        """Change the set lengths (m)."""

    def update(self, sample: WinchSample) -> tuple[float, float]:
        """Update by a sample; return the wanted lengths (port, starboard), m."""
