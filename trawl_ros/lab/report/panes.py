# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Empty figures of the lab's reports."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure


def panes(
    width: float, height: float, rows: int = 1, columns: int = 1, **shared: Any
) -> tuple[Figure, list[Axes]]:
    """Return a figure and its axes, row by row, with a faint grid.

    Parameters
    ----------
    width, height
        Size of the figure, inches.
    rows, columns
        Number of axes.
    shared
        Further arguments of `matplotlib.figure.Figure.subplots`.
    """
    figure = Figure(figsize=(width, height), layout='constrained')
    every = figure.subplots(rows, columns, squeeze=False, **shared).ravel().tolist()
    for axes in every:
        axes.grid(alpha=0.3)
    return figure, every
