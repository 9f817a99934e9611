# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Lattices of operating points for branch continuation, and their maps.

A lattice is over warp length and speed, or over warp length and an installation angle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from trawl_ros.lab.validation.branches.continuation import (
    Answer,
    Place,
    Spot,
    Verdict,
    continue_branches,
)
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.operating_point import OperatingPoint

SPEED = 2.1
"""Speed (m/s) at which installation angles are varied, that of the paper's trial."""

Angle = Literal['ε', 'ζ', 'η']
ANGLES: tuple[Angle, ...] = ('ε', 'ζ', 'η')


@dataclass(frozen=True)
class Lattice:
    """Lattice of answers: rows are warp lengths (m), columns are named by ``across``."""

    across: str
    lengths: Sequence[float]
    columns: Sequence[float]
    answers: dict[Spot, Answer]

    def at(self, row: int, column: int) -> Answer:
        """The answer in a row and column."""
        return self.answers[row, column]


def speed_lattice(model: GearModel, lengths: Sequence[float], speeds: Sequence[float]) -> Lattice:
    """Continue steady states over warp lengths and speeds."""
    places = {
        (i, j): Place(model, OperatingPoint(length, length, speed))
        for i, length in enumerate(lengths)
        for j, speed in enumerate(speeds)
    }
    return _continued('speed through the water (m/s)', lengths, speeds, places, SPEED)


def angle_lattice(
    model: GearModel, lengths: Sequence[float], angle: Angle, degrees: Sequence[float]
) -> Lattice:
    """Continue steady states over warp lengths and one installation angle (°)."""
    turned = []
    for value in degrees:
        installation = np.zeros(3)
        installation[ANGLES.index(angle)] = np.radians(value)
        turned.append(model.with_board(installation=tuple(installation)))
    places = {
        (i, j): Place(turned[j], OperatingPoint(length, length, SPEED))
        for i, length in enumerate(lengths)
        for j in range(len(degrees))
    }
    return _continued(f'installation angle {angle} (°)', lengths, degrees, places, 0.0)


def _continued(
    across: str,
    lengths: Sequence[float],
    columns: Sequence[float],
    places: dict[Spot, Place],
    usual: float,
) -> Lattice:
    """Continue from the middle length at the usual speed or angle; every third place also cold."""
    first = len(lengths) // 2, int(np.abs(np.array(columns) - usual).argmin())
    cold = [(i, j) for i, j in places if (i + j) % 3 == 0]
    return Lattice(across, lengths, columns, continue_branches(places, first, cold))


VERDICT_STYLES: dict[Verdict, tuple[str, str]] = {
    'usable': ('#7fbf7b', 'usable: stable, under water, within the law'),
    'unstable': ('#fdd49e', 'refused: unstable'),
    'surfaced': ('#9ecae1', 'refused: gear breaks the surface'),
    'outside law': ('#c994c7', 'refused: a board works outside its law'),
    'collapsed': ('#8c6d5a', 'refused: collapsed'),
    'fold': ('#fb8072', 'refused: beyond a fold'),
    'lift lost': ('#bebada', 'refused: boards lie over'),
    'no balance': ('#bdbdbd', 'refused: boards do not stay upright'),
    'none found': ('#d9d9d9', 'refused: none found'),
}
"""Colour and name of each verdict."""


def speed_figure(lattice: Lattice) -> Figure:
    """The map over warp length and speed."""
    figure = Figure(figsize=(10.0, 5.2), layout='constrained')
    draw_map(figure.subplots(), lattice)
    _legend(figure, [lattice])
    return figure


def angle_figure(lattices: Sequence[Lattice]) -> Figure:
    """Maps over warp length and each installation angle, side by side."""
    figure = Figure(figsize=(14.0, 4.6), layout='constrained')
    for axes, lattice in zip(
        figure.subplots(1, len(lattices), sharey=True, squeeze=False)[0], lattices, strict=True
    ):
        draw_map(axes, lattice)
        axes.label_outer()
    _legend(figure, lattices)
    return figure


def draw_map(axes: Axes, lattice: Lattice) -> None:
    """Colour each place by its verdict, and write the attack angle if there is a root."""
    kinds = list(VERDICT_STYLES)
    shape = len(lattice.lengths), len(lattice.columns)
    codes = np.array(
        [[kinds.index(lattice.at(i, j).verdict) for j in range(shape[1])] for i in range(shape[0])]
    )
    axes.pcolormesh(
        np.arange(shape[1] + 1) - 0.5,
        np.arange(shape[0] + 1) - 0.5,
        codes,
        cmap=ListedColormap([VERDICT_STYLES[kind][0] for kind in kinds]),
        norm=BoundaryNorm(np.arange(len(kinds) + 1) - 0.5, len(kinds)),
        edgecolors='white',
        linewidth=0.5,
    )
    for (i, j), answer in lattice.answers.items():
        if answer.root is not None:
            attack = np.degrees(answer.root.observables.port_attack)
            axes.text(j, i, f'{attack:.0f}', ha='center', va='center', fontsize=7)
    axes.set_xticks(range(shape[1]), [f'{value:g}' for value in lattice.columns])
    axes.set_yticks(range(shape[0]), [f'{value:g}' for value in lattice.lengths])
    axes.set_xlabel(lattice.across)
    axes.set_ylabel('warp length (m)')


def _legend(figure: Figure, lattices: Sequence[Lattice]) -> None:
    seen = {answer.verdict for lattice in lattices for answer in lattice.answers.values()}
    figure.legend(
        handles=[
            Patch(facecolor=colour, label=name)
            for kind, (colour, name) in VERDICT_STYLES.items()
            if kind in seen
        ],
        loc='outside lower center',
        ncols=3,
        frameon=False,
    )
