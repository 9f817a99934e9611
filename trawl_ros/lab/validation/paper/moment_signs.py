"""Readings of the signs of the moments beside the figures of section IV.C and IV.D."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.report.measured import MeasuredValue, at_least
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.paper.changes import Changes
from trawl_ros.lab.validation.paper.claims_of_installation import installation_claims
from trawl_ros.lab.validation.paper.claims_of_turned_boards import turned_board_claims
from trawl_ros.lab.validation.paper.sweeps import (
    FEW_LENGTHS,
    FEW_TURNS,
    SPEED,
    WARP_LENGTH,
    faster,
    installation_sweep,
    paper_model,
    warp_sweep,
)
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import outward_normal_lift
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.trim import trim

ATTACK, INCLINATION = np.radians(20.0), np.radians(14.0)
"""Angles at which every reading is trimmed, those of the gear file's points."""

SLOWEST, STRIDE = 1.0, 0.1
"""Speed (m/s) down to which a reading is towed, and the steps in which it is slowed down."""

WITHOUT = 'a4 = c4 = 0'
"""Name of the reading without C_x^M."""


@dataclass(frozen=True)
class SignReading:
    """Reading: its name, and the gear with it, not trimmed yet."""

    name: str
    model: GearModel


@dataclass(frozen=True)
class Judgement:
    """Judgement of a reading: checks of section IV that hold, of how many, those that do not; the
    slowest speed (m/s) at which the gear with it is usable, and why it was not judged at all.
    """

    name: str
    held: int
    checks: int
    missed: tuple[str, ...]
    slowest: float
    refusal: str


def run(small: bool) -> Findings:
    """Trim the gear anew with each reading, and evaluate the claims on its boards."""
    found = [judged(reading) for reading in readings(paper_model(small), few=small)]
    shipped, others = found[0], found[1:]
    best = max(others, key=lambda one: one.held)
    return Findings(
        (
            MeasuredValue(
                'checks of section IV.C and IV.D that hold with the signs of the gear file',
                float(shipped.held),
                target=at_least(float(best.held)),
                note=f'Of {shipped.checks}; the best of the other readings is {best.name}, with '
                f'{best.held}. Each is trimmed anew to α 20° and δ 14°.',
                key='shipped',
            ),
        ),
        tables=(_table(found),),
        text=(
            'The paper leaves the signs of the moments C_x^M, C_y^M, C_z^M open. Each reading is '
            f'trimmed to the same angles at {WARP_LENGTH:g} m and {SPEED:g} m/s, its boards are '
            'turned by ±5° of ε, ζ and η, and its warps veered from 200 to 900 m; the checks are '
            'those of `trawl validate sentences` and `warp_sweep` on them.'
        ),
    )


def readings(model: GearModel, *, few: bool = False) -> Iterator[SignReading]:
    """All signs, those of the gear file first, and the boards without C_x^M; ``few`` takes three
    of them.
    """
    shipped = tuple(model.board.moment_signs)
    signs = [shipped, *(one for one in product((1.0, -1.0), repeat=3) if one != shipped)]
    for one in signs[:2] if few else signs:
        name = ', '.join('+' if sign > 0 else '−' for sign in one)
        yield SignReading(f'({name})', model.with_board(moment_signs=one))
    values = model.coefficients.copy()
    values[[COEFFICIENTS.index(name) for name in ('a4', 'c4')]] = 0.0
    yield SignReading(WITHOUT, model.with_coefficients(values))


def judged(reading: SignReading) -> Judgement:
    """Trim a reading and evaluate the claims; a state that is refused ends it."""
    try:
        trimmed = trim(
            reading.model,
            attack=float(ATTACK),
            inclination=float(INCLINATION),
            warp_length=WARP_LENGTH,
            speed=SPEED,
        )
    except NoSteadyState as refusal:
        return Judgement(reading.name, 0, 0, (), np.nan, f'not trimmed: {refusal}')
    model = trimmed.model
    slowest = slowest_usable(model)
    try:
        checks = [*_turned(model), *_veered(model)]
    except NoSteadyState as refusal:
        return Judgement(reading.name, 0, 0, (), slowest, str(refusal))
    missed = tuple(check.key for check in checks if not check.ok)
    return Judgement(reading.name, len(checks) - len(missed), len(checks), missed, slowest, '')


def slowest_usable(model: GearModel) -> float:
    """Speed (m/s) down to which the steady state is usable without a gap."""
    speed, start = SPEED, None
    while speed > SLOWEST - 0.5 * STRIDE:
        try:
            start = steady_state(
                model, WARP_LENGTH, speed, start=None if start is None else start.equilibrium
            )
        except NoSteadyState:
            break
        speed = round(speed - STRIDE, 3)
    return speed + STRIDE


def _turned(model: GearModel) -> Iterator[MeasuredValue]:
    """Checks of the claims on turned boards."""
    changes = Changes(installation_sweep(model, FEW_TURNS), faster(model))
    for claim in (*installation_claims(changes), *turned_board_claims(changes)):
        yield from claim.checks


def _veered(model: GearModel) -> Iterator[MeasuredValue]:
    """Checks of α, δ and the outward normal over warp length."""
    sweep = warp_sweep(model, FEW_LENGTHS, SPEED)
    for angle in ('attack', 'inclination'):
        values = [getattr(steady.observables, f'port_{angle}') for steady in sweep]
        growth = float(np.degrees(np.diff(values).min()))
        yield MeasuredValue('', growth, '°', at_least(0.0), key=f'{angle}_grows')
    normal = min(float(outward_normal_lift(one.equilibrium.state).min()) for one in sweep)
    yield MeasuredValue('', normal, target=at_least(0.0), key='normal_up')


def _table(found: list[Judgement]) -> TextTable:
    rows = []
    for one in found:
        held = f'{one.held} of {one.checks}' if one.checks else 'none'
        slowest = '' if np.isnan(one.slowest) else f'{one.slowest:.1f} m/s'
        rows.append((one.name, held, slowest, one.refusal or ', '.join(one.missed)))
    head = ('signs', 'checks that hold', 'usable down to', 'not held, or why not judged')
    return TextTable('Readings of the signs of the moments', head, tuple(rows))


CASE = ValidationCase('moment_signs', 'Signs of the moments, with section IV as the judge', run)
