# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figure of a net plan: the pieces of each panel, as a net maker draws them."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from trawl_ros.gear.net_plan import NetPlanRecord, PieceRecord
from trawl_ros.report import style

PANELS = ('upper', 'side', 'side_upper', 'side_lower', 'lower')
TITLES = {'side_upper': 'upper side', 'side_lower': 'lower side'}
FACES = {'wing': '#dfeaf2', 'body': '#f4f1e8', 'codend': '#ece4ee'}
LABEL_LENGTH = 0.03
"""Pieces shorter than this share of the net get no label of their own."""

LABEL_WIDTH_SHARE = 0.47
"""Share of the picture's half width that a piece needs for its label."""

Shape = tuple[PieceRecord, list[tuple[float, float]]]
"""Piece with its corners (stretched widths across, distance behind the foremost wing, m)."""


def net_plan_figure(name: str, plan: NetPlanRecord) -> Figure:
    """Draw the upper, side and lower panel of a net plan next to each other.

    Lengths and widths are those of stretched netting. A net does not have both at once, so the
    picture shows the plan and not the net.
    """
    panels = [p for p in PANELS if p in ('upper', 'lower') or p in plan.panels]
    figure = Figure(figsize=(4.4 * len(panels), 10.0), layout='constrained')
    every = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    ahead = max(plan.wing_length(panel) for panel in ('upper', 'lower'))
    rear = sum(
        float(np.mean([p.length for p in pieces]))
        for part in ('body', 'codend')
        for _, pieces in plan.sections(part)
    )
    wide = 0.55 * max(plan.mouth_width(name) for name in panels)
    for axes, panel in zip(every, panels, strict=True):
        style.quiet(axes)
        for piece, corners in _shapes(plan, panel, ahead):
            axes.add_patch(
                Polygon(
                    corners,
                    facecolor=FACES[piece.part],
                    edgecolor='#333333',
                    linewidth=0.8,
                    hatch='|' if piece.orientation == 'ropes' else None,
                )
            )
            long = corners[2][1] - corners[0][1]
            # What goes all around is labelled once.
            again = piece.panel == 'all' and panel != panels[0]
            if not again and (abs(long) > LABEL_LENGTH * (ahead + rear) or piece.part == 'wing'):
                _label(axes, piece, corners, wide)
        axes.set_xlim(-wide, wide)
        axes.set_ylim(1.01 * (ahead + rear), -0.01 * (ahead + rear))
        axes.set_title(f'{TITLES.get(panel, panel)} panel', fontsize='medium')
        axes.set_xlabel('stretched width / m')
    every[0].set_ylabel('stretched length behind the wing tips / m')
    figure.suptitle(
        f'{name}: net plan, {plan.circumference:.4g} m around the mouth', parse_math=False
    )
    return figure


def _shapes(plan: NetPlanRecord, panel: str, ahead: float) -> list[Shape]:
    """Pieces of a panel with their corners; in a side panel the upper wing is on the left."""
    found: list[Shape] = []
    mouth = 0.5 * plan.mouth_width(panel)
    names = ('side', 'side_upper', 'side_lower') if panel == 'side' else (panel,)
    for name in names:
        x, signs = ahead, {'side_upper': (-1,), 'side_lower': (1,)}.get(name, (-1, 1))
        for piece in plan.wing(name):
            front, back = piece.widths
            x, behind = x - piece.length, x
            if name == 'side' or piece.pieces == 1:
                found.append((piece, _trapeze(front, back, x, behind)))
                continue
            for sign in signs:
                # The seam runs straight, the edge inside it is cut.
                inner = [(sign * (mouth - back), behind), (sign * (mouth - front), x)]
                found.append((piece, [(sign * mouth, x), (sign * mouth, behind), *inner]))
    x, share = ahead, 1.0
    for part in ('body', 'codend'):
        for _, pieces in plan.sections(part):
            own = next((p for p in pieces if p.panel in (panel, 'all')), None)
            if own is None:  # a side that is one panel here, or two
                own = next(p for p in pieces if p.panel.startswith('side'))
            # As much of what goes all around as the panel was of the netting ahead of it.
            front, back = (width * (share if own.panel == 'all' else 1.0) for width in own.widths)
            if own.panel != 'all':
                share = own.widths[1] / sum(piece.count * piece.widths[1] for piece in pieces)
            found.append((own, _trapeze(front, back, x, x + own.length)))
            x += own.length
    return found


def _trapeze(front: float, back: float, x: float, behind: float) -> list[tuple[float, float]]:
    half, rear = 0.5 * front, 0.5 * back
    return [(-half, x), (half, x), (rear, behind), (-rear, behind)]


def _label(axes: Axes, piece: PieceRecord, corners: list[tuple[float, float]], wide: float) -> None:
    across, behind = np.mean(corners, axis=0)
    # Words that are wider than their piece stand next to it.
    right = max(corner[0] for corner in corners)
    fits = piece.part == 'wing' or right > LABEL_WIDTH_SHARE * wide
    knots = ', knotless' if piece.knots == 'knotless' else ''
    whole = ' around' if piece.panel == 'all' else ''
    # The cut edge of a wing leaves room for short lines only.
    between = '\n' if piece.part == 'wing' else ' '
    counts = f'{piece.mesh_mm:g} mm,{between}{piece.front_meshes:g}–{piece.back_meshes:g} × '
    counts += f'{piece.long_meshes:g}{whole}'
    ropes = piece.orientation == 'ropes'
    if ropes:
        counts, knots = f'{piece.front_meshes:g} ropes of {piece.length:.3g} m', ''
    x, side = (across, 'center') if fits else (right + 0.02 * wide, 'left')
    if piece.part == 'wing' and abs(across) > 0.02 * wide:
        # From the seam inward and towards the mouth, for the cut edge leaves no room ahead.
        behind = np.average([corner[1] for corner in corners]) + 0.25 * piece.length
        x = max((corner[0] for corner in corners), key=abs) - np.sign(across) * 0.02 * wide
        side = 'left' if across < 0.0 else 'right'
    axes.text(
        x,
        behind,
        f'{counts}\n{piece.material} {1e3 * piece.twine.diameter:.2g} mm{knots}',
        ha=side,
        va='center',
        fontsize=7.0,
        parse_math=False,
        backgroundcolor=FACES[piece.part] if ropes else 'none',
    )
