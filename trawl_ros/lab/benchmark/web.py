# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Speed of MoorDyn on a web as large as the gear, at its largest stable step."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from statistics import median

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.reference_codes.absent import PeerAbsent, PeerFailed
from trawl_ros.lab.reference_codes.moordyn_web import Web, towed, web_of
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Findings
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint

POINT = OperatingPoint(500.0, 500.0, 2.1)

CHOICES = (('Euler', 0.8), ('RK2', 0.8), ('RK4', 0.1))
"""Schemes of MoorDyn, with the internal damping (share of critical) for the longest stable steps.

Its local, multistep and implicit schemes are slower or unstable on such a web.
"""

COARSE_AROUND = 12
"""Meshes around the net of the smaller web."""

SHARES = tuple(1.8 / 1.12**k for k in range(14))
"""Steps to try, from long to short, as shares of the web's own limit."""

SAFE_SHARE = 0.5
"""Step of the reference, by RK4, as a share of that limit."""

FORCE_SHARE = 0.01
"""Largest deviation of the door's forces from the reference that counts as stable."""


@dataclass(frozen=True)
class Stable:
    """Largest stable step (s) of a scheme and its speed over real time."""

    scheme: str
    damping: float
    step: float
    factor: float


def moordyn_web_factor(quick: bool) -> float:
    """Speed of MoorDyn in times real time, on a web of as many lines and points as the gear.

    The doors are prescribed. MoorDyn runs its best scheme at the largest stable step.

    Raises
    ------
    PeerAbsent
        If MoorDyn is not installed.
    PeerFailed
        If no scheme is stable.
    """
    _, found = _web(quick)
    return best_of(found).factor


def measure(quick: bool) -> Findings:
    """Find the largest stable step of each scheme, and time it.

    A scheme without a stable step among those tried has no row.
    """
    what = 'MoorDyn on a web of as many lines and points as the gear'
    try:
        model, found = _web(quick)
        best = best_of(found)
    except (PeerAbsent, PeerFailed) as error:
        return Findings((MeasuredValue(what, math.nan, '× real time', note=str(error)),))
    note = (
        f'{len(model.ends)} lines of one segment, {model.nodes} free points, doors and blocks '
        f'prescribed; {best.scheme} in steps of {1e3 * best.step:.2f} ms'
    )
    rows = [MeasuredValue(what, best.factor, '× real time', note=note)]
    for one in found:
        note = f'largest stable step {1e3 * one.step:.2f} ms, damping {one.damping:g} of critical'
        rows.append(
            MeasuredValue(f'the same by {one.scheme}', one.factor, '× real time', note=note)
        )
    if not quick:
        rows.append(_smaller(best.scheme, best.damping))
    return Findings(
        tuple(rows),
        text='Bars of the gear are lines of one segment with their mass, stiffness, drag and '
        'added mass, nodes are free points with knots, floats and weights; the kite is left out, '
        'and the fastening points of the doors move straight on, where the gear solves two '
        'boards in 6-DOF. The web starts under way in the steady state of the gear. A step is '
        f'stable when the forces on doors and blocks stay within {FORCE_SHARE:.0%} of a run in '
        'short steps; inner damping is what lets each scheme take long ones.',
    )


def _smaller(scheme: str, damping: float) -> MeasuredValue:
    model = build_model(default_gear(quick=False).changed('netting', around=COARSE_AROUND))
    found = best_of(_stable(model, ((scheme, damping),), quick=False))
    note = f'a net of {COARSE_AROUND} meshes around, {len(model.ends)} lines, {model.nodes} points'
    return MeasuredValue('the same on a smaller web', found.factor, '× real time', note=note)


def best_of(found: tuple[Stable, ...]) -> Stable:
    """Return the fastest scheme.

    Raises
    ------
    PeerFailed
        If there is none.
    """
    if not found:
        raise PeerFailed('MoorDyn: no scheme is stable on the web at any step that was tried')
    return max(found, key=lambda one: one.factor)


@cache
def _web(quick: bool) -> tuple[GearModel, tuple[Stable, ...]]:
    model = build_model(default_gear(quick=quick))
    return model, _stable(model, CHOICES[:1] if quick else CHOICES, quick=quick)


def _stable(
    model: GearModel, choices: tuple[tuple[str, float], ...], *, quick: bool
) -> tuple[Stable, ...]:
    start = find_equilibrium(model, POINT)
    duration, repeats = (0.5, 1) if quick else (1.5, 3)
    found = (
        largest_stable(model, start, scheme, damping, duration, repeats)
        for scheme, damping in choices
    )
    return tuple(one for one in found if one is not None)


def largest_stable(
    model: GearModel,
    start: Equilibrium,
    scheme: str,
    damping: float,
    duration: float,
    repeats: int,
) -> Stable | None:
    """Search steps from long to short for the largest stable one; None when all are unstable."""
    web = web_of(model, start.state, start.tow, damping)
    limit = explicit_limit(model, start)
    reference, _ = towed(web, 'RK4', SAFE_SHARE * limit, duration)
    for share in SHARES:
        runs = list(_stable_runs(web, scheme, share * limit, duration, repeats, reference[-1]))
        if len(runs) == repeats:
            return Stable(scheme, damping, share * limit, median(runs))
    return None


def _stable_runs(
    web: Web, scheme: str, step: float, duration: float, repeats: int, reference: FloatArray
) -> Iterator[float]:
    """Yield the factors of runs, until one is unstable."""
    for _ in range(repeats):
        try:
            forces, seconds = towed(web, scheme, step, duration)
        except PeerFailed:
            return
        late = forces[-len(forces) // 4 :]
        off = np.linalg.norm(late - reference, axis=2) / np.linalg.norm(reference, axis=1)
        if not off.max() < FORCE_SHARE:
            return
        yield len(forces) * step / seconds


def explicit_limit(model: GearModel, start: Equilibrium) -> float:
    """Stability limit (s) of explicit steps: 2/ω, with ω² twice the largest stiffness over mass."""
    tow = start.tow
    side = np.maximum(model.warp_side, 0)
    rest = np.where(model.warp_side >= 0, tow.lengths[side] / model.warp_segments, model.rest)
    stiffness, mass = np.zeros(model.nodes), model.lump_mass.copy()
    for end in model.ends.T:
        free = end < model.nodes
        np.add.at(stiffness, end[free], (model.bars.stiffness / rest)[free])
        np.add.at(mass, end[free], (0.5 * model.bars.mass * rest)[free])
    return float(2.0 / np.sqrt((2.0 * stiffness / mass).max()))
