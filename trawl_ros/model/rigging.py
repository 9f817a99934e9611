"""Rigging of a gear as nodes and bars: ropes, bridles, and what hangs on them."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.gear.records import GearRecord
from trawl_ros.gear.rigging import ENDS, HungRecord
from trawl_ros.gear.ropes import RopeRecord
from trawl_ros.model.net.weave import NetMesh
from trawl_ros.model.water import Water

HUNG_PIECES = 200
"""Pieces into which what is spread along a rope is divided among its nodes."""


class GearBuilder:
    """Builder of nodes and bars; fastening points and blocks are renumbered at the end."""

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
        """Numbers of new nodes."""
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
            # A bar at a board starts there: the assembly relies on it.
            flip = self.BLOCK < b <= self.FASTENING
            bars.append(self.bar(b if flip else a, a if flip else b, rest, row, side))
        self.lines.append((name, points, bars))
        return bars

    def resolved(self, numbers: Sequence[int] | Sequence[tuple[int, int]]) -> IntArray:
        """Final numbers of points."""
        points = np.array(numbers)
        fastening = self.count + (self.FASTENING - points)
        block = self.count + 6 + (self.BLOCK - points)
        rigged = np.where(points <= self.BLOCK, block, fastening)
        return np.where(points <= self.FASTENING, rigged, points)


def rope_row(rope: RopeRecord, water: Water) -> tuple[float, ...]:
    """Properties of a rope in the order of `BarProperties`, per metre."""
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


def bridle_ends_of(gear: GearRecord, mesh: NetMesh) -> list[int]:
    """Nodes of the net at which the bridles end, port's first."""
    ends = []
    for side in (0, 1):
        upper, lower = mesh.tips[2 * side : 2 * side + 2]
        rope = mesh.wing_ends[side]
        at = {'upper': upper, 'side': rope[len(rope) // 2], 'lower': lower}
        ends += [at[own.at_net] for own in gear.bridles]
    return ends


def rigging_nodes(gear: GearRecord) -> int:
    """Number of nodes between a board and the net."""
    bridles = sum(gear.bridle_of(own).segments - 1 for own in gear.bridles)
    return bridles if gear.sweep is None else bridles + gear.bridle_of(gear.sweep).segments + 1


def add_sweeps(build: GearBuilder, gear: GearRecord, water: Water) -> list[IntArray]:
    """Sweeps with the backstrops that hold them, port's first; none where bridles end at boards."""
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
    """All bridles from boards' points or sweeps to their ``ends``, port's first."""
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


def ropes_of(item: HungRecord) -> list[str]:
    """Names of the lines on which it hangs."""
    if item.rope == 'side_rope':
        return ['port_wing_end', 'starboard_wing_end']
    if item.rope.endswith('_bridle') or item.rope == 'sweep':
        return [f'{side}_{item.rope}' for side in ('port', 'starboard')]
    return [item.rope]


def hung_places(build: GearBuilder, item: HungRecord) -> list[tuple[IntArray, FloatArray, float]]:
    """Nodes that carry what hangs on a rope, the share of it on each, and its weight in water (N);
    one entry per rope.
    """
    found = []
    for name in ropes_of(item):
        points, bars = next((p, b) for line, p, b in build.lines if line == name)
        along = np.concatenate([[0.0], np.cumsum([build.rest[bar] for bar in bars])])
        force = item.force_on(float(along[-1]))
        along /= along[-1]
        free = np.array([build.BLOCK < point <= build.FASTENING for point in points])
        # Board and blocks carry nothing: what hangs beside them is their neighbour's.
        nodes, along = np.array(points)[~free], along[~free]
        places = np.linspace(item.from_share, item.to_share, HUNG_PIECES)
        shares = np.zeros(len(nodes))
        for place in places:
            k = int(np.clip(np.searchsorted(along, place) - 1, 0, len(along) - 2))
            part = float(np.clip((place - along[k]) / (along[k + 1] - along[k]), 0.0, 1.0))
            shares[[k, k + 1]] += np.array([1.0 - part, part]) / HUNG_PIECES
        found.append((nodes, shares, force))
    return found
