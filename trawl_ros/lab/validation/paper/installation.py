# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reproduction of Fig. 7 to 12: the gear with its boards turned against their rigging."""

from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.lab.report.measured import MeasuredValue, within
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.paper.sweeps import (
    FEW_TURNS,
    INSTALLATION,
    SPEED,
    TURN,
    TURNS,
    WARP_LENGTH,
    Sighting,
    installation_sweep,
    paper_model,
)
from trawl_ros.records.observables import Observables
from trawl_ros.report.pictures import Drawing

SYMBOLS = {'epsilon': 'ε', 'zeta': 'ζ', 'eta': 'η'}

PANELS: tuple[tuple[str, str, Callable[[Observables], float]], ...] = (
    ('Fig. 7', 'door spread [m]', lambda seen: seen.door_spread),
    ('Fig. 8', 'door depth [m]', lambda seen: seen.door_depth),
    ('Fig. 9', 'vertical opening [m]', lambda seen: seen.vertical_opening),
    ('Fig. 10', 'warp tension [kN]', lambda seen: seen.warp_tension / 1e3),
    ('Fig. 11', 'attack angle α [°]', lambda seen: float(np.degrees(seen.port_attack))),
    ('Fig. 12', 'inclination δ [°]', lambda seen: float(np.degrees(seen.port_inclination))),
)


def run(quick: bool) -> Findings:
    """Turn the boards of the default gear by up to 5° about each of their axes."""
    turns = FEW_TURNS if quick else TURNS
    found = installation_sweep(paper_model(quick), turns)
    checks = (
        MeasuredValue(
            'turned gears with a stable steady state under water, boards within their law',
            float(sum(len(row) for row in found.values())),
            target=within(0.0, of=float(len(turns) * len(INSTALLATION))),
            note='none is left out: a turn without one ends the case',
            key='states',
        ),
        *(_monotone(found, panel) for panel in PANELS),
    )
    where = f'{WARP_LENGTH:g} m of warp and {SPEED:g} m/s'
    caption = f'Fig. 7 to 12 remade, at {where}. ε, ζ, η turn the board about its z, y, x axes.'
    return Findings(
        checks,
        (Drawing('fig7_to_12', caption, _figure(found)),),
        (_table(found, f'Changes by turns of {TURN:g}°, at {where}.'),),
    )


def _monotone(
    found: Mapping[str, Mapping[float, Sighting]],
    panel: tuple[str, str, Callable[[Observables], float]],
) -> MeasuredValue:
    """Check that the curves are monotone between -5° and 5° of ε, as the paper's are."""
    name, label, read = panel
    values = np.array([read(one.seen) for one in found['epsilon'].values()])
    steps = np.diff(values)
    return MeasuredValue(
        f'{label.rpartition(" [")[0]}: part of its whole change with ε that goes one way',
        float(abs(steps.sum()) / np.abs(steps).sum()),
        target=within(1e-9, of=1.0),
        note=f'{name}: each turn has one direction of effect, as section IV.C speaks of it',
        key=f'monotone_{name[5:]}',
    )


def _figure(found: Mapping[str, Mapping[float, Sighting]]) -> Figure:
    figure, every = panes(11.0, 6.5, 2, 3)
    for axes, (name, label, read) in zip(every, PANELS, strict=True):
        for (angle, row), style in zip(found.items(), ('C0-o', 'C2:s', 'C3--^'), strict=True):
            values = [read(one.seen) for one in row.values()]
            axes.plot(list(row), values, style, ms=4, label=SYMBOLS[angle])
        axes.set_title(name, fontsize='medium')
        axes.set(xlabel='turn against the rigging [°]', ylabel=label)
        axes.legend(fontsize='small')
    return figure


def _table(found: Mapping[str, Mapping[float, Sighting]], caption: str) -> TextTable:
    rows = []
    for angle, row in found.items():
        base = row[0.0].seen
        for turn in (TURN, -TURN):
            cells = [f'{SYMBOLS[angle]} {turn:+g}°']
            for _, label, read in PANELS:
                change, before = read(row[turn].seen) - read(base), read(base)
                degrees = label.endswith('[°]')
                cells.append(f'{change:+.1f}°' if degrees else f'{100 * change / before:+.1f} %')
            rows.append(tuple(cells))
    head = ('turn', *(label.rpartition(' [')[0] for _, label, _ in PANELS))
    return TextTable(caption, head, tuple(rows))


CASE = ValidationCase('installation', 'Installation angles of the boards (Fig. 7 to 12)', run)
