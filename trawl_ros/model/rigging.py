# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parts of a gear as nodes and bars: warps, bridles, net, and the lumps at nodes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.gear.records import GearRecord
from trawl_ros.gear.rigging import ENDS, HungRecord, RopeRecord
from trawl_ros.model.hooks import NodeForce
from trawl_ros.model.kite import LiftingBodies
from trawl_ros.model.net.catch import CodendCatch, place_catch
from trawl_ros.model.net.wake import viscous, viscous_knots
from trawl_ros.model.net.weave import NetMesh
from trawl_ros.model.water import Water

HUNG_PIECES = 200
"""Number of pieces of a body spread along a rope, each of which goes to the nearest nodes."""


class GearBuilder:
    """Builder of nodes and bars; fastening points and blocks are renumbered at the end.

    The number of nodes is known only then. Until then fastening points count down from
    ``FASTENING`` and towing blocks from ``BLOCK``.
    """

    FASTENING = -100
    BLOCK = -200

    def __init__(self) -> None:
        self.count = 0
        self.ends: list[tuple[int, int]] = []
        self.rows: list[tuple[float, ...]] = []
        self.rest: list[float] = []
        self.side: list[int] = []
        self.lines: list[tuple[str, list[int], list[int]]] = []

    def nodes(self, number: int) -> IntArray:
        """Add nodes and return their numbers."""
        first = self.count
        self.count += number
        return np.arange(first, self.count)

    def bar(self, a: int, b: int, rest: float, row: tuple[float, ...], side: int = -1) -> int:
        """Add a bar and return its number."""
        self.ends.append((a, b))
        self.rows.append(row)
        self.rest.append(rest)
        self.side.append(side)
        return len(self.ends) - 1

    def rope(
        self,
        name: str,
        points: list[int],
        rests: list[float],
        row: tuple[float, ...],
        side: int = -1,
    ) -> list[int]:
        """Add the bars of a rope over points and return their numbers."""
        bars = []
        for a, b, rest in zip(points, points[1:], rests, strict=False):
            # A bar at a board must start there: the assembly relies on it.
            flip = self.BLOCK < b <= self.FASTENING
            bars.append(self.bar(b if flip else a, a if flip else b, rest, row, side))
        self.lines.append((name, points, bars))
        return bars

    def resolved(self, numbers: Sequence[int] | Sequence[tuple[int, int]]) -> IntArray:
        """Return the final numbers of points."""
        points = np.array(numbers)
        fastening = self.count + (self.FASTENING - points)
        block = self.count + 6 + (self.BLOCK - points)
        rigged = np.where(points <= self.BLOCK, block, fastening)
        return np.where(points <= self.FASTENING, rigged, points)


def rope_row(rope: RopeRecord, water: Water) -> tuple[float, ...]:
    """Return the properties of a rope per metre, in the order of `BarProperties`."""
    volume = np.pi / 4 * rope.diameter_m**2
    mass = rope.weight_in_water_n_m / water.gravity + water.density * volume
    return (
        rope.stiffness_n,
        rope.damping_time_s,
        mass,
        volume,
        rope.diameter_m,
        np.pi * rope.diameter_m,
        rope.normal_drag,
        rope.tangential_drag,
        rope.added_mass_normal,
        rope.added_mass_tangential,
        0.0,
        0.0,
        0.0,
    )


def add_warps(
    build: GearBuilder, gear: GearRecord, water: Water
) -> tuple[tuple[IntArray, IntArray], list[int]]:
    """Add both warps, from block to board; return their nodes and the numbers of their top bars."""
    row, segments = rope_row(gear.warp, water), gear.warp.segments
    lines, top_bars = [], []
    for side, name in enumerate(('port_warp', 'starboard_warp')):
        line = build.nodes(segments - 1)
        lines.append(line)
        points = [build.BLOCK - side, *line, build.FASTENING - 3 * side]
        top_bars.append(build.rope(name, points, [1.0] * segments, row, side)[0])
    return (lines[0], lines[1]), top_bars


def bridle_ends_of(gear: GearRecord, mesh: NetMesh) -> list[int]:
    """Return the nodes of the net at which the bridles end, port first."""
    ends = []
    for side in (0, 1):
        upper, lower = mesh.tips[2 * side : 2 * side + 2]
        rope = mesh.wing_ends[side]
        at = {'upper': upper, 'side': rope[len(rope) // 2], 'lower': lower}
        ends += [at[own.at_net] for own in gear.bridles]
    return ends


def rigging_nodes(gear: GearRecord) -> int:
    """Return the number of nodes between a board and the net."""
    bridles = sum(gear.bridle_of(own).segments - 1 for own in gear.bridles)
    return bridles if gear.sweep is None else bridles + gear.bridle_of(gear.sweep).segments + 1


def add_sweeps(build: GearBuilder, gear: GearRecord, water: Water) -> list[IntArray]:
    """Add sweeps and their backstrops, port first; none if the bridles end at the boards."""
    sweep = gear.sweep
    if sweep is None:
        return []
    record, lines = gear.bridle_of(sweep), []
    row = rope_row(record, water)
    for side, name in enumerate(('port', 'starboard')):
        line = build.nodes(record.segments + 1)
        lines.append(line)
        lengths = sweep.upper_backstrop_m, sweep.lower_backstrop_m
        for point, (end, length) in enumerate(zip(ENDS, lengths, strict=True), 1):
            fastening = build.FASTENING - (3 * side + point)
            build.rope(f'{name}_{end}_backstrop', [fastening, int(line[0])], [length], row)
        rests = [record.length_m / record.segments] * record.segments
        build.rope(f'{name}_sweep', line.tolist(), rests, row)
    return lines


def add_bridles(
    build: GearBuilder,
    gear: GearRecord,
    water: Water,
    ends: list[int],
    sweeps: list[IntArray],
) -> list[IntArray]:
    """Add all bridles from the boards or sweeps to their ``ends``, port first."""
    nodes, points = [], {'upper': 1, 'lower': 2}
    for number, end in enumerate(ends):
        side, which = divmod(number, len(gear.bridles))
        own = gear.bridles[which]
        record = gear.bridle_of(own)
        line = build.nodes(record.segments - 1)
        nodes.append(line)
        if sweeps:
            start = int(sweeps[side][-1])
        else:
            assert own.at_board is not None
            start = build.FASTENING - (3 * side + points[own.at_board])
        rests = [record.length_m / record.segments] * record.segments
        name = f'{("port", "starboard")[side]}_{own.name}_bridle'
        build.rope(name, [start, *line, end], rests, rope_row(record, water))
    return nodes


def add_net(
    build: GearBuilder, gear: GearRecord, water: Water, mesh: NetMesh, net: IntArray
) -> None:
    """Add the bars of the netting and the ropes of its frame to the nodes ``net``."""
    record, nodes = gear.netting, net.tolist()
    added = (record.added_mass_normal, 0.0)
    for bar in mesh.bars:
        # The drag of the codend is lumped at its nodes; its bars have volume and stiffness only.
        area = 0.0 if bar.group == 'codend' else bar.area
        row = (bar.stiffness, record.damping_time_s, bar.mass, bar.volume, area, np.pi * area)
        drag = (record.normal_drag * bar.normal, record.friction * bar.sliding)
        growth = viscous(record, bar.diameter)
        build.bar(
            nodes[bar.start], nodes[bar.end], bar.rest, (*row, *drag, *added, bar.bow, *growth)
        )
    rests_of, sides = _frame_rests(gear, mesh), mesh.wing_ends
    for name, rope, rim, rests in (
        ('headrope', gear.headrope, mesh.headrope, rests_of[0]),
        ('footrope', gear.footrope, mesh.footrope, rests_of[1]),
        ('port_wing_end', gear.side_rope or gear.headrope, sides[0], rests_of[2]),
        ('starboard_wing_end', gear.side_rope or gear.headrope, sides[1], rests_of[2]),
    ):
        build.rope(name, [nodes[k] for k in rim], rests, rope_row(rope, water))


def _frame_rests(gear: GearRecord, mesh: NetMesh) -> tuple[list[float], list[float], list[float]]:
    """Return the rest lengths along headrope, footrope, and the rope between the wing tips."""
    record, plan = gear.netting, gear.netting.plan
    if plan is not None and mesh.frame is not None:
        names = ('headrope', 'footrope', 'side_rope')
        lengths = (rope and rope.length_m for rope in (getattr(gear, name) for name in names))
        headrope, footrope, side = (
            rim.rests(plan, length, name).tolist()
            for rim, length, name in zip(mesh.frame, lengths, names, strict=True)
        )
        return headrope, footrope, side
    assert record.wing_edge_hanging is not None
    assert record.wing_end_m is not None
    wing_rows, bars = record.around // 12, len(mesh.wing_ends[0]) - 1
    edge = record.wing_edge_hanging * mesh.edge_rest
    rests = []
    for rope, rim in ((gear.headrope, mesh.headrope), (gear.footrope, mesh.footrope)):
        # Wing edges have their hung length; the bosom has the remainder of the rope.
        assert rope.length_m is not None
        inner = len(rim) - 1 - 2 * wing_rows
        bosom = (rope.length_m - 2 * wing_rows * edge) / inner
        rests.append([edge] * wing_rows + [bosom] * inner + [edge] * wing_rows)
    return rests[0], rests[1], [record.wing_end_m / bars] * bars


def ropes_of(item: HungRecord) -> list[str]:
    """Return the names of the lines on which a body hangs."""
    if item.rope == 'side_rope':
        return ['port_wing_end', 'starboard_wing_end']
    if item.rope.endswith('_bridle') or item.rope == 'sweep':
        return [f'{side}_{item.rope}' for side in ('port', 'starboard')]
    return [item.rope]


def hung_places(build: GearBuilder, item: HungRecord) -> list[tuple[IntArray, FloatArray, float]]:
    """Return the nodes that carry a body on ropes, its share on each, and its weight in water (N).

    The list has one entry per rope.
    """
    found = []
    for name in ropes_of(item):
        points, bars = next((p, b) for line, p, b in build.lines if line == name)
        along = np.concatenate([[0.0], np.cumsum([build.rest[bar] for bar in bars])])
        force = item.force_on(float(along[-1]))
        along /= along[-1]
        free = np.array([build.BLOCK < point <= build.FASTENING for point in points])
        # Boards and blocks carry nothing; their neighbours on the rope carry it instead.
        nodes, along = np.array(points)[~free], along[~free]
        places = np.linspace(item.from_share, item.to_share, HUNG_PIECES)
        shares = np.zeros(len(nodes))
        for place in places:
            k = int(np.clip(np.searchsorted(along, place) - 1, 0, len(along) - 2))
            part = float(np.clip((place - along[k]) / (along[k + 1] - along[k]), 0.0, 1.0))
            shares[[k, k + 1]] += np.array([1.0 - part, part]) / HUNG_PIECES
        found.append((nodes, shares, force))
    return found


@dataclass(frozen=True)
class Lumps:
    """Lumps at ``n`` nodes.

    Attributes
    ----------
    columns : (4, n) array
        Mass (kg), volume (m³), drag area C_D S (m²), and added mass (kg per kg/m³ of water).
    viscous_area : (n,) array
        Viscous part of the drag area, m² √(m/s).
    floats : (4, n) array
        Part of ``columns`` that belongs to floats.
    lifting
        Lift of bodies on ropes.
    catch
        Catch in the codend.
    """

    columns: FloatArray
    viscous_area: FloatArray
    floats: FloatArray
    lifting: tuple[NodeForce, ...]
    catch: CodendCatch | None


def lumps_of(
    build: GearBuilder, gear: GearRecord, water: Water, mesh: NetMesh, net: IntArray
) -> Lumps:
    """Return knots, catch, clumps, floats and the bodies on ropes as lumps at the nodes."""
    record = gear.netting
    columns, floats = np.zeros((2, 4, build.count))
    columns[1, net] += mesh.knot_volume
    columns[2, net] += mesh.knot_area * record.knot_drag + mesh.line_drag_area
    columns[3, net] += mesh.knot_volume * record.knot_added_mass
    viscous_area = np.zeros(build.count)
    viscous_area[net] = mesh.line_viscous_area + viscous_knots(record, 1.0) * mesh.knot_root
    catch = None if gear.catch is None else place_catch(gear.catch, record, mesh)
    if gear.catch is not None and catch is not None:
        # The full part of the codend has the drag of the catch instead of its own.
        columns[2, net] *= 1.0 - catch.covered
        viscous_area[net] *= 1.0 - catch.covered
        columns[:, net] += catch.lumps(gear.catch, water.density)
    # Knots are made of the twine they join: their mass is the first body section's density.
    columns[0, net] += mesh.knot_volume * mesh.knot_density
    clump, own = gear.clump, gear.floats
    for rim, into, force, density, drag_area in (
        (mesh.footrope, columns, clump.weight_in_water_n, clump.density_kg_m3, clump.drag_area_m2),
        (mesh.headrope, floats, -own.buoyancy_n, own.density_kg_m3, own.drag_area_m2),
    ):
        body = _body(force, density, drag_area, water)
        for tip in (net[rim[0]], net[rim[-1]]):
            into[:, tip] += body
    lifting = []
    for item in gear.hung:
        for nodes, shares, force in hung_places(build, item):
            if item.lift_area_m2:
                on = nodes[shares > 0.0]
                lifting.append(LiftingBodies(on, item.lift_area_m2 * shares[shares > 0.0], water))
            body = _body(force, item.density, item.drag_area_m2, water)
            # Indices do not repeat, so += adds each share: a rope passes each node once.
            (floats if force < 0.0 else columns)[:, nodes] += body[:, None] * shares
    return Lumps(columns + floats, viscous_area, floats, tuple(lifting), catch)


def _body(force: float, density: float, drag_area: float, water: Water) -> FloatArray:
    """Return the lump (4,) of a body with this weight in water (N) and density (kg/m³)."""
    volume = force / water.gravity / (density - water.density)
    # The added mass of a sphere is that of half its volume of water.
    return np.array([density * volume, volume, drag_area, 0.5 * volume])
