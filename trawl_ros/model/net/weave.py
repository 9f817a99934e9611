"""Nodes and bars of a net, row by row: what any outline of the mouth and any netting share."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.netting import NettingRecord
from trawl_ros.model.net.kite_nodes import KiteNodes
from trawl_ros.model.net.planned_mouth import FrameRope
from trawl_ros.model.net.rows import NettingRow, Profile


@dataclass(frozen=True)
class NetBar:
    """A numerical bar between two net nodes, with the properties of `line.BarProperties`;
    ``normal`` and ``sliding`` are the parts of its area that single twines with as much drag have,
    across them and along, ``diameter`` (m) is that of its twine, and ``lift`` the κ of its sheet.
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

    ``positions`` (n, 3) is a first guess, x forward from the wing tips, y to port, z up; ``bars``
    its netting; ``knot_area`` (m²), ``knot_root`` (m^1.5, the area over the root of the diameter)
    and ``knot_volume`` (m³) per node; ``line_drag_area`` C_D S (m²) of the codend's nodes and
    ``line_viscous_area`` its viscous part (m² √(m/s)); ``headrope`` and ``footrope`` the nodes from
    port to starboard wing tip, ``edge_rest`` the length of a bar of a wing's edge; ``wing_ends``
    the nodes joined by the wing-end lines or side ropes, from the top down; ``kite`` what carries
    the kite; ``tips`` the nodes that bridles are shackled to: port upper and lower, starboard upper
    and lower; ``knot_density`` the density of knots (kg/m³); ``frame`` headrope, footrope and side
    rope of a planned net.
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
    """Net while it is made: the ``index`` of its nodes by row and number around, their
    ``positions``, its ``bars``, and per node the area (m²) and volume (m³) of its knots.
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
    """Make nodes and bars of the wings' rows and the body's.

    Parameters
    ----------
    net
        Constants of knots and bars.
    body
        Profile whose circumferences give the places.
    wings, rows
        Rows ahead of the mouth, which have negative numbers, and behind it.
    holds
        True for a node (row, number around) ahead of the mouth that belongs to the net.
    sums
        Twine of the bar of a row from one number around to another, as
        `Profile.per_mesh_column` has it.
    rest
        Length of the bars of a row from a number around; that of the row unless given.
    """
    made = Weave()
    ahead = wings[0].front if wings else 0.0

    def add(edge: int, x: float, around: int, odd: bool) -> None:
        _, circumference = body.at(x)
        radius = 0.4 * circumference / (2 * np.pi)
        for j in range(around):
            if edge >= 0 or holds(edge, j):
                phi = (j + 0.5 * odd) * 2 * np.pi / around
                made.index[edge, j] = len(made.positions)
                made.positions.append(
                    (
                        -0.85 * (x - ahead),
                        radius * np.sin(phi),
                        0.6 * radius * np.cos(phi),
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
    # Netting of hardly any circumference has no twine.
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
    """Nodes of the back edge that the bars of node ``j`` of the front edge go to."""
    if row.straight:
        return (j,)
    if row.joins:
        return (((j + 1) // 2) % row.columns,)
    return ((j - 1 + row.odd) % row.around, (j + row.odd) % row.around)


def add_codend(net: NettingRecord, codend: Profile, ring: list[int], made: Weave) -> None:
    """One line behind the last whole row, whose nodes are all tied to its first node."""
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
