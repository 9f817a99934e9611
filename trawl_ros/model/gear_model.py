"""A gear as arrays: nodes, boards and the bars between them, in one numbering.

Points are numbered nodes first (free), then the boards' fastening points (warp, upper bridle,
lower bridle; port board, then starboard), then the two towing blocks. Degrees of freedom are
three per node, then six per board: translation and rotation vector, both in fixed axes.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.gear.polars import polar_of
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.board import Board
from trawl_ros.model.board_table import TableLaw
from trawl_ros.model.hooks import CoefficientModifier, InTurn, NodeForce
from trawl_ros.model.kite import Kite, LiftingBodies
from trawl_ros.model.line import BarProperties
from trawl_ros.model.net.catch import CodendCatch, place_catch
from trawl_ros.model.net.kite_nodes import KiteNodes
from trawl_ros.model.net.netting import build_net
from trawl_ros.model.net.sheets import NetSheets, sheets_of
from trawl_ros.model.net.wake import viscous, viscous_knots
from trawl_ros.model.net.weave import NetMesh
from trawl_ros.model.pattern import SparsityPattern, build_pattern
from trawl_ros.model.rigging import (
    GearBuilder,
    add_bridles,
    add_sweeps,
    bridle_ends_of,
    hung_places,
    rigging_nodes,
    rope_row,
)
from trawl_ros.model.water import Water, build_water
from trawl_ros.records.coefficients import COEFFICIENTS

OUTWARD = np.array([1.0, -1.0])
"""Sign of y that points away from the net's middle: port, starboard."""


@dataclass(frozen=True)
class NodeLayout:
    """Node numbering: the nodes of warps, bridles, net, headrope, footrope and kite.

    ``warps`` and ``bridles`` are tuples of node arrays (warps from block to board, port and
    starboard; bridles from board to net in the order of the gear file, port's, then
    starboard's), ``bridle_ends`` the net's nodes at which these end, ``sweeps`` the nodes of the
    sweeps from backstrops to bridles, none where there are no sweeps, ``net`` the net's nodes;
    ``lines`` (name, point numbers, bar numbers) of everything to be drawn.
    """

    warps: tuple[IntArray, IntArray]
    bridles: tuple[IntArray, ...]
    bridle_ends: IntArray
    sweeps: tuple[IntArray, ...]
    net: IntArray
    headrope: IntArray
    footrope: IntArray
    kite: KiteNodes
    top_warp_bars: IntArray
    lines: tuple[tuple[str, IntArray, IntArray], ...]

    @property
    def bridles_by_side(self) -> tuple[tuple[IntArray, ...], tuple[IntArray, ...]]:
        """Bridles of port and of starboard."""
        half = len(self.bridles) // 2
        return self.bridles[:half], self.bridles[half:]


@dataclass(frozen=True)
class BarGroup:
    """Some k bars: their numbers, the ``points`` at which they end, these ``ends`` (k, 2) as places
    among the points, and their properties.
    """

    bars: IntArray
    points: IntArray
    ends: IntArray
    properties: BarProperties

    def rows(self, nodes: int) -> IntArray:
        """Degrees of freedom of those points that are nodes, of so many in the gear."""
        free = self.points[self.points < nodes]
        every: IntArray = (3 * free[:, None] + np.arange(3)).ravel()
        return every


@dataclass(frozen=True)
class GearModel:
    """Everything the forces need, for ``n`` nodes and ``m`` bars.

    ``ends`` (m, 2) are point numbers; ``rest`` (m,) unstretched lengths; ``warp_side`` (m,) is
    0 or 1 for the bars of a warp, whose length is ``warp length / warp_segments``, else -1.
    Node lumps: ``lump_mass`` kg, ``lump_volume`` m³, ``lump_drag_area`` C_D S m² and
    ``lump_viscous_area`` m² √(m/s) of `lump_pass`, ``lump_added`` kg per kg/m³ of water; ``floats``
    (4, n) are those of the floats among them, in this order. ``sheets`` are those of the netting at
    the nodes, ``node_forces`` lift on ropes and forces beyond the paper's, ``catch`` what lies in
    the codend.

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
    lump_viscous_area: FloatArray
    lump_added: FloatArray
    floats: FloatArray
    layout: NodeLayout
    sheets: NetSheets
    first_guess: FloatArray
    net_mesh: NetMesh
    pattern: SparsityPattern
    node_forces: tuple[NodeForce, ...] = ()
    catch: CodendCatch | None = None

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

    @property
    def paired(self) -> bool:
        """True for a gear that two ships tow without boards."""
        return self.gear.pair is not None

    @cached_property
    def warp_bars(self) -> tuple[IntArray, IntArray]:
        """Bars of the port and of the starboard warp."""
        return np.flatnonzero(self.warp_side == 0), np.flatnonzero(self.warp_side == 1)

    @cached_property
    def rigging(self) -> 'BarGroup':
        """Bars of the warps, and the others at boards."""
        rigged = self.pattern.rigged
        return self._group(np.concatenate([*self.warp_bars, rigged[self.warp_side[rigged] < 0]]))

    @cached_property
    def sheet_slots(self) -> IntArray:
        """Slots (n, 5, 3, 3) of the sheets' blocks in the pattern."""
        return self.pattern.blocks(self.sheets.around[:, :1], self.sheets.around)

    @cached_property
    def warps(self) -> 'BarGroup':
        """Bars of both warps."""
        return self._group(np.concatenate(self.warp_bars))

    def _group(self, bars: IntArray) -> 'BarGroup':
        points, ends = np.unique(self.ends[bars], return_inverse=True)
        return BarGroup(bars, points, ends.reshape(-1, 2), self.bars.chosen(bars))

    @cached_property
    def net_bars(self) -> BoolArray:
        """Flags (m,) of the bars of netting and of ropes of the net."""
        inside: BoolArray = np.isin(self.ends, self.layout.net)
        return inside[:, 0] & inside[:, 1]

    def with_coefficients(self, values: FloatArray) -> 'GearModel':
        """The same gear with other board coefficients, in the order of eq. 36."""
        return replace(self, coefficients=np.asarray(values))

    def with_board(self, **changes: object) -> 'GearModel':
        """The same gear with a changed board, such as its points or installation angles."""
        # Names and types are the caller's: `replace` refuses what a board has not.
        board = replace(self.board, **changes)  # type: ignore[arg-type]
        return replace(self, board=board)

    def with_modifier(self, modifier: CoefficientModifier) -> 'GearModel':
        """The same gear whose boards' coefficients are modified, after any other modifier."""
        bend = self.board.bend
        return self.with_board(bend=modifier if bend is None else InTurn(bend, modifier))

    def with_net(self, drag: float, weight: float) -> 'GearModel':
        """The same gear with this many times the drag coefficients and the weight in water of all
        netting and ropes of the net.
        """
        net = self.net_bars
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
        rotary_slope=record.rotary_slope,
        added_mass=np.array(record.added_mass_kg),
        law=None if polar is None else TableLaw(polar),
    )


def _frame_rests(gear: GearRecord, mesh: NetMesh) -> tuple[list[float], list[float], list[float]]:
    """Rest lengths along headrope, footrope, and the ropes between the wing tips of a side."""
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
        # Wing edges as hung, the rest on the bosom.
        assert rope.length_m is not None
        inner = len(rim) - 1 - 2 * wing_rows
        bosom = (rope.length_m - 2 * wing_rows * edge) / inner
        rests.append([edge] * wing_rows + [bosom] * inner + [edge] * wing_rows)
    return rests[0], rests[1], [record.wing_end_m / bars] * bars


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
    (169, True)
    """
    water, board = build_water(gear), build_board(gear)
    # Without a chord both points of the kite are the headrope's centre.
    chord = None if gear.kite is None else gear.kite.chord_m or 0.0
    mesh = build_net(gear.netting, chord)
    build = GearBuilder()
    warp_row = rope_row(gear.warp, water)
    segments = gear.warp.segments
    warps, top_bars = [], []
    for side, name in enumerate(('port_warp', 'starboard_warp')):
        own = build.nodes(segments - 1)
        warps.append(own)
        points = [build.BLOCK - side, *own, build.FASTENING - 3 * side]
        top_bars.append(build.rope(name, points, [1.0] * segments, warp_row, side)[0])
    net_first = build.count + 2 * rigging_nodes(gear)
    bridle_ends = [net_first + node for node in bridle_ends_of(gear, mesh)]
    sweeps = add_sweeps(build, gear, water)
    bridles = add_bridles(build, gear, water, bridle_ends, sweeps)
    net = build.nodes(len(mesh.positions))

    record = gear.netting
    added = (record.added_mass_normal, 0.0)
    first, before, nodes = len(build.ends), len(build.lines), net.tolist()
    for bar in mesh.bars:
        # The codend's drag is on its nodes, its volume and stiffness in its bars.
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
        build.rope(name, [int(net[k]) for k in rim], rests, rope_row(rope, water))

    lumps = np.zeros((4, build.count))
    lumps[1, net] += mesh.knot_volume
    lumps[2, net] += mesh.knot_area * record.knot_drag + mesh.line_drag_area
    lumps[3, net] += mesh.knot_volume * record.knot_added_mass
    viscous_area = np.zeros(build.count)
    viscous_area[net] = mesh.line_viscous_area + viscous_knots(record, 1.0) * mesh.knot_root
    catch = None if gear.catch is None else place_catch(gear.catch, record, mesh)
    if gear.catch is not None and catch is not None:
        # Where the codend is full the water goes around it, which the drag of the catch counts.
        lumps[2, net] *= 1.0 - catch.covered
        viscous_area[net] *= 1.0 - catch.covered
        lumps[:, net] += catch.lumps(gear.catch, water.density)
    # Knots are made of the twine they join: their mass is the first body section's density.
    lumps[0, net] += mesh.knot_volume * mesh.knot_density
    clump, floats = gear.clump, gear.floats
    buoyant = np.zeros(lumps.shape)
    for rim, force, density, drag_area in (
        (mesh.footrope, clump.weight_in_water_n, clump.density_kg_m3, clump.drag_area_m2),
        (mesh.headrope, -floats.buoyancy_n, floats.density_kg_m3, floats.drag_area_m2),
    ):
        volume = force / water.gravity / (density - water.density)
        # A compact body: half its volume of added mass, as a sphere.
        for tip in (net[rim[0]], net[rim[-1]]):
            body = np.array([density * volume, volume, drag_area, 0.5 * volume])
            (buoyant if rim is mesh.headrope else lumps)[:, tip] += body
    lifting: list[NodeForce] = []
    for item in gear.hung:
        for nodes, shares, force in hung_places(build, item):
            if item.lift_area_m2:
                on = nodes[shares > 0.0]
                lifting.append(LiftingBodies(on, item.lift_area_m2 * shares[shares > 0.0], water))
            volume = force / water.gravity / (item.density - water.density)
            body = np.array([item.density * volume, volume, item.drag_area_m2, 0.5 * volume])
            # A rope passes each node once.
            (buoyant if force < 0.0 else lumps)[:, nodes] += body[:, None] * shares
    lumps += buoyant
    guess = np.full((build.count, 3), np.nan)
    guess[net] = mesh.positions
    ends = build.resolved(build.ends)
    ropes = [(name, build.resolved(points), np.array(bars)) for name, points, bars in build.lines]
    numbers = np.arange(len(ends))
    netting = [
        (bar.group, ends[number], numbers[number : number + 1])
        for number, bar in enumerate(mesh.bars, first)
    ]
    kite = replace(mesh.kite, nodes=net[mesh.kite.nodes])
    sheets = sheets_of(mesh.bars, mesh.positions)
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
        lump_viscous_area=viscous_area,
        lump_added=lumps[3],
        floats=buoyant,
        layout=NodeLayout(
            warps=(warps[0], warps[1]),
            bridles=tuple(bridles),
            bridle_ends=np.array(bridle_ends),
            sweeps=tuple(sweeps),
            net=net,
            headrope=net[mesh.headrope],
            footrope=net[mesh.footrope],
            kite=kite,
            top_warp_bars=np.array(top_bars),
            lines=(*ropes[:before], *netting, *ropes[before:]),
        ),
        sheets=replace(sheets, around=net[sheets.around]),
        first_guess=guess,
        net_mesh=mesh,
        pattern=build_pattern(build.count, ends, kite.nodes),
        node_forces=tuple(lifting),
        catch=catch,
    )


def _build_kite(gear: GearRecord) -> Kite:
    kite = gear.kite
    if kite is None:
        return Kite(0.0, 0.0, 0.0, 0.0, False, 0.0, 1.0, 0.0)
    return Kite(
        area=kite.area_m2,
        mass=kite.mass_kg,
        volume=kite.volume_m3,
        setting=float(np.radians(kite.setting_deg)),
        pitched=kite.chord_m is not None,
        normal_slope=kite.normal_slope,
        normal_limit=kite.normal_limit,
        drag_base=kite.drag_base,
    )
