"""Report of a soak: JSON, Markdown and a figure."""

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.lab.report.machine import cpu_model, software
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Page, Section, write_page
from trawl_ros.lab.running.chain import CHAIN, CONSUMERS, Glance
from trawl_ros.lab.studies.soak.rows import MOST_GROWTH, WARM_SHARE, series, soak_rows
from trawl_ros.lab.studies.soak.study import SETTLE_S, Soak, SoakPlan
from trawl_ros.report.pictures import Drawing

REPORT = 'soak.md'


def write_soak(folder: Path, soak: Soak) -> list[MeasuredValue]:
    """Write ``soak.json``, ``.md``, ``.html`` and ``.png`` into a folder; return the rows."""
    plan = soak.plan
    page = Page(
        name='soak',
        title='A long tow through the graph',
        command=f'trawl study soak --hours {plan.hours:g} --gear {plan.gear} '
        f'--real-time-s {plan.real_time_s:g}{" --coarse" if plan.coarse else ""}',
        method=_method(plan),
    )
    caption = 'Memory, delay and pace over the tow; what is left out as warm-up is grey.'
    drawing = Drawing('soak', caption, soak_figure(soak.fast, plan.hours))
    return write_page(folder, page, [Section('The tow', soak_rows(soak))], [drawing])


def _method(plan: SoakPlan) -> str:
    """Method in sentences."""
    net = ', with a net of 12 meshes around' if plan.coarse else ''
    real = (
        f', and then for {plan.real_time_s:g} s in real time'
        f'{", with the gear as it is and" if plan.coarse else " with"} truth ten times a second'
    )
    versions = ', '.join(f'{name} {version}' for name, version in software().items())
    return (
        '`sim_node`, the instrument nodes and `bag_recorder`, each a process of its own, towed as '
        f'fast as they could ({plan.hours:g} h at sea{net}, truth {plan.truth_rate_hz:g} times a '
        f'second, warps hauled and veered by 20 m now and then){real if plan.real_time_s else ""}. '
        f'Growth is that after the first {100.0 * WARM_SHARE:g} % of the tow; in real time the '
        f'first {SETTLE_S:g} s do not count. On {os.cpu_count()} cores of {cpu_model()}, with '
        f'{versions}.'
    )


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
