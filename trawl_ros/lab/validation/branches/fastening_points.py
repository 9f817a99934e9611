"""Fastening points moved forward: calmer at the trimmed length, but with folds on short warps."""

from collections.abc import Iterator

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.measured import MeasuredValue, at_most, within
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.validation.branches.branch_limits import (
    MIDDLE,
    BranchCurve,
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

FORWARD = 1.16, -0.38
"""Start of the trim of the moved warp point: x forward and y outward, m."""

ATTACK, INCLINATION = np.radians(20.0), np.radians(14.0)
"""Angles of both trims."""

SPEEDS = 2.3, 2.2, 2.1, 2.0, 1.9, 1.8
SHORT = 200.0, 300.0
"""Warp lengths (m) on which branches are looked at for folds."""

POINTS = 40
"""Points along a branch."""


def run(small: bool) -> Findings:
    """Trim the gear with its warp point farther forward, and compare."""
    gear = load_gear('kaifuha')
    if small:
        netting = gear.netting.model_copy(update={'around': 12})
        gear = gear.model_copy(update={'netting': netting})
    shipped = build_model(gear)
    moved = moved_forward(shipped)
    leans = {'shipped': leaned(shipped), 'moved forward': leaned(moved)}
    swing = {name: float(np.ptp([lean for lean, _ in row])) for name, row in leans.items()}
    curves = [
        followed_branch(sweep, POINTS)
        for sweep in sweeps(moved, SHORT[:1] if small else SHORT, angles=False)
    ]
    folds = [fold for curve in curves for fold in _folds(curve)]
    return Findings(
        (
            MeasuredValue(
                f'range of δ from {SPEEDS[-1]:g} to {SPEEDS[0]:g} m/s at {MIDDLE:g} m of warp, '
                'warp point moved forward',
                swing['moved forward'],
                '°',
                at_most(swing['shipped']),
                'Set against that of the shipped points.',
                key='swing',
            ),
            MeasuredValue(
                'folds of the branches over speed on '
                f'{" and ".join(f"{length:g}" for length in SHORT)} m of warp, warp point moved '
                'forward',
                float(len(folds)),
                target=within(0.0, of=0.0),
                note=f'{"; ".join(folds) or "none"}. This is why the shipped points stay.',
                key='folds',
            ),
        ),
        tables=(_table(leans),),
        text=(
            'The paper does not print the fastening points. The warp point is moved from '
            f'{_point(shipped)} to {_point(moved)} m (x forward, y outward), and the bridles along '
            'with it, by a trim to the same α of 20° and δ of 14°.'
        ),
    )


def moved_forward(model: GearModel) -> GearModel:
    """The gear with its warp point forward, and all points trimmed along."""
    points = model.board.points.copy()
    points[0, :2] = FORWARD
    return trim(
        model.with_board(points=points),
        attack=float(ATTACK),
        inclination=float(INCLINATION),
        warp_length=MIDDLE,
        speed=SPEED,
    ).model


def leaned(model: GearModel) -> list[tuple[float, bool]]:
    """δ (°) of the states at all speeds, and whether each is usable."""
    found: list[tuple[float, bool]] = []
    state = None
    for speed in SPEEDS:
        state = find_equilibrium(model, OperatingPoint(MIDDLE, MIDDLE, speed), state)
        try:
            require_usable(model, state)
            usable = True
        except NoSteadyState:
            usable = False
        found.append((float(np.degrees(state.observables.port_inclination)), usable))
    return found


def _folds(curve: BranchCurve) -> Iterator[str]:
    for limit in limits(curve):
        if limit.kind == 'fold':
            yield f'{curve.sweep.name}: at {limit.value:.2f} m/s with δ {limit.inclination:.0f}°'


def _point(model: GearModel) -> str:
    x, y, _ = model.board.points[0]
    return f'({x:.2f}, {y:.2f})'


def _table(leans: dict[str, list[tuple[float, bool]]]) -> TextTable:
    rows = tuple(
        (name, *(f'{lean:.1f}°' if usable else f'{lean:.1f}° (unusable)' for lean, usable in row))
        for name, row in leans.items()
    )
    head = ('points', *(f'{speed:g} m/s' for speed in SPEEDS))
    return TextTable(f'δ at {MIDDLE:g} m of warp over speed', head, rows)


CASE = ValidationCase(
    'fastening_points', 'Fastening points moved forward: calmer, but with folds', run
)
