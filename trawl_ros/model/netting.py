"""Grouping of the netting: a tube of numerical diamond meshes that stand for the real ones.

A numerical row is as long as makes ``around`` numerical meshes as wide as the real ones are
together: rest length = stretched circumference / (2 around). Then a numerical mesh has the
same angle as the real ones, and ``real meshes around / around`` real bars lie side by side in
each numerical bar: twine length, area, volume, stiffness and knots are kept, row by row.

Nodes of even rows lie at multiples of the angular pitch from the top, those of odd rows half
a pitch further, so the net is its own mirror image and has a node at the headrope's centre.
The codend is one line: its meshes are too small for rows, and their drag is put on its nodes.
"""

from dataclasses import dataclass, field

import numpy as np

from trawl_ros.gear.records import NettingRecord, SectionRecord

SLICES = 64
"""Slices along a row over which the sections' properties are summed."""


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
    group: str


@dataclass
class NetMesh:
    """Nodes and bars of the net.

    ``positions`` (n, 3) is a first guess, x forward from the wing tips, y to port, z up;
    ``bars`` its netting; ``knot_area`` (m²) and ``knot_volume`` (m³) per node;
    ``line_drag_area`` C_D S (m²) of the codend's nodes; ``headrope`` and ``footrope`` the
    nodes from port to starboard wing tip, with their ropes' rest lengths as shares of the
    bosom and the wing edges; ``wing_end`` the pairs of nodes joined by the wing-end lines;
    ``kite`` the two nodes that carry it.
    """

    positions: np.ndarray
    bars: list[NetBar]
    knot_area: np.ndarray
    knot_volume: np.ndarray
    line_drag_area: np.ndarray
    headrope: list[int]
    footrope: list[int]
    edge_rest: float
    wing_ends: list[list[int]]
    kite: tuple[int, int]
    twine_area: float = 0.0
    rows: int = field(default=0)


class _Profile:
    """Real netting as functions of the stretched distance from the mouth."""

    def __init__(self, sections: tuple[SectionRecord, ...]) -> None:
        self.sections = sections
        self.edges = np.cumsum([0.0, *(s.length_m for s in sections)])

    @property
    def length(self) -> float:
        return float(self.edges[-1])

    def at(self, x: float) -> tuple[SectionRecord, float]:
        """Section at ``x`` and its stretched circumference there."""
        k = int(
            np.clip(np.searchsorted(self.edges, x, side='right') - 1, 0, len(self.sections) - 1)
        )
        s = self.sections[k]
        share = (x - self.edges[k]) / s.length_m
        return s, s.front_circumference_m + share * (
            s.back_circumference_m - s.front_circumference_m
        )

    def per_mesh_column(self, front: float, back: float, around: int) -> dict[str, float]:
        """Sums over [front, back] for one of ``around`` columns of bars, per bar."""
        total = dict.fromkeys(('area', 'volume', 'mass', 'stiffness', 'knots', 'knot_volume'), 0.0)
        dx = (back - front) / SLICES
        for x in front + (np.arange(SLICES) + 0.5) * dx:
            section, circumference = self.at(float(x))
            parallel = circumference / section.mesh_m / around
            d = section.twine_diameter_m
            twine = np.pi / 4 * d**2
            total['area'] += parallel * d * dx
            total['volume'] += parallel * twine * dx
            total['mass'] += parallel * twine * section.twine_density_kg_m3 * dx
            total['stiffness'] += parallel * twine * section.twine_modulus_pa * dx
            # Two knots per mesh and mesh length, shared by the two bars of a column.
            knots = parallel / (section.mesh_m / 2) * dx / 2
            total['knots'] += knots * np.pi / 4 * d**2
            total['knot_volume'] += knots * np.pi / 6 * d**3
        return total


def _row_lengths(profile: _Profile, around: int) -> np.ndarray:
    """Rest lengths of the rows, in proportion to the circumference, filling the body."""
    lengths = []
    x = 0.0
    while x < profile.length:
        _, circumference = profile.at(x)
        # The circumference shrinks along the row: use the one at its middle.
        _, middle = profile.at(min(x + circumference / (4 * around), profile.length))
        lengths.append(middle / (2 * around))
        x += lengths[-1]
    rows = np.array(lengths)
    if x - profile.length > 0.5 * rows[-1] and len(rows) > 1:
        rows = rows[:-1]
    return rows * profile.length / rows.sum()


def build_net(net: NettingRecord) -> NetMesh:
    """Group the netting of a gear into nodes and bars."""
    n = net.around
    body, codend = _Profile(net.body), _Profile(net.codend)
    rows = _row_lengths(body, n)
    wing_rows = n // 12
    pitch = 2 * np.pi / n
    index: dict[tuple[int, int], int] = {}
    positions: list[tuple[float, float, float]] = []

    def add(row: int, j: int, x: float, radius: float) -> None:
        phi = (j + 0.5 * (row % 2)) * pitch
        index[row, j] = len(positions)
        positions.append((x, radius * np.sin(phi), 0.6 * radius * np.cos(phi)))

    edges = np.concatenate([[0.0], np.cumsum(rows)])
    wing_length = wing_rows * rows[0]
    for row in range(-wing_rows, len(rows) + 1):
        x = row * rows[0] if row < 0 else edges[row]
        _, circumference = body.at(max(x, 0.0))
        radius = 0.4 * circumference / (2 * np.pi)
        for j in range(n):
            if row >= 0 or _in_wing(row, j, n, wing_rows):
                add(row, j, -0.85 * (x + wing_length), radius)
    bars: list[NetBar] = []
    knot_area = np.zeros(len(positions) + net.codend_segments)
    knot_volume = np.zeros_like(knot_area)
    for row in range(-wing_rows, len(rows)):
        front, back = (edges[row], edges[row + 1]) if row >= 0 else (0.0, rows[0])
        sums = body.per_mesh_column(front, back, n)
        for j in range(n):
            for step in (0, 1):
                other = (j - 1 + (row % 2) + step) % n
                if (row, j) in index and (row + 1, other) in index:
                    a, b = index[row, j], index[row + 1, other]
                    bars.append(_bar(a, b, back - front, sums, 'netting'))
                    knot_area[[a, b]] += 0.5 * sums['knots'] * net.knot_diameters**2
                    knot_volume[[a, b]] += 0.5 * sums['knot_volume'] * net.knot_diameters**3
    line_drag = np.zeros(len(positions) + net.codend_segments)
    _add_codend(net, codend, index, len(rows), positions, bars, line_drag)
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
        edge_rest=rows[0],
        wing_ends=_wing_ends(index, n, wing_rows),
        kite=(index[0, 0], index[2 * wing_rows, 0]),
        twine_area=sum(bar.area * bar.rest for bar in bars),
        rows=len(rows),
    )


def _bar(a: int, b: int, rest: float, sums: dict[str, float], group: str) -> NetBar:
    return NetBar(
        a,
        b,
        rest,
        sums['stiffness'] / rest,
        sums['area'] / rest,
        sums['volume'] / rest,
        sums['mass'] / rest,
        group,
    )


def _angle_index(row: int, j: int) -> int:
    """Angle from the top in half pitches, so that it is whole on every row."""
    return 2 * j + row % 2


def _in_wing(row: int, j: int, n: int, wing_rows: int) -> bool:
    """Whether a node ahead of the mouth belongs to a wing: all bars cut, so that each row is
    narrower by half a pitch at either edge; the base spans 30° about the side, in 12ths.
    """
    half = _angle_index(row, j) % (2 * n)
    reach = 2 * wing_rows + row
    return min(abs(half - n // 2), abs(half - 3 * n // 2)) <= reach


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
    codend: _Profile,
    index: dict[tuple[int, int], int],
    last_row: int,
    positions: list[tuple[float, float, float]],
    bars: list[NetBar],
    line_drag: np.ndarray,
) -> None:
    """One line behind the body; the last ring is gathered on its first node."""
    n, m = net.around, net.codend_segments
    step = codend.length / m
    ring = [index[last_row, j] for j in range(n)]
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
            bars.append(_bar(start, node, step, share, 'codend'))
        previous = [node]
