# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Towed wire in MoorDyn."""

import time
from itertools import pairwise

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.manoeuvre import History, WireManoeuvre
from trawl_ros.lab.reference_codes.moordyn import (
    Line,
    LineType,
    MoorDyn,
    Options,
    Point,
    input_file,
)
from trawl_ros.lab.reference_codes.towed_wire import TowedWire, WireSteadyState

BLOCK, LUMP, WIRE_LINE = 0, 1, 0

COUPLING_S = 0.1
"""Longest time (s) over which MoorDyn sees the block in uniform motion."""

SETTLING_S = 2500.0
"""Time (s) in which the wire reaches its steady state from a straight line."""


class MoorDynWire:
    """Towed wire in MoorDyn; it starts straight, towed along x.

    Parameters
    ----------
    wire, segments
        The wire and how finely it is cut.
    scheme, step
        MoorDyn's name of its time scheme, and its step (s).
    lump
        Start of the lump, m behind and below the block.
    coupling
        Longest time (s) over which the block is in uniform motion.
    """

    def __init__(
        self,
        wire: TowedWire,
        segments: int,
        scheme: str,
        step: float,
        lump: tuple[float, float],
        *,
        coupling: float = COUPLING_S,
    ) -> None:
        make = LineType(
            diameter=wire.diameter,
            mass=wire.mass,
            stiffness=wire.stiffness,
            damping=wire.stiffness * wire.damping_time,
            drag=wire.normal_drag,
            added=wire.added_normal,
            drag_along=wire.tangential_drag,
        )
        lag, depth = lump
        points = (
            Point('coupled', (0.0, 0.0, 0.0)),
            Point(
                'free',
                (-lag, 0.0, -depth),
                wire.lump_mass,
                wire.lump_volume,
                wire.lump_drag_area,
                wire.lump_added,
            ),
        )
        lines = (Line(0, LUMP, BLOCK, wire.length, segments),)
        text = input_file((make,), points, lines, Options(scheme, step, wire.density, wire.gravity))
        self._wire = wire
        self._time, self._block = 0.0, np.zeros(3)
        # A whole number of steps, though neither is exact in binary.
        self._coupling = step * max(1, int(coupling / step + 1e-9))
        self._system = MoorDyn(text, self._block, wire.speed * np.array([1.0, 0.0, 0.0]))

    def settle(self, duration: float = SETTLING_S) -> WireSteadyState:
        """Tow straight ahead; return the final state."""
        velocity = self._wire.speed * np.array([1.0, 0.0, 0.0])
        force = np.zeros((1, 3))
        for _ in range(round(duration / self._coupling)):
            force = self._advance(velocity, self._coupling)
        off = self._block - self._system.place(LUMP)
        return WireSteadyState(float(off[2]), float(off[0]), float(np.linalg.norm(force)))

    def follow(self, manoeuvre: WireManoeuvre) -> History:
        """Follow a manoeuvre; positions are those at the ends of steps."""
        count = round(manoeuvre.duration / self._coupling)
        times = self._coupling * np.arange(count + 1, dtype=float)
        track = manoeuvre.track(times)
        lengths = [manoeuvre.length_at(t) for t in times]
        depth, pull = [self.depth()], [np.nan]
        began = time.process_time()
        for (here, there), (short, long) in zip(pairwise(track), pairwise(lengths), strict=True):
            # Chords, so that neither place nor length drifts off.
            self._system.wind(WIRE_LINE, (long - short) / self._coupling)
            force = self._advance((there - here) / self._coupling, self._coupling)
            depth.append(self.depth())
            pull.append(float(np.linalg.norm(force)))
        seconds = time.process_time() - began
        pull[0] = pull[1]
        return History(times, np.array(depth), np.array(pull), seconds)

    def depth(self) -> float:
        """Depth of the lump, m."""
        return float(-self._system.place(LUMP)[2])

    def _advance(self, velocity: FloatArray, step: float) -> FloatArray:
        force = self._system.step(self._block, velocity, self._time, step)
        self._block = self._block + step * velocity
        self._time += step
        return force

    def close(self) -> None:
        """End MoorDyn."""
        self._system.close()
