# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Order of convergence as the segments of a line become shorter."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.lab.report.panes import panes


def order(segments: Sequence[int], errors: Sequence[float]) -> float:
    """Return the order of convergence: logarithmic slope of the errors over segment length."""
    return -float(np.polyfit(np.log(segments), np.log(errors), 1)[0])


def refinement_figure(
    segments: Sequence[int], errors: Mapping[str, Sequence[float]], title: str
) -> Figure:
    """Draw relative errors over segments, both logarithmic, with a line of second order."""
    figure, (axes,) = panes(6.4, 4.6)
    for (label, values), mark in zip(errors.items(), 'osd^v', strict=False):
        axes.loglog(
            segments, values, mark + '-', label=f'{label}: order {order(segments, values):.2f}'
        )
    largest = max(values[0] for values in errors.values())
    count = np.asarray(segments, float)
    axes.loglog(count, 2.0 * largest * (count[0] / count) ** 2, 'k:', label='second order')
    axes.set(title=title, xlabel='segments', ylabel='relative error')
    axes.set_xticks(segments, [str(number) for number in segments], minor=False)
    axes.minorticks_off()
    axes.legend()
    return figure
