"""A gear as arrays: nodes, boards and the bars between them, in one numbering.

Points are numbered nodes first (free), then the boards' fastening points (warp, upper bridle,
lower bridle; port board, then starboard), then the two towing blocks. Degrees of freedom are
three per node, then six per board: translation and rotation vector, both in fixed axes.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.gear.polars import polar_of
from trawl_ros.gear.records import BridleRecord, FrameRopeRecord, GearRecord, RopeRecord
from trawl_ros.model.board import Board
from trawl_ros.model.board_table import TableLaw
from trawl_ros.model.hooks import NodeForce
from trawl_ros.model.kite import Kite, KiteNodes
from trawl_ros.model.line import BarProperties
from trawl_ros.model.netting import NetMesh, build_net
from trawl_ros.model.pattern import SparsityPattern, build_pattern
from trawl_ros.model.water import Water, build_water
from trawl_ros.records.coefficients import COEFFICIENTS

OUTWARD = np.array([1.0, -1.0])
"""Sign of y that points away from the net's middle: port, starboard."""


@dataclass(frozen=True)
class NodeLayout:
    """Node numbering: the nodes of warps, bridles, net, headrope, footrope and kite.

    ``warps`` and ``bridles`` are tuples of node arrays (warps from block to board, port and
    starboard; bridles from board to wing tip: port upper, port lower, starboard upper,
    starboard lower), ``net`` the net's nodes; ``lines`` (name, point numbers, bar numbers) of
    everything to be drawn.
    """

    warps: tuple[IntArray, IntArray]
    bridles: tuple[IntArray, ...]
    net: IntArray
    headrope: IntArray
    footrope: IntArray
    kite: KiteNodes
    top_warp_bars: IntArray
    lines: tuple[tuple[str, IntArray, IntArray], ...]


@dataclass(frozen=True)
class GearModel:
    """Everything the forces need, for ``n`` nodes and ``m`` bars.

    ``ends`` (m, 2) are point numbers; ``rest`` (m,) unstretched lengths; ``warp_side`` (m,) is
    0 or 1 for the bars of a warp, whose length is ``warp length / warp_segments``, else -1.
    Node lumps: ``lump_mass`` kg, ``lump_volume`` m³, ``lump_drag_area`` C_D S m², ``lump_added``
    kg per kg/m³ of water. ``node_forces`` are forces beyond the paper's.

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> model.ends.shape == (len(model.rest), 2), model.lump_mass.shape == (model.nodes,)
    (True, True)
    """

    gear: GearRecord
    water: Water
    board: Board
    kite: Kite
    coefficients: FloatArray
    bars: BarProperties
    ends: IntArray
    rest: FloatArray
    warp_side: IntArray
    lump_mass: FloatArray
    lump_volume: FloatArray
    lump_drag_area: FloatArray
    lump_added: FloatArray
    layout: NodeLayout
    first_guess: FloatArray
    net_mesh: NetMesh
    pattern: SparsityPattern
    node_forces: tuple[NodeForce, ...] = ()

    @property
    def nodes(self) -> int:
        """Number of free nodes."""
        return len(self.lump_mass)

    @property
    def dof(self) -> int:
        """Number of degrees of freedom."""
        return 3 * self.nodes + 12

    @property
    def warp_segments(self) -> int:
        """Bars per warp."""
        return self.gear.warp.segments

    @cached_property
    def warp_bars(self) -> tuple[IntArray, IntArray]:
        """Bars of the port and of the starboard warp."""
        return np.flatnonzero(self.warp_side == 0), np.flatnonzero(self.warp_side == 1)

    def with_coefficients(self, values: FloatArray) -> 'GearModel':
        """The same gear with other board coefficients, in the order of eq. 36."""
        return replace(self, coefficients=np.asarray(values))

    def with_board(self, **changes: object) -> 'GearModel':
        """The same gear with a changed board, such as its points or installation angles."""
        # Names and types are the caller's: `replace` refuses what a board has not.
        board = replace(self.board, **changes)  # type: ignore[arg-type]
        return replace(self, board=board)

    def with_net(self, drag: float, weight: float) -> 'GearModel':
        """The same gear with this many times the drag coefficients and the weight in water of all
        netting and ropes of the net.
        """
        net = np.isin(self.ends, self.layout.net).all(axis=1)
        bars, water = self.bars, self.water.density * self.bars.volume
        return replace(
            self,
            bars=replace(
                bars,
                normal_drag=np.where(net, drag, 1.0) * bars.normal_drag,
                friction=np.where(net, drag, 1.0) * bars.friction,
                mass=water + np.where(net, weight, 1.0) * (bars.mass - water),
            ),
        )


class _Builder:
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
        first = self.count
        self.count += number
        return np.arange(first, self.count)

    def bar(self, a: int, b: int, rest: float, row: tuple[float, ...], side: int = -1) -> int:
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
        bars = []
        for a, b, rest in zip(points, points[1:], rests, strict=False):
            # A bar at a board starts there: the assembly relies on it.
            flip = self.BLOCK < b <= self.FASTENING
            bars.append(self.bar(b if flip else a, a if flip else b, rest, row, side))
        self.lines.append((name, points, bars))
        return bars

    def resolve(self, number: int) -> int:
        """Final number of a point."""
        if number <= self.BLOCK:
            return self.count + 6 + (self.BLOCK - number)
        if number <= self.FASTENING:
            return self.count + (self.FASTENING - number)
        return number


def _rope_row(rope: RopeRecord, water: Water) -> tuple[float, ...]:
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
    )


def build_board(gear: GearRecord) -> Board:
    """The board of a gear file."""
    record = gear.board
    polar = polar_of(record)
    i = record.inertia
    inertia = np.array(
        [
            [i.xx_kg_m2, -i.xy_kg_m2, -i.xz_kg_m2],
            [-i.xy_kg_m2, i.yy_kg_m2, -i.yz_kg_m2],
            [-i.xz_kg_m2, -i.yz_kg_m2, i.zz_kg_m2],
        ]
    )
    angles = record.installation
    return Board(
        mass=record.mass_kg,
        volume=record.volume_m3,
        inertia=inertia,
        area=record.area_m2,
        span=record.span_m,
        chord=record.chord_m,
        points=np.array(
            [
                record.fastening.warp_m,
                record.fastening.upper_bridle_m,
                record.fastening.lower_bridle_m,
            ]
        ),
        installation=tuple(np.radians([angles.epsilon_deg, angles.zeta_deg, angles.eta_deg])),
        moment_signs=record.moment_signs,
        slip_sign=float(record.slip_sign),
        rotary_slope=record.rotary_slope,
        flow_axes=record.force_axes == 'flow',
        added_mass=np.array(record.added_mass_kg),
        law=None if polar is None else TableLaw(polar, record.moment_signs),
    )


def _frame_rests(rope: FrameRopeRecord, edge: float, wing_rows: int, bars: int) -> list[float]:
    """Rest lengths along head- or footrope: wing edges as hung, the rest on the bosom."""
    bosom = (rope.length_m - 2 * wing_rows * edge) / (bars - 2 * wing_rows)
    return [edge] * wing_rows + [bosom] * (bars - 2 * wing_rows) + [edge] * wing_rows


def _add_bridles(
    build: _Builder, record: BridleRecord, row: tuple[float, ...], tips: list[int]
) -> list[IntArray]:
    """Four bridles: port upper, port lower, starboard upper, starboard lower."""
    nodes = []
    names = (
        'port_upper_bridle',
        'port_lower_bridle',
        'starboard_upper_bridle',
        'starboard_lower_bridle',
    )
    for k, (name, tip) in enumerate(zip(names, tips, strict=True)):
        own = build.nodes(record.segments - 1)
        nodes.append(own)
        fastening = build.FASTENING - (3 * (k // 2) + 1 + k % 2)
        rests = [record.length_m / record.segments] * record.segments
        build.rope(name, [fastening, *own, tip], rests, row)
    return nodes


def build_model(gear: GearRecord) -> GearModel:
    """Turn a gear file's record into arrays.

    Parameters
    ----------
    gear
        From `load_gear`, perhaps cut finer or coarser with `GearRecord.refined`.

    Returns
    -------
    GearModel
        Without state: any number of tows may share it.

    Raises
    ------
    GearError
        If the net cannot be cut as the file says.

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> model.nodes, model.dof == 3 * model.nodes + 12
    (142, True)
    """
    water, board = build_water(gear), build_board(gear)
    mesh = build_net(gear.netting, gear.kite.chord_m)
    build = _Builder()
    warp_row = _rope_row(gear.warp, water)
    segments = gear.warp.segments
    warps, top_bars = [], []
    for side, name in enumerate(('port_warp', 'starboard_warp')):
        own = build.nodes(segments - 1)
        warps.append(own)
        points = [build.BLOCK - side, *own, build.FASTENING - 3 * side]
        top_bars.append(build.rope(name, points, [1.0] * segments, warp_row, side)[0])
    net_first = build.count + 4 * (gear.bridle.segments - 1)
    tips = [net_first + rope[end] for end in (0, -1) for rope in (mesh.headrope, mesh.footrope)]
    bridles = _add_bridles(build, gear.bridle, _rope_row(gear.bridle, water), tips)
    net = build.nodes(len(mesh.positions))

    record = gear.netting
    shared = (record.normal_drag, record.friction, record.added_mass_normal, 0.0)
    for bar in mesh.bars:
        # The codend's drag is on its nodes, its volume and stiffness in its bars.
        area = 0.0 if bar.group == 'codend' else bar.area
        row = (bar.stiffness, record.damping_time_s, bar.mass, bar.volume, area, np.pi * area)
        number = build.bar(net[bar.start], net[bar.end], bar.rest, (*row, *shared, bar.bow))
        build.lines.append((bar.group, [int(net[bar.start]), int(net[bar.end])], [number]))
    wing_rows = record.around // 12
    edge = record.wing_edge_hanging * mesh.edge_rest
    for name, rope, rim in (
        ('headrope', gear.headrope, mesh.headrope),
        ('footrope', gear.footrope, mesh.footrope),
    ):
        rests = _frame_rests(rope, edge, wing_rows, len(rim) - 1)
        build.rope(name, [int(net[k]) for k in rim], rests, _rope_row(rope, water))
    for name, end in zip(('port_wing_end', 'starboard_wing_end'), mesh.wing_ends, strict=True):
        rests = [record.wing_end_m / (len(end) - 1)] * (len(end) - 1)
        build.rope(name, [int(net[k]) for k in end], rests, _rope_row(gear.headrope, water))

    lumps = np.zeros((4, build.count))
    lumps[1, net] += mesh.knot_volume
    lumps[2, net] += mesh.knot_area * record.knot_drag + mesh.line_drag_area
    lumps[3, net] += mesh.knot_volume * record.knot_added_mass
    # Knots are made of the twine they join: their mass is the first body section's density.
    lumps[0, net] += mesh.knot_volume * record.body[0].twine_density_kg_m3
    clump, floats = gear.clump, gear.floats
    for rim, force, density, drag_area in (
        (mesh.footrope, clump.weight_in_water_n, clump.density_kg_m3, clump.drag_area_m2),
        (mesh.headrope, -floats.buoyancy_n, floats.density_kg_m3, floats.drag_area_m2),
    ):
        volume = force / water.gravity / (density - water.density)
        # A compact body: half its volume of added mass, as a sphere.
        for tip in (net[rim[0]], net[rim[-1]]):
            lumps[:, tip] += (density * volume, volume, drag_area, 0.5 * volume)
    guess = np.full((build.count, 3), np.nan)
    guess[net] = mesh.positions
    ends = np.array([[build.resolve(a), build.resolve(b)] for a, b in build.ends])
    kite = replace(mesh.kite, nodes=net[mesh.kite.nodes])
    return GearModel(
        gear=gear,
        water=water,
        board=board,
        kite=_build_kite(gear),
        coefficients=np.array([getattr(gear.board.coefficients, c) for c in COEFFICIENTS]),
        bars=BarProperties(*np.array(build.rows).T),
        ends=ends,
        rest=np.array(build.rest),
        warp_side=np.array(build.side),
        lump_mass=lumps[0],
        lump_volume=lumps[1],
        lump_drag_area=lumps[2],
        lump_added=lumps[3],
        layout=NodeLayout(
            warps=(warps[0], warps[1]),
            bridles=tuple(bridles),
            net=net,
            headrope=net[mesh.headrope],
            footrope=net[mesh.footrope],
            kite=kite,
            top_warp_bars=np.array(top_bars),
            lines=tuple(
                (name, np.array([build.resolve(p) for p in points]), np.array(bars))
                for name, points, bars in build.lines
            ),
        ),
        first_guess=guess,
        net_mesh=mesh,
        pattern=build_pattern(build.count, ends, kite.nodes),
    )


def _build_kite(gear: GearRecord) -> Kite:
    kite = gear.kite
    return Kite(
        area=kite.area_m2,
        mass=kite.mass_kg,
        volume=kite.volume_m3,
        setting=float(np.radians(kite.setting_deg)),
        lift=kite.lift_slope,
        drag_base=kite.drag_base,
        drag_growth=kite.drag_growth,
    )
