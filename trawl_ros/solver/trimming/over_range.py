"""Trim over a range: fastening points at which boards work as wanted at many speeds and warps.

Nine coordinates of three points balance three moments at one operating point; the other six are
free. They are used so that the attitude changes little over a range of speeds and warp lengths, and
so that what is not known of the moments turns the boards little: points near the centre of gravity
would need no balance, and would hold nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.optimize import minimize

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.model.board import Board
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import SteadyState, steady_state
from trawl_ros.solver.first_guess import coarser_model
from trawl_ros.solver.trim import roll_for
from trawl_ros.solver.trimming.held_boards import HeldBoard
from trawl_ros.solver.trimming.held_gear import HeldGear, attitude_at, coarsest_model
from trawl_ros.solver.trimming.released import released_points

TURNS = np.radians([5.0, 5.0, 2.0])
"""Roll, pitch and yaw of a board that count alike: lift changes with yaw."""

UNKNOWN = 0.01, 0.02, 0.05
"""Parts of the chord by which the centre of pressure may lie elsewhere than the board's law has it,
tried in turn: the larger, the stiffer a rigging is sought."""

NEAR = 3.0
"""Move of a coordinate (m) from the rigging it starts from that counts as one of `TURNS`."""

REACH = 0.3, 0.01
"""Largest change of a coordinate at once, and the one at which the search ends, m."""

MAX_HOLE_OFFSETS = 0.47, 0.2, 0.46
"""Largest distance of a hole from the centre of gravity: along the chord and off the face, where a
bracket carries it (both in chords), and along the span (in spans)."""

AT_BOUND = 1e-3
"""Distance (m) from its bound at which a coordinate rests on it."""

ITERATIONS = 40
SOFTEST = 1e-3
"""Least stiffness against turns, as a part of force times chord, for which compliance counts."""

FLUTTER = 0.5
"""Part of an eigenvalue's imaginary part that is taken from its real one: turns about two axes that
drive each other grow however stiff both are."""


@dataclass(frozen=True)
class RangePoint:
    """An operating point of the range: its steady state, or the reason why there is none."""

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
        Of warp, upper and lower bridle in the outward frame, m.
    model
        The gear with these points.
    found
        Operating points of the range, warp by warp, with what the released gear does there.
    """

    points: FloatArray
    model: GearModel
    found: tuple[RangePoint, ...]

    @property
    def at_bounds(self) -> tuple[str, ...]:
        """Coordinates that rest on the edge of the room for holes, each with its value (m)."""
        names = product(('warp', 'upper bridle', 'lower bridle'), 'xyz')
        rests = np.abs(self.points) > hole_limits(self.model.board) - AT_BOUND
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
    """Largest distance (3,) of a hole from the centre of gravity, in the outward frame, m."""
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
        The gear; its points are where the search starts. Effects of its gear file act.
    attack, inclination
        Wanted α and δ, rad; the outward normal leans up, with a negative δ down.
    pitch
        Wanted pitch of the boards, nose down, rad.
    warp_lengths, speeds
        Of the range, m and m/s; every pair is an operating point.
    on_progress
        Called before each rigging that is tried, and after the last.

    Returns
    -------
    RangeTrim
        The rigging with most usable states, among these the one with least change of attitude.

    Raises
    ------
    NoSteadyState
        If with boards held at these angles the gear has no shape at one of the operating points.
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
    # Boards answer to the pull of the bridles, which the coarsest net has by some per cent only.
    finer = coarser_model(model) or model
    starts = best.points, np.clip(start, -limits, limits)
    tried = *starts, *(released_points(finer, p, limits, wanted, places) for p in starts)
    whole = held if coarse is model else HeldGear(model, rotations, places)
    return max((_released(whole, points) for points in tried), key=_worth)


def trim_held(
    held: HeldGear,
    start: FloatArray,
    unknown: Sequence[float] = UNKNOWN,
    *,
    on_progress: OnProgress = ignore,
) -> RangeTrim:
    """Find fastening points by how stiffly they hold boards at their attitude.

    Parameters
    ----------
    held
        The gear with its boards held at the wanted attitude.
    start : (3, 3) array
        Points from which the search starts, m.
    unknown
        Parts of the chord by which the centre of pressure may lie elsewhere, tried in turn.
    on_progress
        Called before each rigging that is tried, and after the last.

    Returns
    -------
    RangeTrim
        The best of the riggings, with what the released gear does there.

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
    """Usable states first, then little change of attitude."""
    changes = np.array([found.by_speed, found.by_warp]) / TURNS[[2, 0]]
    return found.usable, -float(np.nan_to_num(changes, nan=1e3).sum())


def _merit(
    held: HeldGear, boards: Sequence[HeldBoard], points: FloatArray, unknown: float
) -> float:
    """Mean squared turn of the boards when they are released, in `TURNS`, of which a part is
    for moments that are not known.
    """
    arms, chord, total = held.arms(points), held.model.board.chord, 0.0
    for board in boards:
        moment, stiffness = board.balance(arms)
        force = float(np.linalg.norm(board.load[:3]))
        axes = held.turn.T @ stiffness @ held.turn
        values = np.linalg.eigvals(axes) / (force * chord)
        softest = float((values.real - FLUTTER * np.abs(values.imag)).min())
        if softest < SOFTEST:
            total += 1e4 * (1.0 + SOFTEST - softest)
            continue
        # Moments that are not known count where they turn both boards alike.
        left = np.column_stack([held.turn.T @ moment, unknown * chord * force * np.eye(3)])
        total += float(np.sum((np.linalg.solve(axes[0], left) / TURNS[:, None]) ** 2))
    return total / len(boards) + float(np.sum(((points - held.model.board.points) / NEAR) ** 2))


def _searched(held: HeldGear, start: FloatArray, unknown: float) -> FloatArray:
    """Points (3, 3) of least merit, from those given; steps are kept small enough for the
    shape to follow.
    """
    limits = hole_limits(held.model.board)
    points, reach = np.clip(start, -limits, limits), REACH[0]
    boards, states = held.boards(points), held.states
    value = _merit(held, boards, points, unknown)
    for _ in range(ITERATIONS):
        if reach < REACH[1]:
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
            held.states, reach = states, 0.3 * reach
            continue
        worth = _merit(held, there, trial, unknown)
        if worth < value:
            settled = value - worth < 1e-3 * value
            points, boards, states, value = trial, there, held.states, worth
            if settled:
                break
        else:
            held.states, reach = states, 0.3 * reach
    held.states = states
    return points


def _released(held: HeldGear, points: FloatArray) -> RangeTrim:
    """Release the boards with these points, from the shapes in which they were held."""
    model = held.model.with_board(points=points)
    found = []
    for (warp, speed), state in zip(held.places, held.states, strict=True):
        try:
            found.append(RangePoint(warp, speed, steady_state(model, warp, speed, near=state), ''))
        except NoSteadyState as reason:
            found.append(RangePoint(warp, speed, None, str(reason)))
    return RangeTrim(points, model, tuple(found))
