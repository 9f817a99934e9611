# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figure of a rigged gear from above, from the side, and from ahead."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.catch import CatchBody
from trawl_ros.model.assembly import points_of
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.kite import LiftingBodies
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.plots.shapes import chain, plate
from trawl_ros.records.observables import Observables
from trawl_ros.report import style
from trawl_ros.solver.first_guess import first_guess
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow

WARP, SPEED = 200.0, 1.5
"""Warp length (m) and speed (m/s) at which it is drawn; warps are cut off in the pictures."""

VIEWS = (
    ('from above', (0, 1), ('astern / m', 'to port / m')),
    ('from the side', (0, 2), ('astern / m', 'up / m')),
    ('from ahead', (1, 2), ('to port / m', 'up / m')),
)

ASTERN = np.array([-1.0, 1.0, 1.0])
"""Signs of axes astern, to port and up."""

KITE = '#d98c00'

WIDTH_IN, LEFT_IN = 13.0, 8.5
"""Width (inches) of the figure, and of the views from above and from the side."""

LEAST_IN, LABELS_IN = 1.2, 1.8
"""Least height of a view, and room for all titles and labels of axes (inches)."""

THICK = ('_bridle', '_sweep', '_backstrop', 'headrope', 'footrope', '_wing_end')
COLOURS = {
    'netting': style.NETTING,
    'codend': style.NETTING,
    '_wing_end': '#7b4ea3',
    'catch': '#8c564b',
}


def rigged_gear_figure(model: GearModel, state: State | None = None) -> Figure:
    """Draw boards, bridles, frame ropes and netting, without warps.

    ``state`` is a steady state. Without one the net is drawn as built: this is the first shape of
    the search for a steady state, and not the shape in which the gear tows.
    """
    warp = max(WARP, model.gear.block_distance)
    tow = steady_tow(model, OperatingPoint(warp, warp, SPEED))
    shape = first_guess(model, tow, 0.0) if state is None else state
    lines = _lines(model, shape, tow)
    points = np.concatenate([piece.reshape(-1, 3) for _, piece in lines])
    origin = shape.board_positions.mean(axis=0)
    along, across, tall = np.ptp(points, axis=0)
    heights = [max(LEAST_IN, LEFT_IN * size / along) for size in (across, tall)]
    figure = Figure(figsize=(WIDTH_IN, sum(heights) + LABELS_IN), layout='constrained')
    grid = figure.add_gridspec(
        2, 2, width_ratios=(LEFT_IN, WIDTH_IN - LEFT_IN), height_ratios=heights
    )
    seen = None if state is None else observe(model, state, tow)
    places = grid[0, 0], grid[1, 0], grid[:, 1]
    for place, (title, plane, labels) in zip(places, VIEWS, strict=True):
        axes = figure.add_subplot(place)
        style.quiet(axes)
        for name, pieces in lines:
            thick = name.endswith(THICK) or name in ('board', 'catch')
            axes.add_collection(
                LineCollection(
                    list(pieces[:, :, plane]),
                    colors=_colour(name),
                    linewidths=1.8 if thick else 0.4,
                    zorder=3 if thick else 2,
                )
            )
        for force in model.node_forces:
            if isinstance(force, LiftingBodies):
                places = (shape.nodes[force.nodes] - origin) * ASTERN
                sign = '^' if force.area.sum() > 0.0 else 'v'
                axes.plot(*places[:, plane].T, sign, color=KITE, markersize=4, zorder=4)
        low, high = points[:, plane].min(axis=0), points[:, plane].max(axis=0)
        margin = 0.04 * float((high - low).max())
        axes.set_xlim(low[0] - margin, high[0] + margin)
        axes.set_ylim(low[1] - margin, high[1] + margin)
        axes.set_aspect('equal', adjustable='box')
        axes.set_title(title + _sizes(title, seen), fontsize='medium')
        axes.set_xlabel(labels[0])
        axes.set_ylabel(labels[1])
    state_of = 'as it is built, not solved' if state is None else 'in a steady state'
    figure.suptitle(f'{model.gear.name}: the rigged gear {state_of}', parse_math=False)
    return figure


def _sizes(view: str, seen: Observables | None) -> str:
    """Sizes of the gear that a view shows, in m, where it is solved."""
    if seen is None or view == 'from the side':
        return ''
    if view == 'from above':
        return f': doors {seen.door_spread:.0f} m apart'
    return f': mouth {seen.vertical_opening:.0f} m high, {seen.horizontal_opening:.0f} m wide'


def _lines(model: GearModel, state: State, tow: Tow) -> list[tuple[str, FloatArray]]:
    """Pieces (n, 2, 3) of all lines except warps: astern of, to port of and above the boards."""
    points = points_of(model, state, tow).positions
    turn = ASTERN
    origin = state.board_positions.mean(axis=0)
    grouped: dict[str, list[FloatArray]] = {}
    for name, numbers, _ in model.layout.lines:
        if not name.endswith('_warp'):
            along = (points[numbers] - origin) * turn
            grouped.setdefault(name, []).append(chain(along))
    for place, axes in zip(state.board_positions, state.board_rotations, strict=True):
        board = plate(place - origin, axes, (model.board.chord, model.board.span))
        grouped.setdefault('board', []).append(board * turn)
    if model.catch is not None:
        for ring in _catch_rings(model.catch.body, points[model.layout.net[-2:]]):
            grouped.setdefault('catch', []).append(chain((ring - origin) * turn))
    return [(name, np.concatenate(pieces)) for name, pieces in grouped.items()]


def _catch_rings(body: CatchBody, line: FloatArray) -> list[FloatArray]:
    """Outlines (n, 3) of a catch at the end of a line (2, 3): two along it, one across."""
    end, back = line[1], (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    side = np.cross([0.0, 0.0, 1.0], back)
    side /= np.linalg.norm(side)
    angles = np.linspace(0.0, 2.0 * np.pi, 73)
    straight = body.length - 2.0 * body.radius
    along = body.radius * (np.cos(angles) - 1.0) - np.where(np.cos(angles) < 0.0, straight, 0.0)
    rings = []
    for across in (side, np.cross(back, side)):
        rings.append(end + np.outer(along, back) + np.outer(body.radius * np.sin(angles), across))
    middle = end - 0.5 * body.length * back
    round_ = np.outer(np.cos(angles), side) + np.outer(np.sin(angles), np.cross(back, side))
    return [*rings, middle + body.radius * round_]


def _colour(name: str) -> str:
    for end, colour in COLOURS.items():
        if name.endswith(end):
            return colour
    if name.startswith('port'):
        return style.PORT
    return style.STARBOARD if name.startswith('starboard') else '#222222'
