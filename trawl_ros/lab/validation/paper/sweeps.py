# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady states shared by the reproduced figures of section IV.

The paper prints neither speed nor warp length of Fig. 6 to 12. These are the values at which the
fastening points of the gear file were trimmed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.assembly import board_loads
from trawl_ros.model.board_laws import EQ14
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.observables import outward_normal_lift
from trawl_ros.records.observables import Observables
from trawl_ros.solver.equilibrium import SteadyState, steady_state

SPEED = 2.1
"""Speed through the water of Fig. 6 to 12, m/s."""

WARP_LENGTH = 500.0
"""Warp length of Fig. 7 to 12, m."""

LENGTHS = tuple(float(length) for length in range(200, 901, 50))
"""Warp lengths (m) of Fig. 6 and 13 to 16."""

FEW_LENGTHS = (200.0, 550.0, 900.0)

INSTALLATION = ('epsilon', 'zeta', 'eta')
"""ε, ζ, η: rotations of the board about its z, y and x axes relative to its rigging."""

TURN = 5.0
"""Rotation (°) discussed in section IV.C."""

TURNS = (-TURN, -TURN / 2, 0.0, TURN / 2, TURN)
FEW_TURNS = (-TURN, 0.0, TURN)

SPEED_FACTOR = 1.05
"""Factor on the speed that shows the effect of drag alone on the mouth."""

COARSENING_FACTOR = 2
"""Factor by which the net of the small version is coarser."""


@dataclass(frozen=True)
class BoardReading:
    """The port board in one steady state.

    Attributes
    ----------
    lift, rolling
        Coefficients C_y^F and C_x^M, the latter with the sign that tips the outward normal up.
    outward, upward
        Parts of its own load, N: hydrodynamic force and, in ``upward``, weight in water, which
        is the same in all states.
    normal
        Vertical part of the unit outward normal.
    """

    lift: float
    rolling: float
    outward: float
    upward: float
    normal: float


@dataclass(frozen=True)
class Sighting:
    """Sighting: the observables of a steady state, and its port board."""

    seen: Observables
    board: BoardReading


def gear(quick: bool) -> GearRecord:
    """The gear of the paper; in the small version with a coarser net."""
    record = load_gear('kaifuha')
    if not quick:
        return record
    return record.changed('netting', around=record.netting.around // COARSENING_FACTOR)


def paper_model(quick: bool) -> GearModel:
    """Model of the paper's gear with the coefficients of eq. 37."""
    return build_model(gear(quick))


def sighting(model: GearModel, steady: SteadyState) -> Sighting:
    """Read a steady state of a model."""
    seen, state = steady.observables, steady.equilibrium.state
    coefficients = EQ14(
        model.coefficients,
        np.array(seen.port_attack),
        np.array(seen.port_slip),
    )
    load = board_loads(model, state)[0]
    return Sighting(
        seen,
        BoardReading(
            lift=float(coefficients[1]),
            rolling=float(-coefficients[3]),
            outward=float(load[1]),
            upward=float(load[2]),
            normal=float(outward_normal_lift(state)[0]),
        ),
    )


def warp_sweep(model: GearModel, lengths: Sequence[float], speed: float) -> list[SteadyState]:
    """Return steady states at several warp lengths, each started from the one before."""
    found: list[SteadyState] = []
    for length in lengths:
        start = found[-1].equilibrium if found else None
        found.append(steady_state(model, length, speed, start=start))
    return found


def installation_sweep(
    model: GearModel, turns: Sequence[float]
) -> Mapping[str, Mapping[float, Sighting]]:
    """Angle → turn (°) → the gear with its boards turned so against their rigging.

    ``turns`` has 0: the gear as it is, from which the others are reached.
    """
    base = steady_state(model, WARP_LENGTH, SPEED)
    found: dict[str, dict[float, Sighting]] = {}
    for axis, name in enumerate(INSTALLATION):
        row = {0.0: sighting(model, base)}
        for turn in (turn for turn in turns if turn):
            angles = np.zeros(3)
            angles[axis] = np.radians(turn)
            turned = model.with_board(installation=tuple(angles))
            steady = steady_state(turned, WARP_LENGTH, SPEED, start=base.equilibrium)
            row[turn] = sighting(turned, steady)
        found[name] = {turn: row[turn] for turn in turns}
    return found


def faster(model: GearModel) -> Sighting:
    """Return the gear without rotations at a somewhat higher speed."""
    return sighting(model, steady_state(model, WARP_LENGTH, SPEED_FACTOR * SPEED))
