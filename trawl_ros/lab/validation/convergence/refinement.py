# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Mesh convergence of the default gear: warp, bridles, net, and all of them refined."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.convergence.time_step import BOWING_PRESSURE_PA
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.report.pictures import Drawing
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

SPEED = 2.1
"""Speed through the water, m/s."""

MAX_LENGTH_RATIO = 1.15
"""Largest ratio of warp lengths between a state and its start."""

AROUND_ZERO = ('pitch', 'slip')
"""Angles that can be near zero: pitch changes sign with growing warp length."""

REFERENCE = np.radians(30.0)
"""Reference for differences of these angles: 30°, the upper end of Fig. 5 of the paper."""

ALLOWED_CHANGE_PERCENT = 2.0
"""Largest difference from the finer gear, %."""

FINER: Mapping[str, dict[str, Any]] = {
    'warp': {'warp': 2},
    'bridle': {'bridle': 2},
    'joins': {'unjoined': True},
    'net': {'net': 1.5},
    'all': {'warp': 2, 'bridle': 2, 'net': 1.5},
}
"""Refinements of gears. With half as many meshes again the default net has more around its mouth
than the real one."""

WORDS: Mapping[str, str] = {
    'warp': 'twice the warp segments',
    'bridle': 'twice the bridle segments',
    'joins': 'no meshes joined toward the codend',
    'net': 'half as many meshes again around and along the net',
    'all': 'twice the warp and bridle segments and half as many meshes again',
}

SERIES = 12, 24, 36, 48
"""Numerical meshes around the net in the drawn series."""

DRAWN = (
    'door_spread',
    'port_door_depth',
    'port_tension',
    'net_depth',
    'vertical_opening',
    'horizontal_opening',
    'port_attack',
    'port_inclination',
)

TICKS = -50, -20, -10, -5, -2, -1, 0, 1, 2, 5, 10, 20, 50


@dataclass(frozen=True)
class RefinementRow:
    """Observables (lengths, observables) of one gear; NaN for lengths without a steady state."""

    name: str
    nodes: int
    seen: FloatArray


def row(name: str, gear: GearRecord, lengths: tuple[float, ...]) -> RefinementRow:
    """Solve one gear at all warp lengths, from the middle one outward."""
    model = build_model(gear)
    seen = np.full((len(lengths), len(OBSERVABLES)), np.nan)
    middle = len(lengths) // 2
    first = _solved(model, lengths[middle], None)
    for k in sorted(range(len(lengths)), key=lambda k: abs(k - middle)):
        found = first
        # A fine net follows small changes of length more surely than it settles again.
        count = int(np.ceil(abs(np.log(lengths[k] / lengths[middle])) / np.log(MAX_LENGTH_RATIO)))
        for length in np.geomspace(lengths[middle], lengths[k], count + 1)[1:]:
            found = _solved(model, float(length), found) if found is not None else None
        found = found or _solved(model, lengths[k], None)
        if found is not None:
            seen[k] = found.observables.array()
    return RefinementRow(name, model.nodes, seen)


def _solved(model: GearModel, length: float, start: Equilibrium | None) -> Equilibrium | None:
    try:
        return find_equilibrium(model, OperatingPoint(length, length, SPEED), start)
    except NoSteadyState:
        return None


def differences(seen: FloatArray, fine: FloatArray) -> FloatArray:
    """Differences from the finer gear, as shares of its value.

    Angles around zero are compared with `REFERENCE` instead. The last axis of each array runs over
    the observables.
    """
    around = np.array([name.endswith(AROUND_ZERO) for name in OBSERVABLES])
    return (seen - fine) / np.where(around, REFERENCE, np.abs(fine))


def run(quick: bool) -> Findings:
    """Solve all gears and compare."""
    lengths = (500.0,) if quick else (200.0, 500.0, 900.0)
    gear = load_gear('kaifuha')
    if quick:
        gear = gear.changed('netting', around=12)
    default = row('default', gear, lengths)
    finer = [row(name, gear.refined(**factors), lengths) for name, factors in FINER.items()]
    own = gear.netting.around
    more = gear.refined(**FINER['net']).netting.around
    counts = [] if quick else [count for count in SERIES if count not in (own, more)]
    series = {
        count: row(str(count), gear.changed('netting', around=count), lengths) for count in counts
    }
    series[own] = default
    series[more] = next(one for one in finer if one.name == 'net')
    bowed_rows, bowed_table = bowed_nets(gear, (own, more) if quick else BOWED_MESHES_AROUND)
    return Findings(
        rows=(*_checks(default, finer, lengths, series), *bowed_rows),
        drawings=(
            Drawing(
                'net',
                'Observables over the numerical meshes around the net, as their difference from '
                'the finest: linear within the band of 2 %, logarithmic beyond. The dotted line '
                'marks the default.',
                _figure(series, lengths, own),
            ),
        ),
        tables=(*_tables(default, finer[-1], lengths), bowed_table),
        text=(
            f'The default gear at {SPEED:g} m/s compared with the same gear with warps, bridles '
            'and net cut more finely, one at a time and together: warps and bridles twice, the net '
            f'with half as many meshes again, {more} around its mouth, where the real net has 68. '
            'Differences are shares of the finer value; pitch and slip, which have no natural size '
            'since they may be zero, are set '
            f'against {np.degrees(REFERENCE):.0f}°.'
        ),
    )


def _checks(
    default: RefinementRow,
    finer: Sequence[RefinementRow],
    lengths: Sequence[float],
    series: Mapping[int, RefinementRow],
) -> Iterator[MeasuredValue]:
    """Return one check per refinement and warp length: the worst of all observables."""
    for fine in finer:
        for k, length in enumerate(lengths):
            shares = 100.0 * np.abs(differences(default.seen[k], fine.seen[k]))
            worst = int(np.argmax(np.where(np.isnan(shares), np.inf, shares)))
            name = OBSERVABLES[worst]
            note = f'It is {name}.'
            if np.isnan(shares[worst]):
                note = 'One of the two gears has no steady state here.'
            elif shares[worst] > ALLOWED_CHANGE_PERCENT:
                beyond = int((shares > ALLOWED_CHANGE_PERCENT).sum())
                note = (
                    f'It is {name}, {beyond} of {len(OBSERVABLES)} observables differ by more; '
                    + _reason(fine, worst, k, series)
                )
            yield MeasuredValue(
                f'largest difference of an observable from the gear with {WORDS[fine.name]}, '
                f'{length:g} m of warp',
                float(shares[worst]),
                '%',
                at_most(ALLOWED_CHANGE_PERCENT),
                note,
                key=f'{fine.name}_{length:g}',
            )


def _reason(fine: RefinementRow, worst: int, k: int, series: Mapping[int, RefinementRow]) -> str:
    """Return why an observable has not converged, by the series of nets."""
    if fine.name in ('warp', 'bridle'):
        return f'the {fine.name} is cut too coarsely for it.'
    counts = sorted(series)
    name = OBSERVABLES[worst]
    values = ', '.join(_value(name, series[count].seen[k, worst]) for count in counts)
    return (
        'the grouping of the netting has not settled for it: with '
        f'{", ".join(map(str, counts))} numerical meshes around it is {values}.'
    )


def _tables(
    default: RefinementRow, fine: RefinementRow, lengths: Sequence[float]
) -> Iterator[TextTable]:
    """Compare every observable with that of the gear with everything finer."""
    for k, length in enumerate(lengths):
        shares = 100.0 * differences(default.seen[k], fine.seen[k])
        plain = 100.0 * (default.seen[k] / fine.seen[k] - 1.0)
        rows = []
        for j, name in enumerate(OBSERVABLES):
            against = '30°' if name.endswith(AROUND_ZERO) else 'value'
            rows.append(
                (
                    name,
                    _value(name, default.seen[k, j]),
                    _value(name, fine.seen[k, j]),
                    f'{plain[j]:+.2f}',
                    against,
                    f'{shares[j]:+.2f}',
                )
            )
        head = ('observable', 'default', 'all finer', '% of value', 'set against', 'difference (%)')
        yield TextTable(f'{length:g} m of warp, {SPEED:g} m/s', head, tuple(rows))


def _value(name: str, value: float) -> str:
    """A value with its unit."""
    if name.endswith('tension'):
        return f'{value / 1000:.2f} kN'
    if name.endswith(('spread', 'depth', 'opening')):
        return f'{value:.2f} m'
    return f'{np.degrees(value):.2f}°'


def _figure(series: Mapping[int, RefinementRow], lengths: Sequence[float], own: int) -> Figure:
    counts = sorted(series)
    figure, panels = panes(4.2 * len(lengths) + 1.5, 4.6, 1, len(lengths), sharey=True)
    for k, (axes, length) in enumerate(zip(panels, lengths, strict=True)):
        shares = 100.0 * differences(
            np.array([series[count].seen[k] for count in counts]), series[counts[-1]].seen[k]
        )
        axes.axhspan(-ALLOWED_CHANGE_PERCENT, ALLOWED_CHANGE_PERCENT, color='0.92')
        axes.axvline(own, color='0.5', linestyle=':')
        for name in DRAWN:
            label = name.removeprefix('port_').replace('_', ' ')
            axes.plot(counts, shares[:, OBSERVABLES.index(name)], 'o-', markersize=4, label=label)
        axes.set_xticks(counts)
        axes.set_yscale('symlog', linthresh=ALLOWED_CHANGE_PERCENT)
        axes.set_yticks(TICKS, [f'{tick:g}' for tick in TICKS])
        axes.minorticks_off()
        axes.set(xlabel='numerical meshes around the net', title=f'{length:g} m of warp')
    panels[0].set_ylabel('difference from the finest net (%)')
    figure.legend(*panels[0].get_legend_handles_labels(), loc='outside right center', frameon=False)
    return figure


BOWED_WARP_M = 500.0
"""Warp length of the comparison of bowed with straight twine."""

BOWED_MESHES_AROUND = 36, 48, 60, 72, 96
"""Numbers of numerical meshes around the net of that comparison."""

BOWED_TOLERANCE_DEG = 0.5
"""Largest difference of an angle from that of the finest net."""

BOWED_TOLERANCE_PERCENT = 2.0
"""Largest difference of a length or tension from that of the finest net."""

ANGLES = 'port_attack', 'port_inclination', 'port_roll'
SHOWN = 'door_spread', 'port_door_depth', 'vertical_opening', 'warp_tension', *ANGLES
KINDS = {'straight': 0.0, 'bowed': BOWING_PRESSURE_PA}


def bowed_nets(
    gear: GearRecord, counts: Sequence[int] = BOWED_MESHES_AROUND
) -> tuple[list[MeasuredValue], TextTable]:
    """Solve the gear with all nets, cold, and compare the default net with the finest one."""
    seen = {
        kind: {
            count: _observed(gear.changed('netting', around=count, bowing_pressure_pa=pressure))
            for count in counts
        }
        for kind, pressure in KINDS.items()
    }
    return list(_bowed_checks(seen, gear.netting.around)), _table(seen)


def _observed(gear: GearRecord) -> FloatArray:
    """Observables of `SHOWN`; angles in degrees, tension in kN."""
    seen = find_equilibrium(
        build_model(gear), OperatingPoint(BOWED_WARP_M, BOWED_WARP_M, SPEED)
    ).observables
    values = np.array([getattr(seen, name) for name in SHOWN])
    values[-len(ANGLES) :] = np.degrees(values[-len(ANGLES) :])
    values[SHOWN.index('warp_tension')] /= 1000.0
    return values


def _bowed_checks(seen: dict[str, dict[int, FloatArray]], own: int) -> Iterator[MeasuredValue]:
    for kind, by_count in seen.items():
        finest = max(by_count)
        others = f'from the net of {finest} meshes around, twine {kind}, {BOWED_WARP_M:g} m of warp'
        off = {count: np.abs(values - by_count[finest]) for count, values in by_count.items()}
        shares = 100.0 * off[own][: -len(ANGLES)] / by_count[finest][: -len(ANGLES)]
        yield MeasuredValue(
            f'largest difference of spread, depth, opening or tension {others}',
            float(shares.max()),
            '%',
            at_most(BOWED_TOLERANCE_PERCENT),
            _series(by_count, int(shares.argmax())),
            key=f'sizes_{kind}',
        )
        worst = len(SHOWN) - len(ANGLES) + int(off[own][-len(ANGLES) :].argmax())
        enough = min(
            count for count in off if off[count][-len(ANGLES) :].max() <= BOWED_TOLERANCE_DEG
        )
        yield MeasuredValue(
            f'largest difference of α, δ or roll {others}',
            float(off[own][worst]),
            '°',
            at_most(BOWED_TOLERANCE_DEG),
            f'{_series(by_count, worst)} The fewest of these with all three within '
            f'{BOWED_TOLERANCE_DEG:g}°: {enough}.',
            key=f'angles_{kind}',
        )


def _series(by_count: dict[int, FloatArray], column: int) -> str:
    """Sentence with one observable over the meshes around."""
    values = ', '.join(f'{observed[column]:.2f}' for observed in by_count.values())
    counts = ', '.join(map(str, by_count))
    return f'{SHOWN[column]} with {counts} numerical meshes around is {values}.'


def _table(seen: dict[str, dict[int, FloatArray]]) -> TextTable:
    rows = [
        (kind, str(count), *(f'{value:.2f}' for value in values))
        for kind, by_count in seen.items()
        for count, values in by_count.items()
    ]
    head = ('twine', 'around', 'spread (m)', 'door depth (m)', 'opening (m)', 'tension (kN)')
    return TextTable(
        f'{BOWED_WARP_M:g} m of warp, {SPEED:g} m/s, over meshes around the net; bowed: '
        f'under {BOWING_PRESSURE_PA:g} Pa',
        (*head, 'α (°)', 'δ (°)', 'roll (°)'),
        tuple(rows),
    )


CASE = ValidationCase('refinement', 'The default gear compared with finer ones', run)
