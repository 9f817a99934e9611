# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Readings of the board's frame, compared by the states that can be towed and by section IV.

The model has one reading (docs/model.md). Another reading differs from it by the signs of some
printed coefficients. It is therefore the same board with these coefficients reversed, and with its
fastening points trimmed by the same search.
"""

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
    faster,
    installation_sweep,
    paper_model,
    warp_sweep,
)
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import outward_normal_lift
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.trimming.over_range import trim_over_range


@dataclass(frozen=True)
class Rigging:
    """Search by which each reading is rigged, and the places at which it is then towed.

    Attributes
    ----------
    attack, inclination
        Wanted angles, rad.
    warps, speeds
        Operating points of the search, m and m/s.
    towed_warps, towed_speeds
        Operating points that are counted, m and m/s.
    """

    attack: float = np.radians(20.0)
    inclination: float = np.radians(12.0)
    warps: tuple[float, ...] = (150.0, 370.0, 900.0)
    speeds: tuple[float, ...] = (1.6, 2.1, 2.7)
    towed_warps: tuple[float, ...] = (150.0, 300.0, 450.0, 600.0, 750.0, 900.0, 1000.0)
    towed_speeds: tuple[float, ...] = (1.5, 1.7, 1.9, 2.1, 2.3, 2.5, 2.8)


FEW = Rigging(warps=(300.0, 900.0), speeds=(2.1,), towed_warps=(300.0, 900.0), towed_speeds=(2.1,))

READINGS = {
    'aft, outward, down': (),
    'of 0.1: moments −, +, +, slip reversed': ('c3', 'b5', 'a6', 'c6'),
    'moments −, −, −, slip reversed': ('c3', 'c5'),
    'C_z upward': ('b3', 'c3'),
    'outward normal down with α': ('a4', 'c4'),
    'pitch moment reversed': ('b5', 'c5'),
}
"""Reading → coefficients that have the other sign than in the model's."""


@dataclass(frozen=True)
class Judgement:
    """Judgement of a reading.

    Attributes
    ----------
    name
        Of the reading.
    usable, places
        Places with a usable steady state, of how many.
    held, checks
        Checks of section IV that hold, of how many; zero where they could not be made.
    missed
        Keys of those that do not hold.
    refusal
        Reason for which the checks could not be made, or ''.
    """

    name: str
    usable: int
    places: int
    held: int = 0
    checks: int = 0
    missed: tuple[str, ...] = ()
    refusal: str = ''


def run(quick: bool) -> Findings:
    """Trim the gear for each reading, tow it, and evaluate the claims on its boards."""
    rigging, model = FEW if quick else Rigging(), paper_model(True)
    names = list(READINGS)[:2] if quick else READINGS
    found = [judged(name, read_as(model, READINGS[name]), rigging) for name in names]
    own, others = found[0], found[1:]
    return Findings(
        (
            MeasuredValue(
                'places that can be towed with the reading of the model',
                float(own.usable),
                target=at_least(float(max(one.usable for one in others))),
                note=f'Of {own.places}; the target is the best of the other readings.',
                key='usable',
            ),
            MeasuredValue(
                'checks of section IV.C and IV.D that hold with it',
                float(own.held),
                target=at_least(float(max(one.held for one in others))),
                note=f'Of {own.checks}; the target is the best of the other readings.',
                key='checks',
            ),
        ),
        tables=(_table(found),),
        text=(
            'The paper leaves the axes of the loads open. Each reading is rigged by the search of '
            '`trawl trim`, towed at all places of a grid of warps and speeds, turned by ±5° of ε, '
            'ζ and η, and veered from 200 to 900 m. The net is half as fine as the default gear '
            'has it.'
        ),
    )


def read_as(model: GearModel, reversed_names: tuple[str, ...]) -> GearModel:
    """The gear with the signs of some coefficients reversed."""
    values = model.coefficients.copy()
    values[[COEFFICIENTS.index(name) for name in reversed_names]] *= -1.0
    return model.with_coefficients(values)


def judged(name: str, model: GearModel, rigging: Rigging) -> Judgement:
    """Trim a reading, count the states that can be towed, and evaluate the claims."""
    places = list(product(rigging.towed_speeds, rigging.towed_warps))
    try:
        model = trim_over_range(
            model,
            attack=rigging.attack,
            inclination=rigging.inclination,
            warp_lengths=rigging.warps,
            speeds=rigging.speeds,
        ).model
    except NoSteadyState as refusal:
        return Judgement(name, 0, len(places), refusal=f'not rigged: {refusal}')
    usable = sum(_usable(model, warp, speed) for speed, warp in places)
    try:
        checks = [*_turned(model), *_veered(model)]
    except NoSteadyState as refusal:
        return Judgement(name, usable, len(places), refusal=str(refusal))
    missed = tuple(check.key for check in checks if not check.ok)
    return Judgement(name, usable, len(places), len(checks) - len(missed), len(checks), missed)


def _usable(model: GearModel, warp: float, speed: float) -> bool:
    try:
        steady_state(model, warp, speed)
    except NoSteadyState:
        return False
    return True


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
    rows = tuple(
        (
            one.name,
            ', '.join(READINGS[one.name]) or 'none',
            f'{one.usable} of {one.places}',
            f'{one.held} of {one.checks}' if one.checks else 'none',
            one.refusal or ', '.join(one.missed),
        )
        for one in found
    )
    head = ('loads', 'coefficients reversed', 'usable places', 'checks that hold', 'not held')
    return TextTable('Readings of the frame of the loads', head, rows)


CASE = ValidationCase(
    'board_frame', "Frame of the board's loads, with section IV as the judge", run
)
