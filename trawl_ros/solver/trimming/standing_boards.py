# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Coefficients with which boards stand as they were seen to stand, on given fastening points.

A crew fastens boards so that they work. With other coefficients than the true ones the same points
let them fall, and a fit that starts there has no steady state. Boards held at their measured
attitude tell which coefficients balance the moments of the ropes, and how stiffly.
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State
from trawl_ros.solver.trimming.held_boards import HeldBoard, port_loads
from trawl_ros.solver.trimming.held_gear import HeldGear, attitude_at


@dataclass(frozen=True)
class CoefficientRange:
    """Range of coefficients: start, std, lowest and highest values, each (q,)."""

    start: FloatArray
    std: FloatArray
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True)
class StandingDraw:
    """Options of the search.

    Attributes
    ----------
    attacks
        Attacks at which the boards are held, rad; no sensor shows the attack.
    draws
        Number of draws at each attack.
    seed
        Seed of the draws.
    """

    attacks: tuple[float, ...] = tuple(np.radians((15.0, 20.0, 25.0)))
    draws: int = 200
    seed: int = 1


def standing_coefficients(
    model: GearModel,
    known: CoefficientRange,
    place: tuple[float, float],
    *,
    inclination: float,
    pitch: float,
    options: StandingDraw = StandingDraw(),
) -> list[FloatArray]:
    """Find coefficients that balance boards at an attitude, the stiffest balance first.

    Parameters
    ----------
    model
        The gear, with its fastening points.
    known
        Range in which the coefficients are drawn.
    place
        Warp length (m) and speed (m/s) of the attitude.
    inclination, pitch
        The attitude, rad: δ with the sign of the roll of the port board, and pitch, nose down.
    options
        Attacks, and number of draws.

    Returns
    -------
    list of (q,) arrays
        Coefficients with a stable balance; empty if there are none.
    """
    rng = np.random.default_rng(options.seed)
    found: list[tuple[float, FloatArray]] = []
    for attack in options.attacks:
        try:
            held = HeldGear(model, attitude_at(model, place, attack, inclination, pitch), [place])
            board = held.boards(model.board.points)[0]
        except (NoSteadyState, ValueError):
            # The gear has no shape at this attack, or no yaw gives it at this attitude.
            continue
        (gear, _), state = held.acting[0], held.states[0]
        by_coefficients = _moments_by(gear, board, state, known)
        for _ in range(options.draws):
            drawn = known.start + known.std * rng.standard_normal(len(known.std))
            drawn = np.clip(drawn, known.low, known.high)
            moment, _ = _balance(gear, board, state, drawn)
            values = np.clip(
                drawn - known.std * (np.linalg.pinv(by_coefficients * known.std) @ moment),
                known.low, known.high,
            )  # fmt: skip
            _, stiffness = _balance(gear, board, state, values)
            if stiffness > 0.0:
                found.append((stiffness, values))
    return [values for _, values in sorted(found, key=lambda pair: -pair[0])]


def _balance(
    model: GearModel, board: HeldBoard, state: State, coefficients: FloatArray
) -> tuple[FloatArray, float]:
    """Return the moment (3,) left on a held board, N m, and its least stiffness, N m per rad."""
    load, by_turn = port_loads(model.with_coefficients(coefficients), state)
    moment, stiffness = replace(board, load=load, by_turn=by_turn).balance(board.arms)
    return moment, float(min(np.linalg.eigvals(own).real.min() for own in stiffness))


def _moments_by(
    model: GearModel, board: HeldBoard, state: State, known: CoefficientRange
) -> FloatArray:
    """Return the changes (3, q) of a board's moment, N m, per unit of each coefficient.

    Differences over one std: exact for eq. 14, whose coefficients act linearly.
    """
    still, _ = _balance(model, board, state, known.start)
    steps = np.diag(known.std)
    moved = [_balance(model, board, state, known.start + step)[0] - still for step in steps]
    derivatives: FloatArray = np.column_stack(moved) / known.std
    return derivatives
