"""Grouping of the netting: a tube of numerical diamond meshes that stand for the real ones.

A numerical row is as long as makes ``around`` numerical meshes as wide as the real ones are
together: rest length = stretched circumference / (2 around). Then a numerical mesh has the
same angle as the real ones, and ``real meshes around / around`` real bars lie side by side in
each numerical bar: twine length, area, volume, stiffness and knots are kept, row by row.

Toward the codend rows get short, which would not make the answer better: where the gear file
says so, two numerical meshes are joined to one, which is twice as long.

Nodes of even rows lie at multiples of the angular pitch from the top, those of odd rows half
a pitch further, so the net is its own mirror image and has a node at the headrope's centre.
The codend is one line: its meshes are too small for rows, and their drag is put on its nodes.
"""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.records import NettingRecord
from trawl_ros.model.kite import KiteNodes
from trawl_ros.model.netting_rows import NettingRow, Profile, rows_of


@dataclass(frozen=True)
class NetBar:
    """A numerical bar between two net nodes, with the properties of `line.BarProperties`."""

    start: int
    end: int
    rest: float
    stiffness: float
    area: float
    volume: float
    mass: float
    bow: float
    group: str


@dataclass
class NetMesh:
    """Nodes and bars of the net.

    ``positions`` (n, 3) is a first guess, x forward from the wing tips, y to port, z up;
    ``bars`` its netting; ``knot_area`` (m²) and ``knot_volume`` (m³) per node;
    ``line_drag_area`` C_D S (m²) of the codend's nodes; ``headrope`` and ``footrope`` the
    nodes from port to starboard wing tip, with their ropes' rest lengths as shares of the
    bosom and the wing edges; ``wing_ends`` the nodes joined by the wing-end lines;
    ``kite`` what carries the kite.
    """

    positions: FloatArray
    bars: list[NetBar]
    knot_area: FloatArray
    knot_volume: FloatArray
    line_drag_area: FloatArray
    headrope: list[int]
    footrope: list[int]
    edge_rest: float
    wing_ends: list[list[int]]
    kite: KiteNodes


def build_net(net: NettingRecord, kite_chord: float) -> NetMesh:
    """Group the netting of a gear into nodes and bars; see `KiteRecord` for the kite's chord."""
    n = net.around
    body = Profile(net.body)
    rows = rows_of(body, n, net.halved_at_circumference_m)
    wing_rows = n // 12
    wing_row = net.body[0].front_circumference_m / (2 * n)
    wings = [
        NettingRow(k * wing_row, (k + 1) * wing_row, n, k % 2 == 1, False)
        for k in range(-wing_rows, 0)
    ]
    index: dict[tuple[int, int], int] = {}
    positions: list[tuple[float, float, float]] = []

    def add(edge: int, x: float, around: int, odd: bool) -> None:
        _, circumference = body.at(x)
        radius = 0.4 * circumference / (2 * np.pi)
        for j in range(around):
            if edge >= 0 or _in_wing(edge, j, n, wing_rows):
                phi = (j + 0.5 * odd) * 2 * np.pi / around
                index[edge, j] = len(positions)
                positions.append(
                    (
                        -0.85 * (x + wing_rows * wing_row),
                        radius * np.sin(phi),
                        0.6 * radius * np.cos(phi),
                    )
                )

    for k, row in enumerate([*wings, *rows], -wing_rows):
        add(k, row.front, row.around, row.odd)
    last = rows[-1]
    add(len(rows), last.back, last.columns, not last.joins and not last.odd)
    bars: list[NetBar] = []
    knot_area = np.zeros(len(positions) + net.codend_segments)
    knot_volume = np.zeros_like(knot_area)
    for k, row in enumerate([*wings, *rows], -wing_rows):
        sums = body.per_mesh_column(row.front, row.back, row.columns)
        for j in range(row.around):
            for other in _behind(row, j):
                if (k, j) not in index or (k + 1, other) not in index:
                    continue
                a, b = index[k, j], index[k + 1, other]
                # Half of the column of a bar on a wing's edge is cut away.
                share = 0.5 if _on_edge(k, j, other, n, wing_rows) else 1.0
                own = {key: share * value for key, value in sums.items()}
                bars.append(_bar(a, b, row.rest, own, net.bowing_pressure_pa, 'netting'))
                knot_area[[a, b]] += 0.5 * own['knots'] * net.knot_diameters**2
                knot_volume[[a, b]] += 0.5 * own['knot_volume'] * net.knot_diameters**3
    line_drag = np.zeros(len(positions) + net.codend_segments)
    ring = [index[len(rows), j] for j in range(last.columns)]
    codend = Profile((*body.behind(last.back), *net.codend))
    _add_codend(net, codend, ring, positions, bars, line_drag)
    top, bottom = 0, n // 2
    rim_top = _rim(index, n, wing_rows, top)
    rim_bottom = _rim(index, n, wing_rows, bottom)
    return NetMesh(
        positions=np.array(positions),
        bars=bars,
        knot_area=knot_area,
        knot_volume=knot_volume,
        line_drag_area=line_drag,
        headrope=rim_top,
        footrope=rim_bottom,
        edge_rest=wing_row,
        wing_ends=_wing_ends(index, n, wing_rows),
        kite=_kite_nodes(rows, index, kite_chord),
    )


def _kite_nodes(
    rows: tuple[NettingRow, ...], index: dict[tuple[int, int], int], chord: float
) -> KiteNodes:
    """The headrope's centre, and a point ``chord`` (m, stretched) behind it between the nodes
    that lie along the top.
    """
    top = [k for k, row in enumerate(rows) if not row.odd]
    places = np.array([rows[k].front for k in top])
    behind = int(np.clip(np.searchsorted(places, chord), 1, len(top) - 1))
    a, b = places[behind - 1], places[behind]
    share = (chord - a) / (b - a)
    nodes = [index[0, 0], index[top[behind - 1], 0], index[top[behind], 0]]
    return KiteNodes(np.array(nodes), np.array([[1.0, 0.0, 0.0], [0.0, 1.0 - share, share]]))


def _bar(
    a: int, b: int, rest: float, sums: dict[str, float], pressure: float, group: str
) -> NetBar:
    # Netting of hardly any circumference has no twine.
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
    )


def _behind(row: NettingRow, j: int) -> tuple[int, ...]:
    """Nodes of the back edge that the bars of node ``j`` of the front edge go to."""
    if row.joins:
        return (((j + 1) // 2) % row.columns,)
    return ((j - 1 + row.odd) % row.around, (j + row.odd) % row.around)


def _angle_index(row: int, j: int) -> int:
    """Angle from the top in half pitches, so that it is whole on every row."""
    return 2 * j + row % 2


def _in_wing(row: int, j: int, n: int, wing_rows: int) -> bool:
    """Return True for a node ahead of the mouth that belongs to a wing.

    All bars are cut, so each row is narrower by half a pitch at either edge; the base spans
    30° about the side, in 12ths.
    """
    half = _angle_index(row, j) % (2 * n)
    reach = 2 * wing_rows + row
    return min(abs(half - n // 2), abs(half - 3 * n // 2)) <= reach


def _on_edge(row: int, j: int, other: int, n: int, wing_rows: int) -> bool:
    """True if the bar from (row, j) to (row + 1, other) lies along the cut edge of a wing."""
    if row >= 0:
        return False
    half, next_half = _angle_index(row, j) % (2 * n), _angle_index(row + 1, other) % (2 * n)
    return (
        min(abs(half - n // 2), abs(half - 3 * n // 2)) == 2 * wing_rows + row
        and min(abs(next_half - n // 2), abs(next_half - 3 * n // 2)) == 2 * wing_rows + row + 1
    )


def _rim(index: dict[tuple[int, int], int], n: int, wing_rows: int, middle: int) -> list[int]:
    """Nodes of head- or footrope, from the port wing tip over ``middle`` to starboard."""
    toward = 1 if middle == 0 else -1
    base = n // 4 - wing_rows
    port: list[int] = []
    for row in range(-wing_rows, 0):
        half = n // 2 - toward * (2 * wing_rows + row)
        port.append(index[row, (half - row % 2) // 2])
    if middle == 0:
        bosom = [index[0, j % n] for j in range(base, -base - 1, -1)]
    else:
        bosom = [index[0, j] for j in range(n // 4 + wing_rows, n - n // 4 - wing_rows + 1)]
    starboard: list[int] = []
    for row in range(-1, -wing_rows - 1, -1):
        half = 3 * n // 2 + toward * (2 * wing_rows + row)
        starboard.append(index[row, (half - row % 2) // 2])
    return port + bosom + starboard


def _wing_ends(index: dict[tuple[int, int], int], n: int, wing_rows: int) -> list[list[int]]:
    """Nodes of both wing ends, from the top down, port first."""
    row = -wing_rows
    ends = []
    for side in (n // 2, 3 * n // 2):
        halves = range(side - wing_rows, side + wing_rows + 1, 2)
        nodes = [index[row, (half - row % 2) // 2] for half in halves]
        ends.append(nodes if side == n // 2 else nodes[::-1])
    return ends


def _add_codend(
    net: NettingRecord,
    codend: Profile,
    ring: list[int],
    positions: list[tuple[float, float, float]],
    bars: list[NetBar],
    line_drag: FloatArray,
) -> None:
    """One line behind the last whole row, whose nodes are all tied to its first node."""
    m = net.codend_segments
    step = codend.length / m
    tail = positions[ring[0]][0]
    mesh_angle = np.radians(net.codend_mesh_angle_deg)
    # Eq. 23 and 24 along the flow for a bar at the stated angle, as C_D S per twine area.
    per_area = (
        net.normal_drag * np.sin(mesh_angle) ** 3 + net.friction * np.pi * np.cos(mesh_angle) ** 3
    )
    previous: list[int] = ring
    for k in range(m):
        positions.append((tail - (k + 1) * step, 0.0, 0.0))
        node = len(positions) - 1
        sums = codend.per_mesh_column(k * step, (k + 1) * step, 1)
        # Two bars make a mesh: all bars of the cross-section lie in the line.
        sums = {key: 2 * value for key, value in sums.items()}
        knots = sums['knots'] * net.knot_diameters**2 * net.knot_drag
        line_drag[node] += sums['area'] * per_area + knots
        share = {key: value / len(previous) for key, value in sums.items()}
        for start in previous:
            bars.append(_bar(start, node, step, share, 0.0, 'codend'))
        previous = [node]
