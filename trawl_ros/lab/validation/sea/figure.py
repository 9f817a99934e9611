"""Figure of hauls: the model's values over those measured at sea."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.lab.validation.sea.tables import FORCES

MARKS = {
    'door_depth': 'v',
    'door_spread': 'o',
    'net_depth': '^',
    'vertical_opening': 's',
    'horizontal_opening': 'D',
    'warp_tension': 'P',
    'net_drag': 'X',
    'lower_bridle_tension': 'd',
    'board_attack': '>',
    'mouth_area': '*',
}


def haul_figure(
    points: Sequence[tuple[str, str, float, float, str]], near_percent: float
) -> Figure:
    """Model over sea, both logarithmic: lengths (m), areas (m²), angles (°); forces (kN) apart.

    Parameters
    ----------
    points
        Gear, quantity, measured value, value of the model (NaN for none), and use of the haul.
    near_percent
        Half width of the band around equality, %.
    """
    forces = [p for p in points if p[1] in FORCES]
    lengths = [p for p in points if p[1] not in FORCES]
    groups = [('m, m², °', 1.0, lengths)] + ([('kN', 1e-3, forces)] if forces else [])
    gears = list(dict.fromkeys(p[0] for p in points))
    figure = Figure(figsize=(5.2 * len(groups), 4.8), layout='constrained')
    for axes, (unit, scale, group) in zip(
        np.atleast_1d(figure.subplots(1, len(groups))), groups, strict=True
    ):
        labels = set()
        for gear, quantity, sea, model, use in group:
            colour = f'C{gears.index(gear)}'
            label = f'{gear}, {quantity.replace("_", " ")}'
            axes.loglog(
                scale * sea,
                scale * model,
                MARKS[quantity],
                color=colour,
                markerfacecolor=colour if use == 'counts' else 'none',
                label=None if label in labels else label,
            )
            labels.add(label)
        values = scale * np.array([p[2] for p in group] + [p[3] for p in group])
        values = values[np.isfinite(values)]
        ends = np.array([0.7 * values.min(), 1.4 * values.max()])
        axes.plot(ends, ends, 'k-', linewidth=0.8)
        near = near_percent / 100.0
        axes.fill_between(ends, (1 - near) * ends, (1 + near) * ends, color='k', alpha=0.08)
        axes.set(xlabel=f'sea / {unit}', ylabel=f'model / {unit}', xlim=ends, ylim=ends)
        axes.grid(which='both', alpha=0.3)
        axes.legend(fontsize='x-small')
    return figure
