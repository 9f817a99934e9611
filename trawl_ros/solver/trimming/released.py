# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trim of released boards: fastening points that give nearly the wanted angles over a range.

The search of `over_range` holds the boards and considers their stiffness. Here they are free, so
the real response of the gear improves its result. Nine coordinates are fitted by least squares,
within the room that a board has for holes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium, with_effects


@dataclass(frozen=True)
class ReleasedTrim:
    """Weights of a trim of released boards.

    Attributes
    ----------
    attack, roll, pitch : float
        Difference (rad) from the wanted angle that counts as one.
    surfaced : float
        Height (m) above ``clearance`` that counts as one.
    clearance : float
        Least depth (m) of the highest point of the gear.
    upset : float
        Rotation (rad, ε) of the boards against their rigging that they must stand: attack falls by
        as much when warp is paid out, because tension falls before the speed of the flow.
    least_roll, least_attack : float
        Roll and attack (rad) that boards must keep under this rotation.
    short_of_roll, short_of_attack : float
        Shortfall (rad) that counts as one.
    lost : float
        Residual of a place without an equilibrium.
    moved : float
        Change of a coordinate (m) that counts as one; it decides what the angles leave free.
    step : float
        Step (m) of the differences for the Jacobian.
    evaluations : int
        Largest number of evaluations of the residuals.
    """

    attack: float = np.radians(4.0)
    roll: float = np.radians(8.0)
    pitch: float = np.radians(10.0)
    surfaced: float = 3.0
    clearance: float = 5.0
    upset: float = np.radians(-5.0)
    least_roll: float = np.radians(5.0)
    least_attack: float = np.radians(12.0)
    short_of_roll: float = np.radians(6.0)
    short_of_attack: float = np.radians(3.0)
    lost: float = 10.0
    moved: float = 50.0
    step: float = 2e-4
    evaluations: int = 40


def released_points(
    model: GearModel,
    start: FloatArray,
    limits: FloatArray,
    wanted: tuple[float, float, float],
    places: Sequence[tuple[float, float]],
    options: ReleasedTrim = ReleasedTrim(),
) -> FloatArray:
    """Fit fastening points (3, 3) to wanted angles of released boards.

    Parameters
    ----------
    model
        The gear; a coarse net serves.
    start : (3, 3) array
        Points from which the search starts, m.
    limits : (3,) array
        Largest distance of a hole from the centre of gravity, m.
    wanted
        Attack, roll and pitch, rad.
    places
        Warp length (m) and speed (m/s) of each operating point. Those without an equilibrium with
        the first points are left out.
    options
        Weights.

    Returns
    -------
    (3, 3) array
        Points; the first ones if no operating point has an equilibrium with them.
    """
    upset = model.with_board(
        installation=tuple(np.add(model.board.installation, (options.upset, 0, 0)))
    )
    roots: dict[tuple[bool, tuple[float, float]], State] = {}
    for place in places:
        try:
            roots[False, place] = _root(model, start, place, None).state
            roots[True, place] = _root(upset, start, place, roots[False, place]).state
        except NoSteadyState:
            continue
    if not roots:
        return start
    best, least = start, np.inf

    def residuals(x: FloatArray) -> FloatArray:
        nonlocal best, least
        points, rows, states = x.reshape(3, 3), [], {}
        for (turned, place), near in roots.items():
            try:
                found = _root(upset if turned else model, points, place, near)
            except NoSteadyState:
                rows.append(np.full(2 if turned else 4, options.lost))
                continue
            states[turned, place] = found.state
            rows.append(_lack(found, options) if turned else _miss(found, wanted, options))
        left = np.concatenate([*rows, (x - start.ravel()) / options.moved])
        if len(states) == len(roots) and (value := float(left @ left)) < least:
            best, least = points.copy(), value
            roots.update(states)
        return left

    bound = np.tile(limits, 3)
    inside = np.clip(start.ravel(), -bound + options.step, bound - options.step)
    least_squares(
        residuals,
        inside,
        bounds=(-bound, bound),
        x_scale=bound,
        diff_step=options.step,
        max_nfev=options.evaluations,
    )
    return best


def _miss(
    found: Equilibrium, wanted: tuple[float, float, float], options: ReleasedTrim
) -> FloatArray:
    """Return weighted differences (4,) from the wanted angles, and height above the clearance."""
    seen = found.observables
    return np.array(
        [
            (seen.port_attack - wanted[0]) / options.attack,
            (seen.port_roll - wanted[1]) / options.roll,
            (seen.port_pitch - wanted[2]) / options.pitch,
            max(0.0, found.highest + options.clearance) / options.surfaced,
        ]
    )


def _lack(found: Equilibrium, options: ReleasedTrim) -> FloatArray:
    """Return the weighted shortfall (2,) of roll and attack of upset boards."""
    seen = found.observables
    return np.array(
        [
            max(0.0, options.least_roll - seen.port_roll) / options.short_of_roll,
            max(0.0, options.least_attack - seen.port_attack) / options.short_of_attack,
        ]
    )


def _root(
    model: GearModel, points: FloatArray, place: tuple[float, float], near: State | None
) -> Equilibrium:
    """Find the equilibrium at a warp length and speed, from a state nearby if there is one."""
    acting, point = with_effects(model.with_board(points=points), (place[0],) * 2, place[1])
    return find_equilibrium(acting, point, near=near, cold=near is None)
