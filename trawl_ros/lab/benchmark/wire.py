# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Speed of one towed wire through a manoeuvre, here and in MoorDyn, at steps of equal error."""

import math
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from statistics import median

from trawl_ros.lab.reference_codes.absent import PeerAbsent, PeerFailed
from trawl_ros.lab.reference_codes.manoeuvre import (
    History,
    WireManoeuvre,
    apart,
    haul_and_turn,
    short_manoeuvre,
)
from trawl_ros.lab.reference_codes.moordyn_wire import MoorDynWire
from trawl_ros.lab.reference_codes.own_wire import own_history, own_model, own_steady
from trawl_ros.lab.reference_codes.towed_wire import INTEGRATED, WIRE, TowedWire
from trawl_ros.lab.report.measured import MeasuredValue, at_least
from trawl_ros.lab.report.page import Findings
from trawl_ros.solver.stepper import StepFailed

SEGMENTS = 20

OVER_MOORDYN = 1.5

MAX_ERROR_SHARE = 0.01
"""Largest error of depth and tension at any time, against the program's own converged run."""

OWN_CONVERGED = 0.1
OWN_STEPS = (4.0, 3.0, 2.5, 2.0, 1.5, 1.0, 0.5)
"""Steps (s) to try, from long to short."""

CONVERGED = ('RK4', 0.002)

COUPLING_S = 0.2
"""Time (s) of uniform motion of the block in MoorDyn: exact, with few calls."""

SETTLING_S = 200.0


@dataclass(frozen=True)
class SchemeChoice:
    """Scheme of MoorDyn with the settings that allow its longest steps.

    ``damping_time`` (s) is the internal damping of the wire that allows them. ``steps`` (s) are the
    steps to try, from long to short.
    """

    scheme: str
    damping_time: float
    steps: tuple[float, ...]


CHOICES = (
    SchemeChoice('Euler', 0.006, (0.008, 0.007, 0.006, 0.005, 0.004)),
    SchemeChoice('RK2', 0.004, (0.008, 0.007, 0.006, 0.005, 0.004)),
    SchemeChoice('RK4', 0.002, (0.010, 0.009, 0.008, 0.007, 0.006)),
)
"""Tested schemes of MoorDyn.

Of its other schemes, Heun's is unstable from 3 ms on. The implicit ones converge only at steps that
make them slower, and the multistep ones break down.
"""


@dataclass(frozen=True)
class Fastest:
    """Longest step (s) within the error limit, with its error and its speed in times real time."""

    step: float
    error: float
    factor: float


Run = Callable[[float], History]
"""Function that runs the manoeuvre with a step size, s."""


def measure(quick: bool) -> Findings:
    """Find the longest step within the error limit, here and for each scheme of MoorDyn."""
    manoeuvre = short_manoeuvre() if quick else haul_and_turn()
    ours = fastest(*_own(manoeuvre), quick=quick)
    rows = [_own_row(ours)]
    try:
        theirs = [(choice, _peer(choice, manoeuvre, quick=quick)) for choice in _choices(quick)]
    except PeerAbsent as absent:
        return Findings(
            (*rows, MeasuredValue('the same in MoorDyn', math.nan, '× real time', note=str(absent)))
        )
    found = [(choice, one) for choice, one in theirs if one is not None]
    for choice, one in found:
        note = (
            f'steps of {1e3 * one.step:g} ms, error {one.error:.2%}; inner damping EA · '
            f'{choice.damping_time:g} s'
        )
        rows.append(
            MeasuredValue(
                f'the same in MoorDyn by {choice.scheme}', one.factor, '× real time', note=note
            )
        )
    rows.append(_ratio(ours, [one for _, one in found]))
    return Findings(
        tuple(rows),
        text=f'{WIRE.length:g} m of wire with a lump, {SEGMENTS} segments, for '
        f'{manoeuvre.duration:g} s: hauling at 0.5 m/s, then a turn at 0.5°/s and '
        f'{WIRE.speed:g} m/s. Each program at the longest step at which depth and tension stay '
        f'within {MAX_ERROR_SHARE:.0%} of its own converged run at any time; CPU time, '
        'median of repeats. '
        'MoorDyn may damp the wire as each of its schemes likes it best; the implicit method '
        'here has no use for that.',
    )


def fastest(run: Run, steps: Sequence[float], converged: History, *, quick: bool) -> Fastest | None:
    """Return the longest step, from long to short, within the limit; None if there is none."""
    for step in steps:
        try:
            first = run(step)
        except (PeerFailed, StepFailed):
            continue
        error = apart(first, converged).largest
        if error < MAX_ERROR_SHARE:
            again = [run(step) for _ in range(0 if quick else 4)]
            return Fastest(step, error, median(one.factor for one in (first, *again)))
    return None


def _own(manoeuvre: WireManoeuvre) -> tuple[Run, Sequence[float], History]:
    model = own_model(WIRE, SEGMENTS)
    start, _ = own_steady(WIRE, model)

    def run(step: float) -> History:
        return own_history(model, start, manoeuvre, step)

    return run, OWN_STEPS, run(OWN_CONVERGED)


def _choices(quick: bool) -> tuple[SchemeChoice, ...]:
    return CHOICES[:1] if quick else CHOICES


def _peer(choice: SchemeChoice, manoeuvre: WireManoeuvre, *, quick: bool) -> Fastest | None:
    wire = replace(WIRE, damping_time=choice.damping_time)

    def run(step: float) -> History:
        return moordyn_history(wire, choice.scheme, step, manoeuvre)

    converged = moordyn_history(wire, *CONVERGED, manoeuvre)
    return fastest(run, choice.steps, converged, quick=quick)


def moordyn_history(wire: TowedWire, scheme: str, step: float, manoeuvre: WireManoeuvre) -> History:
    """Run the manoeuvre in MoorDyn after a straight tow.

    Raises
    ------
    PeerAbsent
        If MoorDyn is not installed.
    PeerFailed
        If MoorDyn breaks down.
    """
    lump = (INTEGRATED.lag, INTEGRATED.depth)
    with closing(MoorDynWire(wire, SEGMENTS, scheme, step, lump, coupling=COUPLING_S)) as system:
        system.settle(SETTLING_S)
        return system.follow(manoeuvre)


def _own_row(ours: Fastest | None) -> MeasuredValue:
    what = 'one wire of 600 m in 20 segments, hauling and turning'
    if ours is None:
        note = f'no step of those tried keeps the error below {MAX_ERROR_SHARE:.0%}'
        return MeasuredValue(what, math.nan, '× real time', note=note)
    each = 1e3 * ours.step / ours.factor
    note = f'steps of {ours.step:g} s, error {ours.error:.2%}; {each:.2f} ms per step'
    return MeasuredValue(what, ours.factor, '× real time', note=note)


def _ratio(ours: Fastest | None, theirs: Sequence[Fastest]) -> MeasuredValue:
    what = "the same compared with MoorDyn's best stable scheme"
    if ours is None or not theirs:
        return MeasuredValue(
            what, math.nan, '×', at_least(OVER_MOORDYN), 'one of the two has no step that is good'
        )
    ratio = ours.factor / max(one.factor for one in theirs)
    note = ''
    if ratio < OVER_MOORDYN:
        note = (
            f'a step takes {1e3 * ours.step / ours.factor:.2f} ms here, most of it Python around '
            'compiled loops over twenty bars: two evaluations of the forces, with two boards that '
            'the wire has not, the mass, and a third of a factorisation; MoorDyn has the wire alone'
        )
    return MeasuredValue(what, ratio, '×', at_least(OVER_MOORDYN), note)
