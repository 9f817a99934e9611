# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of the gear from above, from the side and from behind."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.messages.markers import FULL_SCALE, RAMP
from trawl_ros.plots.records import SCHOOLS, GearShape, Strand
from trawl_ros.records.topics import DOOR_FRAMES, VESSEL
from trawl_ros.report import style

BOLD_STRANDS = (
    '_warp',
    '_bridle',
    '_sweep',
    '_backstrop',
    'headrope',
    'footrope',
    'mouth',
    *DOOR_FRAMES.values(),
)
"""Name endings of what is drawn bold."""

DOOR_COLOURS = {DOOR_FRAMES['port']: style.PORT, DOOR_FRAMES['starboard']: style.STARBOARD}

ABOVE, BESIDE, BEHIND = (0, 1), (0, 2), (1, 2)
"""Axes (of astern, to port, up) that are drawn to the right and up."""

SIZES = '#333333'
"""Colour of the sizes that are written on the gear."""

LEFT_IN, RIGHT_IN, TITLE_IN, FOOT_IN, GAP_IN = 0.8, 0.25, 0.55, 0.65, 0.4
"""Room (inches) around and between the views."""

LEAST_HEIGHT = 0.13
"""Smallest height of the views from above and from the side, as a share of their width."""

Extent = tuple[FloatArray, FloatArray]
"""Lower and upper bounds (3,) astern, to port and up, m."""


@dataclass(frozen=True)
class Views:
    """Figure with views from above and from the side, and room (axes) to the right of them."""

    figure: Figure
    top: Axes
    side: Axes
    right: Axes


def gear_figure(shape: GearShape, name: str) -> Figure:
    """Draw the gear with the ship's towing blocks at the origin; all scales are equal."""
    views = lay_out(extent([shape]), width=8.4, right=3.7)
    prepare_rear(views.right, extent([shape], rear=True))
    for axes, plane in ((views.top, ABOVE), (views.side, BESIDE), (views.right, BEHIND)):
        draw_gear(shape, axes, plane)
    write_sizes(shape, views)
    if size := opening_size(shape):
        views.right.set_title(
            'from behind: {:.0f} m high, {:.0f} m wide'.format(*size), fontsize=10
        )
    title = f'{name} at {style.clock(shape.time)}: {shape.source}'
    views.figure.suptitle(title, parse_math=False)
    if shape.by_tension:
        _tension_bar(views.figure, views.right)
    return views.figure


def lay_out(whole: Extent, *, width: float, right: float) -> Views:
    """Make a figure for views of ``whole``, all to one scale.

    ``width`` (inches) is that of the views from above and from the side; their height follows from
    the scale. ``right`` is the width of what is drawn next to them.
    """
    low, high = whole
    margin = 0.03 * float((high - low).max())
    spans = high - low + 2.0 * margin
    scale = width / spans[0]
    upper, lower = (max(scale * span, LEAST_HEIGHT * width) for span in spans[1:])
    tall = upper + GAP_IN + lower
    size = (LEFT_IN + width + LEFT_IN + right + RIGHT_IN, FOOT_IN + tall + TITLE_IN)
    figure = Figure(figsize=size)

    def place(x: float, y: float, wide: float, high: float) -> Axes:
        return figure.add_axes((x / size[0], y / size[1], wide / size[0], high / size[1]))

    side = place(LEFT_IN, FOOT_IN, width, lower)
    top = place(LEFT_IN, FOOT_IN + lower + GAP_IN, width, upper)
    beside = place(2.0 * LEFT_IN + width, FOOT_IN, right, tall)
    for axes, down, height in ((top, 1, upper), (side, 2, lower)):
        style.quiet(axes)
        axes.set_xlim(low[0] - margin, high[0] + margin)
        middle, half = 0.5 * (low[down] + high[down]), 0.5 * height / scale
        axes.set_ylim(middle - half, middle + half)
    top.set_ylabel('to port / m')
    top.tick_params(labelbottom=False)
    side.set_ylabel('depth / m')
    side.set_xlabel('behind the ship / m')
    side.axhline(0.0, color=style.SURFACE, linewidth=0.9, zorder=0)
    side.yaxis.set_major_formatter(_depth)
    return Views(figure, top, side, beside)


def extent(shapes: Sequence[GearShape], *, rear: bool = False) -> Extent:
    """Bounds of the views: fish only if near; the view from behind without ship and warps."""
    points = [
        strand.pieces.reshape(-1, 3)
        for shape in shapes
        for strand in shape.strands
        if strand.name != SCHOOLS and (not rear or _seen_from_behind(strand))
    ]
    # The surface belongs to what is seen from the side, the ship to what is seen from above.
    every = np.concatenate([*points, *([] if rear else [np.zeros((1, 3))])])
    return every.min(axis=0), every.max(axis=0)


def prepare_rear(rear: Axes, wake: Extent) -> None:
    """Set labels and limits of the view from behind: looking ahead, port is on the left."""
    low, high = wake
    margin = 0.06 * float((high - low)[1:].max())
    style.quiet(rear)
    rear.set_aspect('equal', adjustable='box', anchor='N')
    rear.set_xlim(high[1] + margin, low[1] - margin)
    rear.set_ylim(low[2] - margin, high[2] + margin)
    rear.yaxis.set_major_formatter(_depth)
    rear.set_xlabel('to port / m')
    rear.set_ylabel('depth / m')
    rear.set_title('from behind', fontsize='medium')


def _depth(height: float, _: float) -> str:
    return f'{0.0 - height:g}'


def draw_gear(shape: GearShape, axes: Axes, plane: tuple[int, int]) -> list[Artist]:
    """Draw all strands into one view, with a dot in port's or starboard's colour on each door."""
    drawn: list[Artist] = []
    for strand in shape.strands:
        if plane == BEHIND and not _seen_from_behind(strand):
            continue
        lines = LineCollection(
            list(strand.pieces[:, :, plane]),
            colors=strand.colours,
            linewidths=1.8 if strand.name.endswith(BOLD_STRANDS) else 0.5,
            capstyle='round',
        )
        drawn.append(axes.add_collection(lines))
        if strand.name in DOOR_COLOURS and plane != BEHIND:
            drawn += axes.plot(
                *strand.pieces.reshape(-1, 3).mean(axis=0)[list(plane)], 'o',
                color=DOOR_COLOURS[strand.name], markersize=4.5, markeredgecolor='white', zorder=4,
            )  # fmt: skip
    return drawn


def write_sizes(shape: GearShape, views: Views) -> list[Artist]:
    """Write spread and depth (m) of the doors on the views from above and from the side."""
    points = {strand.name: strand.pieces.reshape(-1, 3) for strand in shape.strands}
    drawn: list[Artist] = []
    doors = [points[name].mean(axis=0) for name in DOOR_FRAMES.values() if name in points]
    if len(doors) == 2:
        port, starboard = doors
        drawn.append(
            views.top.annotate(
                '', port[:2], starboard[:2], arrowprops={'arrowstyle': '<->', 'color': SIZES}
            )
        )
        middle = 0.5 * (port + starboard)
        spread = float(np.linalg.norm(port - starboard))
        drawn.append(
            views.top.text(
                float(middle[0]), float(middle[1]), f' {spread:.0f} m', color=SIZES, va='center'
            )
        )
        drawn.append(
            views.side.annotate(
                f'doors {-middle[2]:.0f} m deep',
                (middle[0], middle[2]),
                (-6.0, -12.0),
                textcoords='offset points',
                color=SIZES,
                ha='right',
                va='top',
            )
        )
    return drawn


def opening_size(shape: GearShape) -> tuple[float, float] | None:
    """Height and width (m) of the mouth; None for a shape without headrope or footrope."""
    ropes = [
        [strand.pieces.reshape(-1, 3) for strand in shape.strands if strand.name.endswith(rope)]
        for rope in ('headrope', 'footrope')
    ]
    if not all(ropes):
        return None
    head, foot = map(np.concatenate, ropes)
    width = float(np.ptp(np.concatenate([head, foot])[:, 1]))
    return float(head[:, 2].max() - foot[:, 2].min()), width


def _seen_from_behind(strand: Strand) -> bool:
    return strand.name != VESSEL and not strand.name.endswith('_warp')


def _tension_bar(figure: Figure, beside: Axes) -> None:
    box = beside.get_position(original=True)
    inch = 1.0 / figure.get_size_inches()[1]
    axes = figure.add_axes((box.x0, box.y0, box.width, 0.14 * inch))
    ramp = LinearSegmentedColormap.from_list('tension', RAMP.tolist())
    bar = figure.colorbar(
        ScalarMappable(Normalize(0.0, 1e-3 * FULL_SCALE), ramp),
        cax=axes,
        orientation='horizontal',
        extend='max',
    )
    bar.set_label('tension / kN')
    bar.outline.set_visible(False)
    beside.set_position((box.x0, box.y0 + 0.8 * inch, box.width, box.height - 0.8 * inch))
