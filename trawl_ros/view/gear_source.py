# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Shape of the gear during a tow: from markers if there are any, else truth, else readings."""

from typing import Any

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.gear.records import GearRecord
from trawl_ros.messages.pieces import read_orientation, read_vector
from trawl_ros.plots.moments import MOUTH, Moment
from trawl_ros.plots.records import Quantities, Series, Strand, TowHistory
from trawl_ros.plots.shapes import FROM_MARKERS, gear_shape, strands_of
from trawl_ros.view.records import Gear, Plate
from trawl_ros.view.ship import ShipFollower

MARKERS_HOLD_S = 10.0
"""Silence of markers after which another source draws the gear.

It is also at least three times the interval of markers.
"""

PERIOD_S = 1.0
"""Shortest time between two shapes from truth or readings."""

PATIENCE_S = 2.0
"""Time at the beginning during which only markers and truth are used."""

VALUE_HOLDS_S = 30.0
"""Time for which a value is used."""


class GearFollower:
    """Shapes of the gear, one a second or fewer.

    Parameters
    ----------
    gear
        Gives what straight lines need: distance of the blocks, size of doors, length of bridles.
    ship
        The ship that tows it.
    apart_s
        Between two shapes, also between two arrays of markers.
    """

    def __init__(self, gear: GearRecord, ship: ShipFollower, apart_s: float) -> None:
        self._period = round(max(PERIOD_S, apart_s) * SECOND)
        self._hold = round(max(MARKERS_HOLD_S, 3.0 * apart_s) * SECOND)
        self._gear = gear
        self._ship = ship
        self._latest: dict[str, dict[str, tuple[int, float]]] = {'truth': {}, 'measured': {}}
        self._mouth: tuple[int, Any] | None = None
        self._markers: int | None = None
        self._next: int | None = None

    def markers(self, stamp: int, array: Any) -> Gear | None:
        """Draw markers; None if they are empty."""
        strands: list[Strand] = []
        plates: list[Plate] = []
        for marker in array.markers:
            if marker.type == marker.CUBE:
                plates.append(
                    Plate(
                        marker.ns,
                        read_vector(marker.pose.position),
                        read_orientation('truth/gear', marker.pose.orientation),
                        read_vector(marker.scale),
                    )
                )
            elif marker.type != marker.SPHERE:
                strands += strands_of(marker)
        if not strands and not plates:
            return None
        self._markers = stamp
        return Gear(stamp, tuple(strands), tuple(plates), FROM_MARKERS)

    def mouth(self, stamp: int, polygon: Any) -> None:
        """Take the true mouth."""
        self._mouth = stamp, polygon

    def take(self, quantities: Quantities) -> None:
        """Take values."""
        if quantities.kind in self._latest:
            latest = self._latest[quantities.kind]
            for name, value in quantities.values.items():
                if np.isfinite(value):
                    latest[name] = quantities.stamp, value

    def drawn(self, stamp: int) -> Gear | None:
        """Draw truth or readings if it is time and there are no markers."""
        if self._next is None:
            self._next = stamp + round(PATIENCE_S * SECOND)
        # A stamp far back belongs to a tow that has begun again.
        if stamp < self._next - self._period - round(PATIENCE_S * SECOND):
            self._next, self._markers = stamp, None
        if stamp < self._next:
            return None
        self._next = stamp + self._period
        if self._markers is not None and stamp - self._markers <= self._hold:
            return None
        shape = gear_shape(self._moment(stamp), self._history(stamp), self._gear)
        if shape is None:
            return None
        strands = tuple(
            Strand(strand.name, self._from_ship(strand.pieces), strand.colours)
            for strand in shape.strands
        )
        return Gear(stamp, strands, (), shape.source)

    def _moment(self, stamp: int) -> Moment:
        held = self._mouth is not None and abs(stamp - self._mouth[0]) <= VALUE_HOLDS_S * SECOND
        return Moment(0.0, {MOUTH: self._mouth[1]} if held and self._mouth else {})

    def _history(self, stamp: int) -> TowHistory:
        """Return the newest values as series around now, which is time 0."""
        truth, measured = (
            {
                name: Series(np.zeros(1), np.array([value]))
                for name, (at, value) in self._latest[kind].items()
                if abs(stamp - at) <= VALUE_HOLDS_S * SECOND
            }
            for kind in ('truth', 'measured')
        )
        return TowHistory('', stamp, 0.0, truth, measured, 0, ())

    def _from_ship(self, pieces: FloatArray) -> FloatArray:
        """Convert pieces (n, 2, 3) in the ship's axes (astern, to port, up) to ``map``."""
        ahead = pieces.reshape(-1, 3) * [-1.0, 1.0, 1.0]
        return self._ship.in_map(ahead).reshape(pieces.shape)
