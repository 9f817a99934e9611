"""Report of a soak: JSON, Markdown and a figure."""

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.files import write_figure, write_json, write_text
from trawl_ros.lab.report.machine import cpu_model, software
from trawl_ros.lab.report.row import StudyRow
from trawl_ros.lab.running.chain import CHAIN, CONSUMERS, Glance
from trawl_ros.lab.studies.soak.rows import MOST_GROWTH, WARM_SHARE, series, soak_rows
from trawl_ros.lab.studies.soak.study import SETTLE_S, Soak
from trawl_ros.report.rendering import DPI, page

JSON, REPORT, FIGURE = 'soak.json', 'soak.md', 'soak.png'


def write_soak(folder: Path, soak: Soak) -> list[StudyRow]:
    """Write ``soak.json``, ``soak.md`` and ``soak.png`` into a folder; return the rows."""
    rows = soak_rows(soak)
    records = [row.record() for row in rows]
    write_json(folder / JSON, {'rows': records}, indent=1, ensure_ascii=False)
    write_figure(folder / FIGURE, soak_figure(soak.fast, soak.plan.hours), DPI)
    text = page(
        'trawl_ros.lab.studies.soak',
        REPORT,
        rows=rows,
        asked=[row for row in rows if row.target is not None],
        plan=soak.plan,
        warm_share=WARM_SHARE,
        settle_s=SETTLE_S,
        cpu=cpu_model(),
        cores=os.cpu_count(),
        software=software(),
        figure=FIGURE,
    )  # fmt: skip
    write_text(folder / REPORT, text)
    return rows


PARTS = round(1.0 / WARM_SHARE)


def soak_figure(glances: Sequence[Glance], hours: float) -> Figure:
    """Draw memory, delay and pace of the chain's nodes over some hours of towing.

    Memory stands beside its mean after warm-up, which the legend gives.
    """
    figure = Figure(figsize=(8.0, 8.0), layout='constrained')
    memory, delay, pace = figure.subplots(3, 1, sharex=True)
    for number, node in enumerate(CHAIN):
        times, values = series(glances, lambda g: g.memory_mb, node)
        mean = float(np.mean(values[len(values) // PARTS :])) if values else np.nan
        label = f'{node}, {mean:.0f} MB'
        share = [100.0 * (value / mean - 1.0) for value in values]
        memory.plot(times, share, color=f'C{number}', label=label, linewidth=1.2)
        if node in CONSUMERS:
            times, values = series(glances, lambda g: g.delay_s, node)
            delay.plot(times, values, '.', color=f'C{number}', markersize=2.5)
    memory.set_ylabel('resident memory,\n% above its mean')
    low, high = memory.get_ylim()
    memory.set_ylim(min(low, -MOST_GROWTH), max(high, MOST_GROWTH))
    memory.legend(ncols=3, fontsize='small', loc='lower right')
    delay.set_ylabel('behind the truth,\ns at sea')
    delay.set_ylim(bottom=0.0)
    at_sea = np.array([g.data_s for g in glances])
    walls = np.array([g.wall_s for g in glances])
    if len(glances) > 1:
        middle = 0.5 * (at_sea[1:] + at_sea[:-1]) / 3600.0
        pace.plot(middle, np.diff(at_sea) / np.diff(walls), color='0.3', linewidth=0.8)
    pace.set_ylabel('times real time')
    pace.set_ylim(bottom=0.0)
    pace.set_xlabel('time at sea, h')
    for axes in (memory, delay, pace):
        axes.axvspan(0.0, WARM_SHARE * hours, color='0.93', zorder=0)
        axes.grid(color='0.9', linewidth=0.5)
        axes.spines[['top', 'right']].set_visible(False)
    return figure
