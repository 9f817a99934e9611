# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Web of a gear's ropes and netting as lines in MoorDyn, towed by prescribed doors."""

import time
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.moordyn import (
    Line,
    LineType,
    MoorDyn,
    Options,
    Point,
    input_file,
)
from trawl_ros.model.assembly import points_of, rest_lengths
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.line import BarProperties
from trawl_ros.model.state import State, Tow

COUPLED = 8
"""Number of prescribed points: the fastening points of both doors, then both blocks."""


@dataclass(frozen=True)
class Web:
    """Web of single-segment lines in tow.

    Each bar of a gear is a line of one segment, and each node a free point. Fastening points and
    towing blocks are coupled points.

    Attributes
    ----------
    kinds, points, lines
        MoorDyn's input, the points in the gear's numbering.
    places, velocities
        (p, 3) of all points at the start, m and m/s.
    density, gravity
        kg/m³, m/s².
    """

    kinds: tuple[LineType, ...]
    points: tuple[Point, ...]
    lines: tuple[Line, ...]
    places: FloatArray
    velocities: FloatArray
    density: float
    gravity: float

    def started(self, scheme: str, step: float) -> MoorDyn:
        """Return the web as a running system in MoorDyn."""
        options = Options(scheme, step, self.density, self.gravity)
        text = input_file(self.kinds, self.points, self.lines, options)
        system = MoorDyn(text, self.places[-COUPLED:], self.velocities[-COUPLED:])
        system.restart(self.places, self.velocities)
        return system


def web_of(model: GearModel, state: State, tow: Tow, damping: float) -> Web:
    """Return the web of a gear in a steady state.

    Parameters
    ----------
    damping
        Inner damping of each line as a share of its critical one.
    """
    at = points_of(model, state, tow)
    rest, _ = rest_lengths(model, tow)
    rows, which = np.unique(_columns(model.bars), axis=0, return_inverse=True)
    lumps = zip(
        at.positions, model.lump_mass, model.lump_volume, model.lump_drag_area, model.lump_added,
        strict=False,
    )  # fmt: skip
    free = [
        Point('free', place, float(mass), float(volume), float(area), _share(added, volume))
        for place, mass, volume, area, added in lumps
    ]
    coupled = [Point('coupled', place) for place in at.positions[-COUPLED:]]
    return Web(
        kinds=tuple(_line_type(row, model.water.density, damping) for row in rows),
        points=(*free, *coupled),
        lines=tuple(
            Line(int(kind), int(a), int(b), float(length), 1)
            for kind, (a, b), length in zip(which.ravel(), model.ends, rest, strict=True)
        ),
        places=at.positions,
        velocities=at.velocities,
        density=model.water.density,
        gravity=model.water.gravity,
    )


def towed(web: Web, scheme: str, step: float, duration: float) -> tuple[FloatArray, float]:
    """Tow a web straight on.

    Returns
    -------
    forces, seconds
        (n, 8, 3) on the coupled points after each step, N, and CPU time, s.

    Raises
    ------
    PeerFailed
        If MoorDyn breaks down.
    """
    places, velocities = web.places[-COUPLED:], web.velocities[-COUPLED:]
    forces = []
    with web.started(scheme, step) as system:
        began = time.process_time()
        for number in range(round(duration / step)):
            since = number * step
            forces.append(system.step(places + since * velocities, velocities, since, step))
        seconds = time.process_time() - began
    return np.array(forces), seconds


def _columns(bars: BarProperties) -> FloatArray:
    columns = (
        bars.stiffness, bars.mass, bars.volume, bars.normal_area * bars.normal_drag,
        bars.wet_area * bars.friction, bars.added_normal, bars.added_tangential,
    )  # fmt: skip
    table: FloatArray = np.array(columns).T
    return table


def _line_type(row: FloatArray, density: float, damping: float) -> LineType:
    """Return a line type with a bar's own areas, on the diameter of its displaced volume."""
    stiffness, mass, volume, across, along, added, added_along = (float(x) for x in row)
    diameter = float(np.sqrt(4.0 * volume / np.pi))
    return LineType(
        diameter=diameter,
        mass=mass,
        stiffness=stiffness,
        damping=-damping,
        drag=across / diameter,
        added=added,
        drag_along=along / (np.pi * diameter),
        added_along=added_along,
    )


def _share(added: float, volume: float) -> float:
    return float(added / volume) if volume else 0.0
