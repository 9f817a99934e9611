# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Empty figures of the lab's reports."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure


def panes(
    width: float,
    height: float,
    rows: int = 1,
    columns: int = 1,
    *,
    sharex: bool = False,
    sharey: bool = False,
) -> tuple[Figure, list[Axes]]:
    """Return a figure and its axes, row by row, with a faint grid.

    Parameters
    ----------
    width, height
        Size of the figure, inches.
    rows, columns
        Number of axes.
    sharex, sharey
        True for axes with one scale.
    """
    figure = Figure(figsize=(width, height), layout='constrained')
    grid = figure.subplots(rows, columns, squeeze=False, sharex=sharex, sharey=sharey)
    every: list[Axes] = grid.ravel().tolist()
    for axes in every:
        axes.grid(alpha=0.3)
    return figure, every
