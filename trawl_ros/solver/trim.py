# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trim: fastening points at which a board works at wanted angles.

With a prescribed attitude, a board's position balances the forces and its fastening points balance
the moments. Nine coordinates balance three moments, so Newton takes the smallest change (by the
pseudo-inverse), and a trim stays close to the rigging it starts from.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.assembly import forces, linearised
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.cold_start import held_shape
from trawl_ros.solver.equilibrium import SteadyState, steady_state, with_effects
from trawl_ros.solver.first_guess import attitudes, first_guess
from trawl_ros.solver.linear.factor import factorised_part
from trawl_ros.solver.operating_point import steady_tow
from trawl_ros.solver.relax import relax, without_attitude


@dataclass(frozen=True)
class TrimOptions:
    """Options of a trim.

    Attributes
    ----------
    iterations
        Newton iterations for the points.
    max_move_m
        Largest change of a coordinate in one iteration, m.
    converged_move_m
        Change of a coordinate at which the points are converged, m.
    shape_force_n, shape_iterations
        Force left (N) at which the first shape is close enough, and iterations that suffice if no
        bars flip between slack and taut.
    yaw_range
        Half the range of yaw (rad) around the wanted attack. They differ by a few degrees, because
        pitch, roll and the motion of the gear add to yaw.
    """

    iterations: int = 30
    max_move_m: float = 0.3
    converged_move_m: float = 1e-7
    shape_force_n: float = 50.0
    shape_iterations: int = 120
    yaw_range: float = 0.15


OPTIONS = TrimOptions()


@dataclass(frozen=True)
class Trim:
    """Result of a trim: fastening points and steady state.

    ``points`` (3, 3) are those of warp, upper and lower bridle in the outward frame, m. ``steady``
    is the steady state of the released gear with them.
    """

    points: FloatArray
    model: GearModel
    steady: SteadyState


def roll_for(inclination: float, pitch: float) -> float:
    """Return the roll (rad) that gives a board an inclination at a pitch.

    δ is the tilt of R_y(pitch) R_x(roll), so cos δ = cos pitch cos roll.

    Raises
    ------
    NoSteadyState
        If the board leans less than it is pitched.
    """
    tilt = np.cos(inclination) / np.cos(pitch)
    if not -1.0 <= tilt <= 1.0:
        raise NoSteadyState(
            f'an inclination of {np.degrees(inclination):.1f}° is not possible with a pitch of '
            f'{np.degrees(pitch):.1f}°, expected a smaller pitch'
        )
    return float(np.copysign(np.arccos(tilt), inclination))


def trim(
    model: GearModel,
    *,
    attack: float,
    inclination: float,
    pitch: float = 0.0,
    warp_length: float,
    speed: float,
) -> Trim:
    """Find fastening points for wanted angles at one operating point.

    Parameters
    ----------
    model
        The gear. The search starts from its points and keeps its installation angles. Effects of
        its gear file act.
    attack, inclination
        Wanted α and δ, rad. With δ above 0 the upper edge leans inward and the outward normal up;
        below 0 the upper edge leans outward.
    pitch
        Wanted pitch of the boards, nose down, rad.
    warp_length, speed
        Operating point of the wanted angles, m and m/s.

    Returns
    -------
    Trim
        ``points`` (3, 3), m, of warp, upper and lower bridle, and the ``steady`` state with them.

    Raises
    ------
    NoSteadyState
        If no points balance the boards there, or their steady state is not usable.
    GearError
        For a gear without boards.

    Examples
    --------
    >>> import math
    >>> import trawl_ros
    >>> found = trawl_ros.trim(
    ...     trawl_ros.build_model(trawl_ros.load_gear('kaifuha')),
    ...     attack=math.radians(22.0), inclination=math.radians(15.0), warp_length=500.0, speed=2.1,
    ... )
    >>> round(math.degrees(found.steady.observables.port_attack), 3)
    22.0
    """
    model.gear.require_boards('whose fastening points could be found')
    low, high = model.board.law.range
    if not low <= attack <= high:
        raise NoSteadyState(
            f'found a wanted attack angle of {np.degrees(attack):.1f}°, expected one in the range '
            f"of the boards' law, {np.degrees(low):.0f} to {np.degrees(high):.0f}°",
            'outside law',
        )
    acting, point = with_effects(model, (warp_length, warp_length), speed)
    tow = steady_tow(acting, point)
    state = first_guess(acting, tow, point.heading)
    roll = roll_for(inclination, pitch)
    found = _Search(acting, state, tow)

    def excess(yaw: float) -> float:
        found.balance(attitudes(yaw, pitch, roll))
        return observe(found.model, found.state, tow).port_attack - attack

    half = OPTIONS.yaw_range
    try:
        yaw = brentq(excess, attack - half, attack + half, xtol=1e-6)
    except ValueError as reason:
        # The boards' own motion changes attack by more where they lie nearly flat.
        raise NoSteadyState(
            f'no yaw within {np.degrees(half):.1f}° of the wanted attack angle, '
            f'{np.degrees(attack):.1f}°, gives the boards this angle'
        ) from reason
    found.balance(attitudes(yaw, pitch, roll))
    # The held shape is balanced, so the released gear starts at its root.
    trimmed = model.with_board(points=found.model.board.points)
    return Trim(
        trimmed.board.points, trimmed, steady_state(trimmed, warp_length, speed, near=found.state)
    )


class _Search:
    """Search for fastening points at one attitude after another.

    Each search starts from the first rigging, so that its smallest change does not depend on the
    attitudes tried before.
    """

    def __init__(self, model: GearModel, state: State, tow: Tow) -> None:
        self.origin, self.model, self.state, self.tow = model, model, state, tow

    def balance(self, rotations: FloatArray) -> None:
        """Change points and state until all forces and moments vanish at this attitude."""
        model, tow = self.origin, self.tow
        free = without_attitude(model)
        held = replace(self.state, board_rotations=rotations)
        state, _, left = relax(
            model,
            held,
            tow,
            tolerance=OPTIONS.shape_force_n,
            time_step=2.0,
            free=free,
            limit=OPTIONS.shape_iterations,
        )
        if left > OPTIONS.shape_force_n:
            state, _, left = held_shape(model, held, tow)
        if left > OPTIONS.shape_force_n:
            raise NoSteadyState(
                'the gear has no shape with the boards held at the wanted angles, '
                f'{left:.3g} N left; try other angles in the range of their law'
            )
        moving = np.flatnonzero(free)
        moments = np.arange(3 * model.nodes + 3, 3 * model.nodes + 6)
        for _ in range(OPTIONS.iterations):
            here = linearised(model, state, tow)
            stiffness = model.pattern.matrix(here.stiffness)
            pushes = _by_points(model, state, tow)
            solve = factorised_part(stiffness[moving][:, moving].tocsc()).solve
            shifts = solve(np.column_stack([here.force[moving], pushes[moving]]))
            rows = stiffness[moments][:, moving]
            # Static condensation: the moment left and its derivatives by the points.
            left_moment = here.force[moments] - rows @ shifts[:, 0]
            by_points = pushes[moments] - rows @ shifts[:, 1:]
            change = -np.linalg.pinv(by_points) @ left_moment
            share = min(1.0, OPTIONS.max_move_m / np.abs(change).max())
            step = np.zeros(model.dof)
            step[moving] = share * (shifts[:, 0] + shifts[:, 1:] @ change)
            state = state.moved(step)
            model = model.with_board(points=model.board.points + share * change.reshape(3, 3))
            if np.abs(change).max() < OPTIONS.converged_move_m:
                self.model, self.state = model, state
                return
        raise NoSteadyState(
            'no fastening points were found that balance the boards at the wanted angles'
        )


def _by_points(model: GearModel, state: State, tow: Tow) -> FloatArray:
    """Return derivatives (dof, 9) of the forces by coordinates of both boards' points."""
    columns = []
    for index in range(9):
        points = model.board.points.astype(complex)
        points.flat[index] += 1j * STEP
        columns.append(forces(model.with_board(points=points), state, tow).imag / STEP)
    return np.column_stack(columns)
