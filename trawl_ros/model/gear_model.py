# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Gear as arrays: nodes, boards and the bars between them, in one numbering.

Points are numbered nodes first (free), then the boards' fastening points (warp, upper bridle,
lower bridle; port board, then starboard), then the two towing blocks. Degrees of freedom are
three per node, then six per board: translation and rotation vector, both in fixed axes.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.gear.boards import BoardRecord
from trawl_ros.gear.polars import polar_of
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.board import Board
from trawl_ros.model.board_laws import EQ14, BoardLaw, FormulaLaw, TableLaw
from trawl_ros.model.hooks import CoefficientModifier, ComposedModifier, NodeForce
from trawl_ros.model.kite import Kite, build_kite
from trawl_ros.model.line import BarGroup, BarProperties
from trawl_ros.model.net.catch import CodendCatch
from trawl_ros.model.net.kite_nodes import KiteNodes
from trawl_ros.model.net.netting import build_net
from trawl_ros.model.net.sheets import NetSheets, sheets_of
from trawl_ros.model.net.weave import NetMesh
from trawl_ros.model.pattern import SparsityPattern, build_pattern
from trawl_ros.model.rigging import (
    GearBuilder,
    add_bridles,
    add_net,
    add_sweeps,
    add_warps,
    bridle_ends_of,
    lumps_of,
    rigging_nodes,
)
from trawl_ros.model.water import Water, build_water

OUTWARD = np.array([1.0, -1.0])
"""Sign of y that points away from the net's middle: port, starboard."""


@dataclass(frozen=True)
class DrawnLines:
    """Lines to be drawn, one after the other.

    ``points`` and ``bars`` are the numbers of all lines, ``first_points`` and ``first_bars`` the
    places in them at which each line begins.
    """

    names: tuple[str, ...]
    points: IntArray
    bars: IntArray
    first_points: list[int]
    first_bars: IntArray


@dataclass(frozen=True)
class NodeLayout:
    """Node numbers of warps, bridles, net, headrope, footrope and kite.

    Attributes
    ----------
    warps
        Nodes of the port and of the starboard warp, from block to board.
    bridles
        Nodes of the bridles, from board to net, in the order of the gear file; port first.
    bridle_ends
        Nodes of the net at which the bridles end.
    sweeps
        Nodes of the sweeps, from backstrops to bridles; empty for gear without sweeps.
    net, headrope, footrope, kite
        Nodes of the net, of both ropes along it, and of the kite.
    top_warp_bars
        Highest bar of either warp.
    lines
        Name, point numbers and bar numbers of everything to be drawn.
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

    @cached_property
    def drawn(self) -> DrawnLines:
        """All of ``lines`` as arrays, for pictures."""
        names, points, bars = zip(*self.lines)
        ends = [np.cumsum([0, *map(len, groups)])[:-1] for groups in (points, bars)]
        return DrawnLines(
            names, np.concatenate(points), np.concatenate(bars), ends[0].tolist(), ends[1]
        )

    @property
    def bridles_by_side(self) -> tuple[tuple[IntArray, ...], tuple[IntArray, ...]]:
        """Bridles of port and of starboard."""
        half = len(self.bridles) // 2
        return self.bridles[:half], self.bridles[half:]


@dataclass(frozen=True)
class GearModel:
    """Everything the forces need, for ``n`` nodes and ``m`` bars.

    Attributes
    ----------
    gear, water, board, kite, coefficients
        Record of the gear file, the water, properties of boards and kite, and the coefficients of
        eq. 36.
    bars
        Properties of the bars.
    ends : (m, 2) array
        Point numbers of both ends of each bar.
    rest : (m,) array
        Unstretched lengths, m.
    warp_side : (m,) array
        0 or 1 for the bars of a warp, whose length is ``warp length / warp_segments``, else -1.
    lump_mass, lump_volume, lump_drag_area, lump_viscous_area, lump_added : (n,) arrays
        Lumps at the nodes: kg, m³, C_D S in m², its viscous part in m² √(m/s) as in `lump_pass`,
        and added mass in kg per kg/m³ of water.
    floats : (4, n) array
        Part of mass, volume, drag area and added mass of the lumps that belongs to floats.
    layout
        Node numbers of the parts of the gear.
    sheets
        Sheets of netting at the nodes.
    first_guess : (n, 3) array
        Positions of the net's nodes as drawn, m; NaN for all other nodes.
    net_mesh
        Nodes and bars of the net alone.
    pattern
        Sparsity pattern of the matrices.
    node_forces
        Lift on ropes, and forces beyond the paper's.
    catch
        Catch in the codend.

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
        """True for a pair trawl, which two ships tow without boards."""
        return self.gear.pair is not None

    @cached_property
    def warp_bars(self) -> tuple[IntArray, IntArray]:
        """Bars of the port and of the starboard warp."""
        return np.flatnonzero(self.warp_side == 0), np.flatnonzero(self.warp_side == 1)

    @cached_property
    def rigging(self) -> BarGroup:
        """Bars of the warps, and all other bars at boards."""
        rigged = self.pattern.rigged
        return self._group(np.concatenate([*self.warp_bars, rigged[self.warp_side[rigged] < 0]]))

    @cached_property
    def sheet_slots(self) -> IntArray:
        """Slots (n, 5, 3, 3) of the sheets' blocks in the pattern."""
        return self.pattern.blocks(self.sheets.around[:, :1], self.sheets.around)

    @cached_property
    def warps(self) -> BarGroup:
        """Bars of both warps."""
        return self._group(np.concatenate(self.warp_bars))

    def _group(self, bars: IntArray) -> BarGroup:
        points, ends = np.unique(self.ends[bars], return_inverse=True)
        return BarGroup(bars, points, ends.reshape(-1, 2), self.bars.chosen(bars))

    @cached_property
    def net_bars(self) -> BoolArray:
        """Flags (m,) of the bars of netting and of ropes of the net."""
        inside: BoolArray = np.isin(self.ends, self.layout.net)
        return inside[:, 0] & inside[:, 1]

    def with_coefficients(self, values: FloatArray) -> 'GearModel':
        """Return the gear with other board coefficients, in the order of their law."""
        return replace(self, coefficients=np.asarray(values))

    def with_board(self, **changes: object) -> 'GearModel':
        """Return the gear with a changed board, such as its points or installation angles."""
        # `replace` refuses names that a board does not have.
        board = replace(self.board, **changes)  # type: ignore[arg-type]
        return replace(self, board=board)

    def with_modifier(self, modifier: CoefficientModifier) -> 'GearModel':
        """Return the gear with a modifier of the boards' coefficients, applied after any other."""
        first = self.board.coefficient_modifier
        both = modifier if first is None else ComposedModifier(first, modifier)
        return self.with_board(coefficient_modifier=both)

    def with_net(self, drag: float, weight: float) -> 'GearModel':
        """Return the gear with scaled drag and weight in water of the net and its ropes.

        Parameters
        ----------
        drag, weight
            Factors on the drag coefficients and on the weight in water.
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
    """Return the board of a gear file."""
    record = gear.board
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
        law=_law(record),
    )


def _law(board: BoardRecord) -> BoardLaw:
    """Return the law of a board's record."""
    if (polar := polar_of(board)) is not None:
        return TableLaw(polar)
    return EQ14 if board.law is None else FormulaLaw(board.law.kind)


def build_model(gear: GearRecord) -> GearModel:
    """Build the arrays of a gear from its record.

    Parameters
    ----------
    gear
        Record from `load_gear`, optionally with another mesh by `GearRecord.refined`.

    Returns
    -------
    GearModel
        Immutable model without state; any number of tows may share it.

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
    # A kite without a chord has both of its points at the headrope's centre.
    chord = None if gear.kite is None else gear.kite.chord_m or 0.0
    mesh = build_net(gear.netting, chord)
    build = GearBuilder()
    warps, top_bars = add_warps(build, gear, water)
    net_first = build.count + 2 * rigging_nodes(gear)
    bridle_ends = [net_first + node for node in bridle_ends_of(gear, mesh)]
    sweeps = add_sweeps(build, gear, water)
    bridles = add_bridles(build, gear, water, bridle_ends, sweeps)
    net = build.nodes(len(mesh.positions))

    first, before = len(build.ends), len(build.lines)
    add_net(build, gear, water, mesh, net)
    lumps = lumps_of(build, gear, water, mesh, net)
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
        kite=build_kite(gear),
        coefficients=gear.board.coefficients.array(),
        bars=BarProperties(*np.array(build.rows).T),
        ends=ends,
        rest=np.array(build.rest),
        warp_side=np.array(build.side),
        lump_mass=lumps.columns[0],
        lump_volume=lumps.columns[1],
        lump_drag_area=lumps.columns[2],
        lump_viscous_area=lumps.viscous_area,
        lump_added=lumps.columns[3],
        floats=lumps.floats,
        layout=NodeLayout(
            warps=warps,
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
        node_forces=lumps.lifting,
        catch=lumps.catch,
    )
