"""Trim of released boards: fastening points that bring their angles over a range near the wanted.

The search of `over_range` holds the boards and reckons with how stiffly they are held. Here they
are free, so its result is improved by what the gear really does. Nine coordinates are fitted by
least squares, within the room that a board has for holes.
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
        Differences (rad) from the wanted angles that count as one.
    surfaced : float
        Height (m) above ``clearance`` that counts as one.
    clearance : float
        Depth (m) above which the highest point of the gear ought not to come.
    lost : float
        Residual of a place without an equilibrium.
    moved : float
        Move of a coordinate (m) that counts as one; it settles what the angles leave open.
    step : float
        Step (m) of the differences that make the Jacobian.
    evaluations : int
        Most evaluations of the residuals.
    """

    attack: float = np.radians(4.0)
    roll: float = np.radians(8.0)
    pitch: float = np.radians(10.0)
    surfaced: float = 5.0
    clearance: float = 2.0
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
        Warp length (m) and speed (m/s) of each operating point. Those that have no equilibrium
        with the first points are left out.
    options
        Weights.

    Returns
    -------
    (3, 3) array
        Points; the first ones where no operating point has an equilibrium with them.
    """
    roots: dict[tuple[float, float], State] = {}
    for place in places:
        try:
            roots[place] = _root(model, start, place, None).state
        except NoSteadyState:
            continue
    if not roots:
        return start
    angles = np.array([options.attack, options.roll, options.pitch])
    best, least = start, np.inf

    def residuals(x: FloatArray) -> FloatArray:
        nonlocal best, least
        points, rows, states = x.reshape(3, 3), [], {}
        for place, near in roots.items():
            try:
                found = _root(model, points, place, near)
            except NoSteadyState:
                rows.append(np.full(4, options.lost))
                continue
            states[place], seen = found.state, found.observables
            turned = np.array([seen.port_attack, seen.port_roll, seen.port_pitch])
            high = max(0.0, found.highest + options.clearance) / options.surfaced
            rows.append(np.append((turned - wanted) / angles, high))
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


def _root(
    model: GearModel, points: FloatArray, place: tuple[float, float], near: State | None
) -> Equilibrium:
    """Equilibrium at a warp length and speed, from a state nearby if there is one."""
    acting, point = with_effects(model.with_board(points=points), (place[0],) * 2, place[1])
    return find_equilibrium(acting, point, near=near, cold=near is None)
