# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Grouping of the netting: a tube of numerical diamond meshes, each of which stands for many.

The length of a row makes ``around`` numerical meshes as wide as all real meshes together: rest
length = stretched circumference / (2 around). Then numerical and real meshes have the same angle,
and each numerical bar stands for ``real meshes around / around`` real bars side by side. Twine
length, area, volume, stiffness and knots are conserved row by row.

Toward the codend rows become short without any gain in accuracy. Where the gear file says so, two
numerical meshes are joined to one of twice the length. Every second line of bars ends there; the
lines from the corners of the wings, which carry high loads, continue.

Nodes of even rows lie at multiples of the angular pitch from the top, those of odd rows half
a pitch further. So the net is its own mirror image and has a node at the headrope's centre.
The codend is one line: its meshes are too small for rows, and their drag is lumped at its nodes.
"""

from functools import lru_cache

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.gear.net_plan import NetPlanRecord
from trawl_ros.gear.netting import NettingRecord
from trawl_ros.model.net.kite_nodes import NO_KITE, KiteNodes
from trawl_ros.model.net.planned_cloth import PlannedCloth, sections_of
from trawl_ros.model.net.planned_mouth import Place, PlannedMouth
from trawl_ros.model.net.rows import NettingRow, Profile, rows_of
from trawl_ros.model.net.weave import NetMesh, add_codend, weave

CACHED_NETS = 4
"""Number of nets kept; gears that differ only in their rigging share one."""


@lru_cache(CACHED_NETS)
def build_net(net: NettingRecord, kite_chord: float | None) -> NetMesh:
    """Group the netting of a gear into nodes and bars.

    Parameters
    ----------
    net
        Sections with wings of the usual cut, or a plan.
    kite_chord
        See `KiteRecord`; None without a kite.

    Raises
    ------
    GearError
        If the net cannot be cut as the file says.
    """
    if net.plan is not None:
        return _planned_net(net, net.plan, kite_chord)
    n = net.around
    body = Profile(net.body, net)
    wing_rows = n // 12
    rows = rows_of(body, n, net.halved_at_circumference_m, n // 2 - 2 * wing_rows)
    wing_row = net.body[0].front_circumference_m / (2 * n)
    wings = [
        NettingRow(k * wing_row, (k + 1) * wing_row, n, k % 2 == 1, False)
        for k in range(-wing_rows, 0)
    ]

    columns = {
        k: body.per_mesh_column(row.front, row.back, row.columns)
        for k, row in enumerate([*wings, *rows], -wing_rows)
    }

    # Half of the column of a bar on a wing's edge is cut away.
    halves = {k: {key: 0.5 * value for key, value in own.items()} for k, own in columns.items()}

    def sums(k: int, row: NettingRow, j: int, other: int) -> dict[str, float]:
        return (halves if _on_edge(k, j, other, n, wing_rows) else columns)[k]

    made = weave(net, body, wings, rows, lambda k, j: _in_wing(k, j, n, wing_rows), sums)
    index, last = made.index, rows[-1]
    ring = [index[len(rows), j] for j in range(last.columns)]
    add_codend(net, Profile(net.codend, net, closed=True), ring, made)
    top, bottom = 0, n // 2
    rim_top = _rim(index, n, wing_rows, top)
    rim_bottom = _rim(index, n, wing_rows, bottom)
    return NetMesh(
        positions=np.array(made.positions),
        bars=made.bars,
        knot_area=made.knot_area,
        knot_root=made.knot_root,
        knot_volume=made.knot_volume,
        line_drag_area=made.line_drag,
        line_viscous_area=made.line_viscous,
        headrope=rim_top,
        footrope=rim_bottom,
        edge_rest=wing_row,
        wing_ends=_wing_ends(index, n, wing_rows),
        kite=NO_KITE if kite_chord is None else _kite_nodes(rows, index, kite_chord),
        tips=(rim_top[0], rim_bottom[0], rim_top[-1], rim_bottom[-1]),
        knot_density=net.body[0].twine_density_kg_m3,
    )


def _planned_net(net: NettingRecord, plan: NetPlanRecord, kite_chord: float | None) -> NetMesh:
    """Group the netting of a plan; see `PlannedMouth` and `PlannedCloth`.

    Square meshes keep their width, so the net is one line from their first section on.
    """
    mouth = PlannedMouth(plan, net.around)
    cloth = PlannedCloth(net, mouth)
    sections = cloth.bodies['upper'].sections
    drawn = next((n for n, section in enumerate(sections) if section.square), len(sections))
    body = Profile(sections[:drawn], net)
    halved = net.halved_at_circumference_m or (plan.circumference / 2, plan.circumference / 4)
    rows = rows_of(body, net.around, halved, mouth.corner)
    wings = [
        NettingRow(k * mouth.row, (k + 1) * mouth.row, net.around, k % 2 == 1, False)
        for k in range(-mouth.foremost, 0)
    ]

    def sums(k: int, row: NettingRow, j: int, other: int) -> dict[str, float]:
        front = (2 * j + row.odd) / (2 * row.around)
        # The back edge has half as many nodes where meshes are joined.
        odd = not (row.odd or row.joins or row.straight)
        back = (2 * other + odd) / (2 * row.columns)
        return cloth.sums(row, front + 0.5 * ((back - front + 0.5) % 1.0 - 0.5))

    def rest(k: int, row: NettingRow, j: int) -> float:
        return row.rest if k >= 0 else mouth.row_at(2 * j + k % 2)

    made = weave(net, body, wings, rows, lambda k, j: mouth.holds(k, 2 * j + k % 2), sums, rest)
    last, codend = rows[-1], sections_of(net, plan, 'codend', 'upper')
    ring = [made.index[len(rows), j] for j in range(last.columns)]
    line = *sections[drawn:], *codend.sections
    add_codend(net, Profile(line, net, closed=True), ring, made)

    def nodes(places: tuple[Place, ...], *, mirrored: bool = False) -> list[int]:
        around = 2 * net.around
        halves = [(k, -half % around if mirrored else half) for k, half in places]
        return [made.index[k, (half - k % 2) // 2] for k, half in halves]

    frame = mouth.headrope(), mouth.footrope(), mouth.side_rope()
    headrope, footrope = (nodes(rope.places) for rope in frame[:2])
    kite = NO_KITE
    if kite_chord is not None:
        kite = _kite_nodes(rows, made.index, kite_chord)
        if headrope[len(headrope) // 2] != kite.nodes[0]:
            raise GearError(
                'kite: found with an upper panel that reaches ahead of the mouth, expected a panel '
                'that ends at the mouth, or no kite'
            )
    return NetMesh(
        positions=np.array(made.positions),
        bars=made.bars,
        knot_area=made.knot_area,
        knot_root=made.knot_root,
        knot_volume=made.knot_volume,
        line_drag_area=made.line_drag,
        line_viscous_area=made.line_viscous,
        headrope=headrope,
        footrope=footrope,
        edge_rest=mouth.row,
        wing_ends=[nodes(frame[2].places, mirrored=side) for side in (False, True)],
        kite=kite,
        tips=(
            *nodes(mouth.tips),
            *nodes(mouth.tips, mirrored=True),
        ),
        knot_density=body.sections[0].twine_density_kg_m3,
        frame=frame,
    )


def _kite_nodes(
    rows: tuple[NettingRow, ...], index: dict[tuple[int, int], int], chord: float
) -> KiteNodes:
    """Return the headrope's centre and a point ``chord`` (m, stretched) behind it.

    The latter lies between two nodes along the top.
    """
    top = [k for k, row in enumerate(rows) if not row.odd]
    places = np.array([rows[k].front for k in top])
    behind = int(np.clip(np.searchsorted(places, chord), 1, len(top) - 1))
    a, b = places[behind - 1], places[behind]
    share = (chord - a) / (b - a)
    nodes = [index[0, 0], index[top[behind - 1], 0], index[top[behind], 0]]
    return KiteNodes(np.array(nodes), np.array([[1.0, 0.0, 0.0], [0.0, 1.0 - share, share]]))


def _angle_index(row: int, j: int) -> int:
    """Return the angle from the top in half pitches, which is an integer on every row."""
    return 2 * j + row % 2


def _in_wing(row: int, j: int, n: int, wing_rows: int) -> bool:
    """Return True for a node ahead of the mouth that belongs to a wing.

    Wings are cut along the bars, so each row is narrower by half a pitch at either edge. The base
    spans 30° about the side, a twelfth of the circumference.
    """
    half = _angle_index(row, j) % (2 * n)
    reach = 2 * wing_rows + row
    return min(abs(half - n // 2), abs(half - 3 * n // 2)) <= reach


def _on_edge(row: int, j: int, other: int, n: int, wing_rows: int) -> bool:
    """Return True if the bar from (row, j) to (row + 1, other) lies on the cut edge of a wing."""
    if row >= 0:
        return False
    half, next_half = _angle_index(row, j) % (2 * n), _angle_index(row + 1, other) % (2 * n)
    return (
        min(abs(half - n // 2), abs(half - 3 * n // 2)) == 2 * wing_rows + row
        and min(abs(next_half - n // 2), abs(next_half - 3 * n // 2)) == 2 * wing_rows + row + 1
    )


def _rim(index: dict[tuple[int, int], int], n: int, wing_rows: int, middle: int) -> list[int]:
    """Return the nodes of headrope or footrope, from port over ``middle`` to starboard."""
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
    """Return the nodes of both wing ends, from the top down, port first."""
    row = -wing_rows
    ends = []
    for side in (n // 2, 3 * n // 2):
        halves = range(side - wing_rows, side + wing_rows + 1, 2)
        nodes = [index[row, (half - row % 2) // 2] for half in halves]
        ends.append(nodes if side == n // 2 else nodes[::-1])
    return ends
