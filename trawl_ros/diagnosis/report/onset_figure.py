# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figure of a finding as it comes up in a watched tow."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.history import WatchedCourse
from trawl_ros.report.style import FAINT, MEASURED, NETTING, PORT, STARBOARD, quiet
from trawl_ros.report.style import SECOND as OTHER

MOST_DRAWN = 4
"""Channels whose innovations are drawn in colours: those that leave noise most after an onset."""

AFTER_S = 600.0
"""Time since the onset by which they are chosen."""

SIDES = {'port': PORT, 'starboard': STARBOARD}
OTHERS = (MEASURED, OTHER, NETTING, 'black')
"""Colours of channels of a side of the ship, and of all others in their order."""

STYLES = {'tension': '-', 'depth': '--', 'pitch': '-.', 'roll': ':'}
"""Line style of a channel by the end of its name; solid for all others."""


def onset_figure(
    course: WatchedCourse, findings: Sequence[Finding], limit: float, start_ns: int
) -> Figure:
    """Whitened innovations of a tow, and the rarest candidate's evidence, with what was found.

    Parameters
    ----------
    course
        Of the tow.
    findings
        As they are at last.
    limit
        Rarity beyond which a finding is raised.
    start_ns
        Time from which minutes are counted.
    """
    figure = Figure(figsize=(9.0, 5.6), layout='constrained')
    above, below = figure.subplots(2, sharex=True, height_ratios=(3, 2))
    minutes = (course.ends_ns - start_ns) / SECOND / 60.0
    shown = _most_changed(course, findings)
    for column in range(len(WATCHED)):
        if column not in shown:
            above.plot(minutes, course.innovations[:, column], color=FAINT, lw=0.6, alpha=0.6)
    others = iter(OTHERS)
    for column in shown:
        side, _, kind = WATCHED[column].partition('_')
        colour = SIDES.get(side) or next(others)
        above.plot(
            minutes, course.innovations[:, column], color=colour, lw=1.4,
            ls=STYLES.get(kind.rpartition('_')[2], '-') if side in SIDES else '-',
            label=WATCHED[column].replace('_', ' '),
        )  # fmt: skip
    above.set_ylabel('whitened innovation / std')
    below.plot(minutes, course.rarities, color=MEASURED, lw=1.4)
    below.axhline(limit, color='black', lw=0.8, ls='--')
    below.annotate(
        'limit', (minutes[0], limit), (2, 3), textcoords='offset points', fontsize='small'
    )
    below.set_ylabel('rarest candidate:\n−log₁₀ of its chance')
    below.set_xlabel('time / min')
    for axes in (above, below):
        quiet(axes)
        for found in findings:
            _mark(axes, found, start_ns)
    for found in findings:
        raised = (found.raised_ns - start_ns) / SECOND / 60.0
        name, delay = found.name.replace('_', ' '), found.delay_s / 60.0
        below.annotate(
            f'{name}, found {delay:.1f} min\nafter its onset',
            (raised, 0.97), (5, 0), xycoords=('data', 'axes fraction'),
            textcoords='offset points', va='top', fontsize='small',
        )  # fmt: skip
    handles, labels = above.get_legend_handles_labels()
    told = dict(zip(labels, handles, strict=True))
    figure.legend(told.values(), told.keys(), loc='outside upper center', ncols=5, frameon=False)
    return figure


def _most_changed(course: WatchedCourse, findings: Sequence[Finding]) -> list[int]:
    """Columns of the channels that leave what is usual the most after onsets."""
    inside = np.zeros(len(course.ends_ns), np.bool_)
    for found in findings:
        after = (course.ends_ns - found.onset_ns) / SECOND
        inside |= (after > 0.0) & (after <= AFTER_S)
    if not inside.any():
        inside[:] = True
    size = np.nansum(course.innovations[inside] ** 2, axis=0)
    return [int(column) for column in np.argsort(-size)[:MOST_DRAWN]]


def _mark(axes: Axes, found: Finding, start_ns: int) -> None:
    low, onset, high, raised = (
        (stamp - start_ns) / SECOND / 60.0
        for stamp in (found.onset_low_ns, found.onset_ns, found.onset_high_ns, found.raised_ns)
    )
    axes.axvspan(low, high, color=NETTING, alpha=0.25, lw=0.0, label='onset with its interval')
    axes.axvline(onset, color=NETTING, lw=1.2)
    axes.axvline(raised, color='black', lw=1.2, ls=':', label='finding raised')
