# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fastening points moved forward: boards lean less with speed, until branches fold."""

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.measured import MeasuredValue, at_most, within
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.validation.branches.branch_limits import (
    MIDDLE,
    followed_branch,
    limits,
    sweeps,
)
from trawl_ros.lab.validation.branches.lattices import SPEED
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import find_equilibrium, require_usable
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.trim import trim

SHIFTS_FORWARD_M = 0.1, 0.2, 0.3
"""Shifts of the warp point forward of its default, before the trim."""

ATTACK, INCLINATION = np.radians(20.0), np.radians(14.0)
"""Angles of both trims."""

SPEEDS = 2.3, 2.2, 2.1, 2.0, 1.9, 1.8
SHORT = 200.0, 300.0
"""Warp lengths (m) on which branches are searched for folds."""

POINTS = 40
"""Number of points along a branch."""


def run(quick: bool) -> Findings:
    """Trim the gear with its warp point farther forward, and compare."""
    gear = load_gear('kaifuha')
    if quick:
        gear = gear.changed('netting', around=12)
    shipped = build_model(gear)
    leans = {'shipped': leaned(shipped)}
    rows = [_fold_row('shipped', 'shipped', _folds(shipped))]
    for shift in SHIFTS_FORWARD_M[::2] if quick else SHIFTS_FORWARD_M:
        name, moved = f'{shift:g} m forward', moved_forward(shipped, shift)
        leans[name] = leaned(moved)
        key = f'{100.0 * shift:.0f}_cm'
        rows += [_swing_row(name, key, leans), _fold_row(name, key, _folds(moved))]
    return Findings(
        tuple(rows),
        tables=(_table(leans),),
        text=(
            'The paper does not print the fastening points. The shipped ones fit a range of warps '
            'and speeds best. Here the warp point starts farther forward, and all points are '
            f'trimmed to α of 20° and δ of 14° at {MIDDLE:g} m and {SPEED:g} m/s.'
        ),
    )


def moved_forward(model: GearModel, shift_m: float) -> GearModel:
    """Return the gear with its warp point shifted forward, and all points trimmed from there."""
    points = model.board.points.copy()
    points[0, 0] += shift_m
    return trim(
        model.with_board(points=points),
        attack=float(ATTACK),
        inclination=float(INCLINATION),
        warp_length=MIDDLE,
        speed=SPEED,
    ).model


def leaned(model: GearModel) -> list[tuple[float, bool]]:
    """δ (°) of the states at all speeds, and whether each is usable; NaN without an equilibrium."""
    found: list[tuple[float, bool]] = []
    state = None
    for speed in SPEEDS:
        try:
            state = find_equilibrium(model, OperatingPoint(MIDDLE, MIDDLE, speed), state)
        except NoSteadyState:
            found.append((np.nan, False))
            continue
        try:
            require_usable(model, state)
            usable = True
        except NoSteadyState:
            usable = False
        found.append((float(np.degrees(state.observables.port_inclination)), usable))
    return found


def _swing_row(name: str, key: str, leans: dict[str, list[tuple[float, bool]]]) -> MeasuredValue:
    return MeasuredValue(
        f'range of δ from {SPEEDS[-1]:g} to {SPEEDS[0]:g} m/s at {MIDDLE:g} m of warp, {name}',
        _swing(leans[name]),
        '°',
        at_most(_swing(leans['shipped'])),
        'Compared with the range of the shipped points.',
        key=f'swing_{key}',
    )


def _fold_row(name: str, key: str, folds: list[str]) -> MeasuredValue:
    return MeasuredValue(
        'folds of the branches over speed on '
        f'{" and ".join(f"{length:g}" for length in SHORT)} m of warp, {name}',
        float(len(folds)),
        target=within(0.0, of=0.0),
        note=f'Boards fall over where a branch folds: {"; ".join(folds)}.' if folds else '',
        key=f'folds_{key}',
    )


def _swing(leans: list[tuple[float, bool]]) -> float:
    return float(np.ptp([lean for lean, _ in leans]))


def _folds(model: GearModel) -> list[str]:
    return [
        f'{sweep.name}: at {limit.value:.2f} m/s with δ {limit.inclination:.0f}°'
        for sweep in sweeps(model, SHORT, angles=False)
        for limit in limits(followed_branch(sweep, POINTS))
        if limit.kind == 'fold'
    ]


def _table(leans: dict[str, list[tuple[float, bool]]]) -> TextTable:
    rows = tuple((name, *(_cell(*one) for one in row)) for name, row in leans.items())
    head = ('points', *(f'{speed:g} m/s' for speed in SPEEDS))
    return TextTable(f'δ at {MIDDLE:g} m of warp over speed', head, rows)


def _cell(lean: float, usable: bool) -> str:
    if np.isnan(lean):
        return 'none'
    return f'{lean:.1f}°' if usable else f'{lean:.1f}° (unusable)'


CASE = ValidationCase('fastening_points', 'Fastening points moved forward', run)
