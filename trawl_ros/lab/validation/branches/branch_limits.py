# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Limits along branches of a gear: folds, and points at which stability is lost."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.branches.lattices import ANGLES, SPEED
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe, outward_normal_lift
from trawl_ros.model.state import Tow
from trawl_ros.report.pictures import Drawing
from trawl_ros.solver.continuation import BranchPoint, Family, branch
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow
from trawl_ros.solver.stability import growing_mode, stability

WORKING = 1.9
"""Lowest towing speed of the gear, m/s."""

MIDDLE = 500.0
"""Warp length (m) of the branches over other parameters."""

LYING = np.sin(np.radians(80.0))
"""Vertical component of an outward normal at which following stops: the board lies flat."""

SWING = 0.01
"""Lowest frequency (rad/s) at which a loss of stability counts as a Hopf point."""


@dataclass(frozen=True)
class ParameterSweep:
    """A parameter to follow: its name and unit, start, scale and bounds."""

    name: str
    unit: str
    family: Family
    start: float
    scale: float
    low: float
    high: float


@dataclass(frozen=True)
class BranchCurve:
    """A branch: its points, attack angle and inclination (°), growth (1/s) and eigenvalue."""

    sweep: ParameterSweep
    points: list[BranchPoint]
    attack: FloatArray
    inclination: FloatArray
    worst: FloatArray

    @property
    def values(self) -> FloatArray:
        """The parameter at all points."""
        return np.array([here.value for here in self.points])


@dataclass(frozen=True)
class BranchLimit:
    """Limit on a branch: a fold, or a loss of stability with the part that moves."""

    kind: str
    value: float
    eigenvalue: complex
    mode: str
    attack: float
    inclination: float


def sweeps(model: GearModel, lengths: Sequence[float], angles: bool) -> Iterator[ParameterSweep]:
    """The branches to follow: over speed, warp length, and installation angles both ways."""
    for length in lengths:
        family = partial(_place, model, length)
        yield ParameterSweep(f'speed at {length:g} m', 'm/s', family, SPEED, -0.1, 1.4, 3.0)
    if not angles:
        return
    for sign in (-1.0, 1.0):
        name, family = f'warp length {"hauled" if sign < 0 else "veered"}', partial(_place, model)
        yield ParameterSweep(name, 'm', family, MIDDLE, sign * 50.0, 100.0, 1000.0)
    for index, angle in enumerate(ANGLES):
        family = partial(_turned, model, index)
        for sign in (-1.0, 1.0):
            name = f'{angle} {"<" if sign < 0 else ">"} 0'
            yield ParameterSweep(name, '°', family, 0.0, sign * 2.5, -20.0, 20.0)


def _place(model: GearModel, length: float, speed: float = SPEED) -> tuple[GearModel, Tow]:
    return model, steady_tow(model, OperatingPoint(length, length, speed))


def _turned(model: GearModel, index: int, degrees: float) -> tuple[GearModel, Tow]:
    installation = np.zeros(3)
    installation[index] = np.radians(degrees)
    turned = model.with_board(installation=tuple(installation))
    return _place(turned, MIDDLE)


def followed_branch(sweep: ParameterSweep, most: int) -> BranchCurve:
    """Follow a branch to its bounds, to a board that lies flat, or for ``most`` points."""
    model, tow = sweep.family(sweep.start)
    port, starboard = tow.lengths
    point = OperatingPoint(port, starboard, float(np.linalg.norm(tow.block_velocities[0])))
    start = find_equilibrium(model, point).state
    points = []
    for here in branch(sweep.family, sweep.start, start, scale=sweep.scale):
        points.append(here)
        flat = np.abs(outward_normal_lift(here.state)).max() > LYING
        if flat or not sweep.low <= here.value <= sweep.high or len(points) == most:
            break
    seen = [observe(here.model, here.state, here.tow) for here in points]
    worst = []
    for here in points:
        values = stability(here.model, here.state, here.tow).eigenvalues
        worst.append(values[np.argmax(values.real)])
    return BranchCurve(
        sweep,
        points,
        np.degrees([one.port_attack for one in seen]),
        np.degrees([one.port_inclination for one in seen]),
        np.array(worst),
    )


def limits(curve: BranchCurve) -> Iterator[BranchLimit]:
    """Folds and changes of stability along a branch."""
    values, growth = curve.values, curve.worst.real
    for k in range(1, len(values)):
        before, here = curve.points[k - 1], curve.points[k]
        if before.rate * here.rate < 0.0:
            share = before.rate / (before.rate - here.rate)
            yield _limit(curve, k, share, 'fold', curve.worst[k], '')
        if growth[k - 1] * growth[k] < 0.0:
            share = growth[k - 1] / (growth[k - 1] - growth[k])
            unstable = k if growth[k] > 0.0 else k - 1
            rate, there = curve.worst[unstable], curve.points[unstable]
            kind = 'Hopf' if abs(rate.imag) > SWING else 'real'
            mode = growing_mode(there.model, there.state, there.tow, rate)
            way = 'unstable' if unstable == k else 'stable again'
            yield _limit(curve, k, share, f'{way}, {kind}', rate, mode)


def _limit(
    curve: BranchCurve, k: int, share: float, kind: str, eigenvalue: complex, mode: str
) -> BranchLimit:
    def between(values: FloatArray) -> float:
        return float(values[k - 1] + share * (values[k] - values[k - 1]))

    return BranchLimit(
        kind,
        between(curve.values),
        eigenvalue,
        mode,
        between(curve.attack),
        between(curve.inclination),
    )


def limit_findings(model: GearModel, *, quick: bool) -> Findings:
    """Follow all branches of a gear and list their limits; ``quick`` follows part of one."""
    lengths = (MIDDLE,) if quick else (300.0, MIDDLE, 700.0)
    curves = [
        followed_branch(sweep, 20 if quick else 60) for sweep in sweeps(model, lengths, not quick)
    ]
    found = [(curve, list(limits(curve))) for curve in curves]
    return Findings(
        rows=tuple(_rows(found)),
        drawings=(
            Drawing(
                'limits',
                'Inclination of the boards along branches from 500 m and 2.1 m/s: solid where '
                'stable, dotted where not; circles are folds, crosses changes of stability.',
                _figure(found),
            ),
        ),
        tables=(_table(found),),
        text=(
            'Branches are followed by pseudo-arclength continuation too. A real '
            'eigenvalue that turns positive without a fold belongs to a motion of one board '
            'against the other, which a symmetric branch runs through.'
        ),
    )


def _rows(found: list[tuple[BranchCurve, list[BranchLimit]]]) -> Iterator[MeasuredValue]:
    """Rows on the speeds at which the branches over speed lose stability."""
    for curve, ends in found:
        if curve.sweep.unit != 'm/s':
            continue
        lost = [end for end in ends if end.kind.startswith('unstable')]
        length = curve.points[0].tow.lengths[0]
        yield MeasuredValue(
            f'speed below which the state at {length:g} m of warp is unstable',
            lost[0].value if lost else float(curve.values.min()),
            'm/s',
            at_most(WORKING),
            f'{lost[0].mode}.' if lost else 'Stable as far as it was followed.',
            key=f'unstable_{length:g}',
        )


def _table(found: list[tuple[BranchCurve, list[BranchLimit]]]) -> TextTable:
    rows = []
    for curve, ends in found:
        values, unit = curve.values, curve.sweep.unit
        reach = f'{values[0]:.4g} to {values[-1]:.4g} {unit}'
        for end in ends:
            rows.append(
                (
                    curve.sweep.name,
                    reach,
                    end.kind,
                    f'{end.value:.4g} {unit}',
                    f'{end.eigenvalue.real:+.2g} {abs(end.eigenvalue.imag):+.2g}i',
                    end.mode,
                    f'{end.attack:.1f}°',
                    f'{end.inclination:.1f}°',
                )
            )
        if not ends:
            rows.append((curve.sweep.name, reach, 'none', *5 * ('',)))
    head = ('branch', 'followed', 'limit', 'at', 'eigenvalue (1/s)', 'motion', 'α', 'δ')
    return TextTable('Limits of the branches', head, tuple(rows))


def _figure(found: list[tuple[BranchCurve, list[BranchLimit]]]) -> Figure:
    units = list(dict.fromkeys(curve.sweep.unit for curve, _ in found))
    figure, panels = panes(4.6 * len(units) + 1.0, 4.6, 1, len(units))
    for axes, unit in zip(panels, units, strict=True):
        for number, (curve, ends) in enumerate(one for one in found if one[0].sweep.unit == unit):
            stable = curve.worst.real < 0.0
            color = f'C{number}'
            whole, held = curve.inclination, np.where(stable, curve.inclination, np.nan)
            axes.plot(curve.values, whole, ':', color=color)
            axes.plot(curve.values, held, '-', color=color, label=curve.sweep.name)
            for end in ends:
                mark = 'o' if end.kind == 'fold' else 'x'
                axes.plot(end.value, end.inclination, mark, color=color)
        axes.set_xlabel({'m/s': 'speed (m/s)', 'm': 'warp (m)'}.get(unit, 'angle (°)'))
        axes.legend(fontsize='small')
    panels[0].set_ylabel('inclination δ (°)')
    return figure
