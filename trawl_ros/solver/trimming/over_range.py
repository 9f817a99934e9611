# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trim over a range: fastening points at which boards work as wanted at many speeds and warps.

Nine coordinates of three points balance three moments at one operating point; six remain free. They
are chosen so that the attitude changes little over a range of speeds and warp lengths, and so that
unknown moments turn the boards little. Points near the centre of gravity would balance too, but
would have no stiffness.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.optimize import minimize

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.model.board import Board
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State
from trawl_ros.solver.equilibrium import SteadyState, steady_state
from trawl_ros.solver.first_guess import coarser_model
from trawl_ros.solver.trim import roll_for
from trawl_ros.solver.trimming.held_boards import HeldBoard
from trawl_ros.solver.trimming.held_gear import HeldGear, attitude_at, coarsest_model
from trawl_ros.solver.trimming.released import released_points

EQUAL_ROTATIONS = np.radians([5.0, 5.0, 2.0])
"""Roll, pitch and yaw of a board with equal weight; yaw counts most because it changes lift."""

CENTRE_SHIFTS_PER_CHORD = 0.01, 0.02, 0.05
"""Uncertain shifts of the centre of pressure in chords, each tried: a larger one leads to a stiffer
rigging."""

MAX_HOLE_OFFSETS = 0.47, 0.2, 0.46
"""Largest distance of a hole from the centre of gravity: along the chord and off the face, where a
bracket carries it (both in chords), and along the span (in spans)."""

SOFT_BOARD_PENALTY = 1e4
"""Merit (squared rotations) of a board that is too soft: far above that of stiff ones."""

REACH_SHRINK_FACTOR = 0.3
"""Factor on the trust region's reach after a step to a worse rigging or to one without a shape."""

CONVERGED_GAIN = 1e-3
"""Relative gain of a step after which the search ends."""

BOUND_TOLERANCE_M = 1e-3
"""Distance from its bound at which a coordinate counts as on it."""


@dataclass(frozen=True)
class HeldTrimOptions:
    """Options of the search for points that hold boards stiffly.

    Attributes
    ----------
    iterations
        Iterations of the trust region.
    first_reach_m, last_reach_m
        Largest change of a coordinate in one iteration, and the one at which the search ends, m.
    move_scale_m
        Change of a coordinate from the first rigging that counts as one of `EQUAL_ROTATIONS`, m.
    min_stiffness
        Least stiffness against rotations, per force times chord; softer boards get a penalty.
    flutter_ratio
        Part of an eigenvalue's imaginary part subtracted from its real part: rotations about two
        coupled axes can grow even if both are stiff.
    """

    iterations: int = 40
    first_reach_m: float = 0.3
    last_reach_m: float = 0.01
    move_scale_m: float = 3.0
    min_stiffness: float = 1e-3
    flutter_ratio: float = 0.5


OPTIONS = HeldTrimOptions()


@dataclass(frozen=True)
class RangePoint:
    """Operating point of the range: its steady state, or the reason why there is none."""

    warp_length: float
    speed: float
    steady: SteadyState | None
    reason: str


@dataclass(frozen=True)
class RangeTrim:
    """Result of a trim over a range.

    Attributes
    ----------
    points : (3, 3) array
        Points of warp, upper and lower bridle in the outward frame, m.
    model
        The gear with these points.
    found
        Operating points of the range, warp by warp, with the state of the released gear.
    """

    points: FloatArray
    model: GearModel
    found: tuple[RangePoint, ...]

    @property
    def at_bounds(self) -> tuple[str, ...]:
        """Coordinates on the edge of the room for holes, each with its value (m)."""
        names = product(('warp', 'upper bridle', 'lower bridle'), 'xyz')
        rests = np.abs(self.points) > hole_limits(self.model.board) - BOUND_TOLERANCE_M
        return tuple(
            f'{point} {axis} {value:.3f} m'
            for (point, axis), value, bound in zip(names, self.points.flat, rests.flat, strict=True)
            if bound
        )

    @property
    def usable(self) -> int:
        """Number of operating points with a usable steady state."""
        return sum(point.steady is not None for point in self.found)

    @property
    def by_speed(self) -> tuple[float, float]:
        """Largest change of attack and of inclination (rad) by speed at one warp length."""
        return self._most('warp_length')

    @property
    def by_warp(self) -> tuple[float, float]:
        """Largest change of attack and of inclination (rad) by warp length at one speed."""
        return self._most('speed')

    @property
    def slowest(self) -> float:
        """Growth (1/s) of the slowest motion at any of the usable points; negative."""
        return max((p.steady.stability.growth for p in self.found if p.steady), default=np.nan)

    def _most(self, held: str) -> tuple[float, float]:
        groups: dict[float, list[tuple[float, float]]] = {}
        for point in self.found:
            if point.steady is not None:
                seen = point.steady.observables
                pair = seen.port_attack, seen.port_inclination
                groups.setdefault(getattr(point, held), []).append(pair)
        spans = [np.ptp(np.array(group), axis=0) for group in groups.values()]
        attack, inclination = np.max(spans, axis=0) if spans else (np.nan, np.nan)
        return float(attack), float(inclination)


def hole_limits(board: Board) -> FloatArray:
    """Return the largest distance (3,) of a hole from the centre of gravity, outward frame, m."""
    return np.multiply(MAX_HOLE_OFFSETS, (board.chord, board.chord, board.span))


def trim_over_range(
    model: GearModel,
    *,
    attack: float,
    inclination: float,
    pitch: float = 0.0,
    warp_lengths: Sequence[float],
    speeds: Sequence[float],
    on_progress: OnProgress = ignore,
) -> RangeTrim:
    """Find fastening points for wanted angles over a range of speeds and warp lengths.

    Parameters
    ----------
    model
        The gear. The search starts from its points. Effects of its gear file act.
    attack, inclination
        Wanted α and δ, rad. With δ above 0 the upper edge leans inward; below 0, outward.
    pitch
        Wanted pitch of the boards, nose down, rad.
    warp_lengths, speeds
        Values of the range, m and m/s; every pair is an operating point.
    on_progress
        Called before each rigging that is tried, and after the last.

    Returns
    -------
    RangeTrim
        The rigging with most usable states; of these, the one with least change of attitude.

    Raises
    ------
    NoSteadyState
        If the gear has no shape with boards held at these angles at one of the operating points.
    GearError
        For a gear without boards.

    Examples
    --------
    >>> from math import radians
    >>> import trawl_ros
    >>> from trawl_ros.solver.trimming.over_range import trim_over_range
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> found = trim_over_range(
    ...     model, attack=radians(20), inclination=radians(12),
    ...     warp_lengths=(400.0, 700.0), speeds=(2.0, 2.4),
    ... )
    >>> found.usable
    4
    """
    model.gear.require_boards('whose fastening points could be found')
    places = list(product(warp_lengths, speeds))
    rotations = attitude_at(model, places[0], attack, inclination, pitch)
    coarse = coarsest_model(model)
    held = HeldGear(coarse, rotations, places)
    start = model.board.points
    best = trim_held(held, start, on_progress=on_progress)
    wanted, limits = (attack, roll_for(inclination, pitch), pitch), hole_limits(model.board)
    # The coarsest net gets the pull of the bridles right to a few per cent, so refine once.
    finer = coarser_model(model) or model
    starts = best.points, np.clip(start, -limits, limits)
    tried = *starts, *(released_points(finer, p, limits, wanted, places) for p in starts)
    whole = held if coarse is model else HeldGear(model, rotations, places)
    return max((_released(whole, points) for points in tried), key=_worth)


def states_over_range(
    model: GearModel, warp_lengths: Sequence[float], speeds: Sequence[float]
) -> RangeTrim:
    """Return the steady states of a gear at all pairs of warp length (m) and speed (m/s)."""
    places = tuple((warp, speed, None) for warp, speed in product(warp_lengths, speeds))
    return RangeTrim(model.board.points, model, _towed(model, places))


def trim_held(
    held: HeldGear,
    start: FloatArray,
    unknown: Sequence[float] = CENTRE_SHIFTS_PER_CHORD,
    *,
    on_progress: OnProgress = ignore,
) -> RangeTrim:
    """Find fastening points that hold boards stiffly at their attitude.

    Parameters
    ----------
    held
        The gear with its boards held at the wanted attitude.
    start : (3, 3) array
        Points from which the search starts, m.
    unknown
        Uncertain shifts of the centre of pressure in chords, each tried.
    on_progress
        Called before each rigging that is tried, and after the last.

    Returns
    -------
    RangeTrim
        The best of the riggings, with the states of the released gear.

    Raises
    ------
    NoSteadyState
        If the gear has no shape with other points.
    """
    first, found = held.states, []
    for done, part in enumerate(unknown):
        on_progress(WorkProgress('riggings', done, len(unknown)))
        held.states = first
        found.append(_released(held, _searched(held, start, part)))
    on_progress(WorkProgress('riggings', len(unknown), len(unknown)))
    return max(found, key=_worth)


def _worth(found: RangeTrim) -> tuple[int, float]:
    """Return the merit of a trim: usable states first, then little change of attitude."""
    changes = np.array([found.by_speed, found.by_warp]) / EQUAL_ROTATIONS[[2, 0]]
    return found.usable, -float(np.nan_to_num(changes, nan=1e3).sum())


def _merit(
    held: HeldGear, boards: Sequence[HeldBoard], points: FloatArray, unknown: float
) -> float:
    """Return the mean squared rotation of the released boards, in `EQUAL_ROTATIONS`.

    It includes rotations by the unknown moments of a shifted centre of pressure.
    """
    arms, chord, total = held.arms(points), held.model.board.chord, 0.0
    for board in boards:
        moment, stiffness = board.balance(arms)
        force = float(np.linalg.norm(board.load[:3]))
        axes = held.turn.T @ stiffness @ held.turn
        values = np.linalg.eigvals(axes) / (force * chord)
        softest = float((values.real - OPTIONS.flutter_ratio * np.abs(values.imag)).min())
        if softest < OPTIONS.min_stiffness:
            total += SOFT_BOARD_PENALTY * (1.0 + OPTIONS.min_stiffness - softest)
            continue
        # Unknown moments are the same on both boards, so the mirrored stiffness counts.
        left = np.column_stack([held.turn.T @ moment, unknown * chord * force * np.eye(3)])
        total += float(np.sum((np.linalg.solve(axes[0], left) / EQUAL_ROTATIONS[:, None]) ** 2))
    moves = (points - held.model.board.points) / OPTIONS.move_scale_m
    return total / len(boards) + float(np.sum(moves**2))


def _searched(held: HeldGear, start: FloatArray, unknown: float) -> FloatArray:
    """Find the points (3, 3) of least rotation, in a trust region in which the shape can follow."""
    limits = hole_limits(held.model.board)
    points, reach = np.clip(start, -limits, limits), OPTIONS.first_reach_m
    boards, states = held.boards(points), held.states
    value = _merit(held, boards, points, unknown)
    for _ in range(OPTIONS.iterations):
        if reach < OPTIONS.last_reach_m:
            break
        bounds = np.stack(
            [
                np.maximum(-limits, points - reach).ravel(),
                np.minimum(limits, points + reach).ravel(),
            ],
            axis=1,
        )
        step = minimize(
            lambda x, known=boards: _merit(held, known, x.reshape(3, 3), unknown),
            points.ravel(),
            method='L-BFGS-B',
            bounds=bounds,
        )
        trial = step.x.reshape(3, 3)
        try:
            there = held.boards(trial)
        except NoSteadyState:
            held.states, reach = states, REACH_SHRINK_FACTOR * reach
            continue
        worth = _merit(held, there, trial, unknown)
        if worth < value:
            converged = value - worth < CONVERGED_GAIN * value
            points, boards, states, value = trial, there, held.states, worth
            if converged:
                break
        else:
            held.states, reach = states, REACH_SHRINK_FACTOR * reach
    held.states = states
    return points


def _released(held: HeldGear, points: FloatArray) -> RangeTrim:
    """Release the boards with these points, from the shapes in which they were held."""
    model = held.model.with_board(points=points)
    near = ((*place, state) for place, state in zip(held.places, held.states, strict=True))
    return RangeTrim(points, model, _towed(model, near))


def _towed(
    model: GearModel, places: Iterable[tuple[float, float, State | None]]
) -> tuple[RangePoint, ...]:
    """Tow a gear at warp lengths (m) and speeds (m/s), each from a near state if there is one."""
    found = []
    for warp, speed, state in places:
        try:
            found.append(RangePoint(warp, speed, steady_state(model, warp, speed, near=state), ''))
        except NoSteadyState as reason:
            found.append(RangePoint(warp, speed, None, str(reason)))
    return tuple(found)
