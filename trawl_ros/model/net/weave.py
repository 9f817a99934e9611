# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Nodes and bars of a net, row by row, for any outline of the mouth and any netting."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.netting import NettingRecord
from trawl_ros.model.net.kite_nodes import KiteNodes
from trawl_ros.model.net.planned_mouth import FrameRope
from trawl_ros.model.net.rows import NettingRow, Profile

FIRST_OPENING, FIRST_LENGTH, FIRST_HEIGHT = 0.4, 0.85, 0.6
"""Shape of a net as drawn, before any force: its circumference and length over the stretched ones,
and its height over its width. Meshes are slack, so the first step does not overstretch them."""


@dataclass(frozen=True)
class NetBar:
    """Numerical bar between two nodes of the net, with the properties of `line.BarProperties`.

    ``normal`` and ``sliding`` are the parts of its area that single twines of the same drag have,
    across them and along; ``diameter`` (m) is that of its twine, ``lift`` the κ of its sheet.
    """

    start: int
    end: int
    rest: float
    stiffness: float
    area: float
    volume: float
    mass: float
    bow: float
    group: str
    normal: float
    sliding: float
    diameter: float
    lift: float


@dataclass
class NetMesh:
    """Nodes and bars of the net.

    Attributes
    ----------
    positions : (n, 3) array
        First guess, x forward from the wing tips, y to port, z up, m.
    bars
        Bars of the netting.
    knot_area, knot_root, knot_volume : (n,) arrays
        Area of knots (m²), the area over the root of their diameter (m^1.5), and volume (m³).
    line_drag_area, line_viscous_area : (n,) arrays
        C_D S (m²) of the codend's nodes, and its viscous part (m² √(m/s)).
    headrope, footrope
        Nodes from the port to the starboard wing tip.
    edge_rest
        Length of a bar of a wing's edge, m.
    wing_ends
        Nodes joined by the wing-end lines or side ropes, from the top down.
    kite
        Nodes that carry the kite.
    tips
        Nodes to which bridles are shackled: port upper and lower, starboard upper and lower.
    knot_density
        Density of knots, kg/m³.
    frame
        Headrope, footrope and side rope of a planned net.
    """

    positions: FloatArray
    bars: list[NetBar]
    knot_area: FloatArray
    knot_root: FloatArray
    knot_volume: FloatArray
    line_drag_area: FloatArray
    line_viscous_area: FloatArray
    headrope: list[int]
    footrope: list[int]
    edge_rest: float
    wing_ends: list[list[int]]
    kite: KiteNodes
    tips: tuple[int, ...]
    knot_density: float
    frame: tuple[FrameRope, FrameRope, FrameRope] | None = None


@dataclass
class Weave:
    """Net under construction.

    ``index`` has its nodes by row and number around. Arrays are per node, as in `NetMesh`.
    """

    index: dict[tuple[int, int], int] = field(default_factory=dict)
    positions: list[tuple[float, float, float]] = field(default_factory=list)
    bars: list[NetBar] = field(default_factory=list)
    knot_area: FloatArray = field(default_factory=lambda: np.zeros(0))
    knot_root: FloatArray = field(default_factory=lambda: np.zeros(0))
    knot_volume: FloatArray = field(default_factory=lambda: np.zeros(0))
    line_drag: FloatArray = field(default_factory=lambda: np.zeros(0))
    line_viscous: FloatArray = field(default_factory=lambda: np.zeros(0))


def weave(
    net: NettingRecord,
    body: Profile,
    wings: list[NettingRow],
    rows: tuple[NettingRow, ...],
    holds: Callable[[int, int], bool],
    sums: Callable[[int, NettingRow, int, int], dict[str, float]],
    rest: Callable[[int, NettingRow, int], float] = lambda _, row, __: row.rest,
) -> Weave:
    """Make the nodes and bars of the rows of wings and body.

    Parameters
    ----------
    net
        Constants of knots and bars.
    body
        Profile whose circumferences determine the first guess of positions.
    wings, rows
        Rows ahead of the mouth, which have negative numbers, and behind it.
    holds
        True for a node (row, number around) ahead of the mouth that belongs to the net.
    sums
        Sums of `Profile.per_mesh_column` for the bar of a row from one number around to another.
    rest
        Length of the bars of a row at a number around; that of the row by default.
    """
    made = Weave()
    ahead = wings[0].front if wings else 0.0

    def add(edge: int, x: float, around: int, odd: bool) -> None:
        _, circumference = body.at(x)
        radius = FIRST_OPENING * circumference / (2 * np.pi)
        for j in range(around):
            if edge >= 0 or holds(edge, j):
                phi = (j + 0.5 * odd) * 2 * np.pi / around
                made.index[edge, j] = len(made.positions)
                made.positions.append(
                    (
                        -FIRST_LENGTH * (x - ahead),
                        radius * np.sin(phi),
                        FIRST_HEIGHT * radius * np.cos(phi),
                    )
                )

    for k, row in enumerate([*wings, *rows], -len(wings)):
        add(k, row.front, row.around, row.odd)
    last = rows[-1]
    add(len(rows), last.back, last.columns, not last.joins and not last.odd)
    made.knot_area = np.zeros(len(made.positions) + net.codend_segments)
    made.knot_root = np.zeros_like(made.knot_area)
    made.knot_volume = np.zeros_like(made.knot_area)
    made.line_drag = np.zeros_like(made.knot_area)
    made.line_viscous = np.zeros_like(made.knot_area)
    for k, row in enumerate([*wings, *rows], -len(wings)):
        for j in range(row.around):
            for other in _behind(row, j):
                if (k, j) not in made.index or (k + 1, other) not in made.index:
                    continue
                a, b = made.index[k, j], made.index[k + 1, other]
                own = sums(k, row, j, other)
                made.bars.append(
                    _bar(a, b, rest(k, row, j), own, net.bowing_pressure_pa, 'netting')
                )
                made.knot_area[[a, b]] += 0.5 * own['knots'] * net.knot_diameters**2
                made.knot_root[[a, b]] += 0.5 * own['knot_root'] * net.knot_diameters**1.5
                made.knot_volume[[a, b]] += 0.5 * own['knot_volume'] * net.knot_diameters**3
    return made


def _bar(
    a: int, b: int, rest: float, sums: dict[str, float], pressure: float, group: str
) -> NetBar:
    # Netting of almost no circumference has no twine.
    area = max(sums['area'], 1e-12)
    sag = pressure * sums['width'] * rest / sums['stiffness'] if sums['stiffness'] else 0.0
    return NetBar(
        a,
        b,
        rest,
        sums['stiffness'] / rest,
        sums['area'] / rest,
        sums['volume'] / rest,
        sums['mass'] / rest,
        sag**2 / 24.0,
        group,
        sums['normal'] / area,
        sums['sliding'] / area,
        4.0 / np.pi * sums['volume'] / area,
        sums['lift'] / area,
    )


def _behind(row: NettingRow, j: int) -> tuple[int, ...]:
    """Return the nodes of the back edge that are tied to node ``j`` of the front edge."""
    if row.straight:
        return (j,)
    if row.joins:
        return (((j + 1) // 2) % row.columns,)
    return ((j - 1 + row.odd) % row.around, (j + row.odd) % row.around)


def add_codend(net: NettingRecord, codend: Profile, ring: list[int], made: Weave) -> None:
    """Add the codend, one line whose first node is tied to all nodes of the last row."""
    m = net.codend_segments
    step = codend.length / m
    tail = made.positions[ring[0]][0]
    previous: list[int] = ring
    for k in range(m):
        made.positions.append((tail - (k + 1) * step, 0.0, 0.0))
        node = len(made.positions) - 1
        sums = codend.per_mesh_column(k * step, (k + 1) * step, 1)
        # Two bars make a mesh: all bars of the cross-section lie in the line.
        sums = {key: 2 * value for key, value in sums.items()}
        knots = sums['knots'] * net.knot_diameters**2 * net.knot_drag
        area, viscous_area = codend.line_drag(k * step, (k + 1) * step)
        made.line_drag[node] += area + knots
        made.line_viscous[node] += viscous_area
        made.knot_root[node] += sums['knot_root'] * net.knot_diameters**1.5
        share = {key: value / len(previous) for key, value in sums.items()}
        for start in previous:
            made.bars.append(_bar(start, node, step, share, 0.0, 'codend'))
        previous = [node]
