# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady states: usable roots of the forces, and the reasons why there is none."""

from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.effects.base.effect import Situation, sense
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import (
    fallen_boards,
    highest_point,
    observe,
    outward_normal_lift,
)
from trawl_ros.model.rotations import about_axis
from trawl_ros.model.state import State, Tow
from trawl_ros.records.observables import Observables
from trawl_ros.records.towing_limits import LIMITS
from trawl_ros.solver.cold_start import cold_start
from trawl_ros.solver.first_guess import at_velocity, shifted_to
from trawl_ros.solver.last_state import followed
from trawl_ros.solver.linear.search_budget import budgeted
from trawl_ros.solver.operating_point import (
    OperatingPoint,
    remedy_command,
    steady_tow,
    trim_command,
)
from trawl_ros.solver.relax import (
    DRIFT_ITERATIONS,
    DRIFT_TIME_STEP_S,
    FORCE_TOLERANCE,
    WARM_ITERATIONS,
    WARM_TIME_STEP_S,
    relax,
)
from trawl_ros.solver.stability import Stability, growing_mode, stability
from trawl_ros.solver.warm_start import Tangent, warm_start_in_parts

FAR_WARP_CHANGE = 0.3
"""Relative change of the warps from which slow drift is tried before nearly Newton steps. If one of
them fails, the other is still faster than a cold start."""


@dataclass(frozen=True)
class Equilibrium:
    """Equilibrium: a root of the forces.

    ``state`` is in ``map`` axes with the ship at the origin. ``outside_law`` is True if a board
    works outside the range of its law (eq. 14). ``highest`` is the height (m) of the gear's highest
    point above the surface.
    """

    point: OperatingPoint
    tow: Tow
    state: State
    observables: Observables
    iterations: int
    residual: float
    outside_law: bool
    highest: float
    _tangents: list[Tangent] = field(default_factory=list, init=False, repr=False, compare=False)

    @property
    def tangent(self) -> Tangent | None:
        """Displacements per change of coefficients, warp lengths and speed, if they are known."""
        return self._tangents[0] if self._tangents else None

    def remember(self, tangent: Tangent) -> None:
        """Keep the tangent for the search of the next state."""
        self._tangents[:] = [tangent]

    @property
    def surfaced(self) -> bool:
        """True if the gear breaks the surface."""
        return self.highest > 0.0


@budgeted
def find_equilibrium(
    model: GearModel,
    point: OperatingPoint,
    start: Equilibrium | None = None,
    *,
    near: State | None = None,
    cold: bool = True,
    turned: bool = False,
) -> Equilibrium:
    """Find the root of the forces at an operating point.

    Parameters
    ----------
    model, point
        Gear with its effects, and operating point.
    start
        Known equilibrium nearby, for a warm start.
    near
        Shape close to the root at this same operating point; takes precedence over ``start``.
    cold
        True to allow a cold start where the warm one fails.
    turned
        True to begin a cold start with plates of a pair turned over, instead of on edge.

    Raises
    ------
    NoSteadyState
        If none is found, or only a collapsed one.
    """
    tow = steady_tow(model, point)
    if near is not None:
        here = at_velocity(near, tow.block_velocities.mean(0))
        state, iterations, residual = relax(
            model, here, tow, tolerance=FORCE_TOLERANCE, time_step=DRIFT_TIME_STEP_S
        )
    elif start is not None:
        state, iterations, residual = _from_known(model, start, tow)
    if (near is None and start is None) or (cold and residual > FORCE_TOLERANCE):
        state, iterations, residual = cold_start(
            model, point.heading, tow, lying=near is not None, turned=turned
        )
    where = _where(point)
    if residual > FORCE_TOLERANCE and cold and near is None:
        known = None if start is None else (start.point, start.state)
        try:
            state, residual = followed(model, point, where, known), 0.0
        except NoSteadyState as refusal:
            if refusal.reason != 'none found':
                raise
            # The last chance: boards may lie on their backs at every speed.
            state, iterations, residual = cold_start(model, point.heading, tow, lying=True)
            if residual > FORCE_TOLERANCE:
                raise
    if residual > FORCE_TOLERANCE:
        raise NoSteadyState(
            f'{where}: no steady state found in {iterations} iterations, with {residual:.3g} N left'
        )
    seen = observe(model, state, tow)
    attack = np.array([seen.port_attack, seen.starboard_attack])
    lift = outward_normal_lift(state)
    if not model.paired and (any(fallen_boards(state)) or attack.min() < 0.0):
        angles = ', '.join(f'{np.degrees(a):.1f}' for a in attack)
        lean = ', '.join(f'{np.degrees(np.arcsin(up)):.1f}' for up in lift)
        raise NoSteadyState(
            f'{where}: only a collapsed state was found: attack angles {angles}°, outward normals '
            f'{lean}° up',
            'collapsed',
        )
    low, high = model.board.law.range
    return Equilibrium(
        point=point,
        tow=tow,
        state=state,
        observables=seen,
        iterations=iterations,
        residual=residual,
        outside_law=not model.paired and bool(attack.max() > high or attack.min() < low),
        highest=highest_point(model, state),
    )


def _from_known(model: GearModel, start: Equilibrium, tow: Tow) -> tuple[State, int, float]:
    """Search from a known equilibrium: along its tangent, or after a shift along its warps."""
    iterations = 0
    if found := warm_start_in_parts(model, start.state, start.tow, tow, start.tangent):
        state, iterations, residual = found
        if residual <= FORCE_TOLERANCE:
            return found
    here = shifted_to(model, start.state, start.tow, tow)
    far = np.any(np.abs(tow.lengths / start.tow.lengths - 1.0) > FAR_WARP_CHANGE)
    ways = (WARM_TIME_STEP_S, WARM_ITERATIONS), (DRIFT_TIME_STEP_S, DRIFT_ITERATIONS)
    for time_step, limit in ways[::-1] if far else ways:
        state, more, residual = relax(
            model, here, tow, tolerance=FORCE_TOLERANCE, time_step=time_step, limit=limit
        )
        iterations += more
        if residual <= FORCE_TOLERANCE:
            break
    return state, iterations, residual


@dataclass(frozen=True)
class SteadyState:
    """Steady state: an equilibrium that is stable, under water and within the board's law.

    Attributes
    ----------
    equilibrium
        State of all nodes and boards, its operating point, and the residual force (N).
    stability
        Eigenvalues (1/s) of the slowest motions about it.

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> steady = trawl_ros.steady_state(model, 500.0, 2.1)
    >>> bool(steady.stability.eigenvalues.real.max() < 0.0)
    True
    >>> trawl_ros.steady_state(model, 510.0, 2.1, start=steady.equilibrium).equilibrium.point.speed
    2.1
    """

    equilibrium: Equilibrium
    stability: Stability

    @property
    def observables(self) -> Observables:
        """Observables of the state."""
        return self.equilibrium.observables


def steady_state(
    model: GearModel,
    warp_length: float | tuple[float, float],
    speed: float,
    *,
    heading: float = 0.0,
    start: Equilibrium | None = None,
    near: State | None = None,
) -> SteadyState:
    """Find the steady state at a warp length and speed.

    Parameters
    ----------
    model
        From `build_model`; effects of its gear file act, including those on counters and log.
    warp_length
        Unstretched length from the block to the board, m, as the counters show it; one for both
        sides or (port, starboard).
    speed
        Through the water at the surface, m/s, as the log shows it.
    heading
        ENU yaw, rad; it matters if there is a current.
    start
        Known equilibrium nearby, which makes the search fast.
    near
        Shape close to the wanted one, at this same operating point.

    Returns
    -------
    SteadyState
        With `observables` (m, N, rad), the `equilibrium` from which a neighbouring search can
        start, and its `stability`.

    Raises
    ------
    NoSteadyState
        If there is none, it is unstable, the gear breaks the surface, a board works outside the
        range of its law, or warps or speed are outside `LIMITS`.

    Examples
    --------
    >>> import trawl_ros
    >>> model = trawl_ros.build_model(trawl_ros.load_gear('kaifuha').refined(net=0.25))
    >>> seen = trawl_ros.steady_state(model, warp_length=500.0, speed=2.1).observables
    >>> print(f'{seen.door_spread:.0f} m apart, {seen.door_depth:.0f} m deep')
    156 m apart, 138 m deep
    """
    port, starboard = map(float, np.broadcast_to(np.asarray(warp_length, float), 2))
    if objection := LIMITS.objection((port, starboard), speed):
        raise NoSteadyState(objection)
    model, point = with_effects(model, (port, starboard), speed, heading)
    return find_usable(model, point, start, near)


@budgeted
def find_usable(
    model: GearModel,
    point: OperatingPoint,
    start: Equilibrium | None = None,
    near: State | None = None,
) -> SteadyState:
    """Find a root that meets the conditions of `steady_state`, with starts of `find_equilibrium`.

    Raises
    ------
    NoSteadyState
        Under the conditions of `steady_state`.
    """
    found = find_equilibrium(model, point, start, near=near)
    try:
        return require_usable(model, found)
    except NoSteadyState as refusal:
        if not (model.paired and refusal.reason == 'unstable'):
            raise
        # A plate between two backstrops balances on edge and lying, but is stable in one of them.
        # With a heavier upper bridle it turns over.
        try:
            return require_usable(model, find_equilibrium(model, point, turned=True))
        except NoSteadyState:
            pass
        try:
            return require_usable(model, find_equilibrium(model, point, near=_rolled(found.state)))
        except NoSteadyState:
            raise refusal from None


def _rolled(state: State) -> State:
    """Return the state with boards or plates rotated by 90° about their long axes."""
    return replace(state, board_rotations=state.board_rotations @ about_axis(0, np.pi / 2.0))


def with_effects(
    model: GearModel, lengths: tuple[float, float], speed: float, heading: float = 0.0
) -> tuple[GearModel, OperatingPoint]:
    """Apply the effects of the gear's file to the gear and to the shown warps and speed."""
    port, starboard = lengths
    effects = effects_of(model.gear)
    if effects:
        at = Situation((port, starboard, float(speed)), heading, sense(heading))
        port, starboard, speed = effects.apply_to_inputs(np.array(at.inputs), at)
        model = effects.gear(model, at)
    return model, OperatingPoint(float(port), float(starboard), float(speed), float(heading))


def require_usable(model: GearModel, found: Equilibrium) -> SteadyState:
    """Return the steady state of an equilibrium that meets the conditions of `steady_state`."""
    where = _where(found.point)
    if found.surfaced:
        raise NoSteadyState(
            f'{where}: the gear breaks the surface by {found.highest:.1f} m', 'surfaced'
        )
    if found.outside_law:
        seen, (low, high) = found.observables, np.degrees(model.board.law.range)
        both = np.degrees([seen.port_attack, seen.starboard_attack])
        attack = max(both, key=lambda angle: abs(angle - 0.5 * (low + high)))
        raise NoSteadyState(
            f'{where}: a board works at {attack:.1f}° of attack, outside the range of its law '
            f'({low:.0f} to {high:.0f}°)',
            'outside law',
            trim_command(model.gear, found.point, low + (high - low) / 3),
        )
    motion = stability(model, found.state, found.tow)
    if not motion.stable:
        worst = motion.eigenvalues[motion.eigenvalues.real.argmax()]
        mode = growing_mode(model, found.state, found.tow, worst)
        raise NoSteadyState(
            f'{where}: the steady state is unstable: {mode} grows by a factor e in '
            f'{1 / motion.growth:.0f} s',
            'unstable',
            remedy_command(model.gear, found.point),
        )
    return SteadyState(found, motion)


def _where(point: OperatingPoint) -> str:
    lengths = f'{point.port_length:g}'
    if point.port_length != point.starboard_length:
        lengths += f'/{point.starboard_length:g}'
    return f'warp {lengths} m at {point.speed:g} m/s'
