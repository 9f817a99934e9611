# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady towed wire in MoorPy: a catenary under its weight and mean drag.

The wire stands still in a current. MoorPy takes the drag on a line's last shape as constant
along it, so a solution is repeated until that drag no longer changes.
"""

from typing import Any

import numpy as np

from trawl_ros.lab.reference_codes.absent import PeerFailed, peer
from trawl_ros.lab.reference_codes.moordyn import WATER_DEPTH_M
from trawl_ros.lab.reference_codes.towed_wire import TowedWire, WireSteadyState

LINE_PIECES = 40
"""Number of pieces of the line over which MoorPy sums its drag."""

POSITION_TOLERANCE_M = 1e-4
"""Tolerance of the lump's position (m) between two solutions."""

MAX_SOLUTIONS = 50


class MoorPyWire:
    """Towed wire with its lump in MoorPy, as one line between a fixed and a free point.

    Raises
    ------
    PeerAbsent
        If MoorPy is not installed.
    """

    def __init__(self, wire: TowedWire) -> None:
        moorpy: Any = peer('moorpy')
        self._error: type[Exception] = moorpy.helpers.Error
        self._system = moorpy.System(
            depth=WATER_DEPTH_M, rho=wire.density, g=wire.gravity, current=[-wire.speed, 0.0, 0.0]
        )
        make = {
            'name': 'wire',
            'd_vol': wire.diameter,
            'm': wire.mass,
            'w': wire.weight_in_water,
            'EA': wire.stiffness,
            'Cd': wire.normal_drag,
            'CdAx': wire.tangential_drag,
        }
        drag = 0.5 * wire.density * wire.lump_drag_area * wire.speed**2
        start = wire.length / np.sqrt(2.0) * np.array([-1.0, 0.0, -1.0])
        self._system.addPoint(1, [0.0, 0.0, 0.0])
        self._lump = self._system.addPoint(
            0, start, m=wire.lump_mass, v=wire.lump_volume, fExt=[-drag, 0.0, 0.0]
        )
        self._line = self._system.addLine(wire.length, make, nSegs=LINE_PIECES, pointA=2, pointB=1)
        self._system.initialize()

    def solve(self, length: float | None = None) -> WireSteadyState:
        """Solve the steady state, starting from the last; with another ``length`` (m) if given.

        Raises
        ------
        PeerFailed
            If MoorPy finds none.
        """
        if length is not None:
            self._line.setL(length)
        for _ in range(MAX_SOLUTIONS):
            before = np.array(self._lump.r)
            try:
                self._system.solveEquilibrium(tol=0.1 * POSITION_TOLERANCE_M)
            except self._error as error:
                raise PeerFailed(
                    f'MoorPy found no equilibrium of the towed wire: {error}'
                ) from None
            if np.abs(self._lump.r - before).max() < POSITION_TOLERANCE_M:
                x, _, z = self._lump.r
                return WireSteadyState(float(-z), float(-x), float(np.linalg.norm(self._line.fB)))
        raise PeerFailed(f'MoorPy still moves the towed wire after {MAX_SOLUTIONS} solutions')
