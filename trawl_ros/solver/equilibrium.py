"""Quasi-steady states: roots of the forces, found by Newton with pseudo-transient continuation.

Each step is one implicit Euler step from rest, (M/τ² + C/τ + K) δ = F, with a time step τ that
grows while steps stay small; at τ = ∞ it is Newton's. Real mass and drag let the gear drift to
a state it would also reach at sea, rather than to any root near the start.
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.errors import NoSteadyState
from trawl_ros.model.assembly import forces, linearised, mass
from trawl_ros.model.board import LAW_RANGE
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import (
    Observables,
    highest_point,
    observe,
    outward_normal_lift,
)
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.factor import Factor, factorised
from trawl_ros.solver.first_guess import (
    at_velocity,
    carried_over,
    coarser_model,
    first_guess,
    shifted_to,
    softened,
)
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow
from trawl_ros.solver.stability import Stability, stability

TOLERANCE = 1e-4
"""Largest force (N) or moment (N m) left at a root; the last Newton step goes far below."""

WARM_LIMIT = 60
"""Iterations after which a warm start is given up for a cold one."""

WARM_TIME_STEP = 1e3
"""First time step (s) from a known state nearby: nearly Newton's own."""

LIMIT_METRES, LIMIT_RADIANS = 10.0, 0.1
"""Largest step of a node or board, and of a board's attitude."""

HEAVY = 1e2
"""Time step (s) from which mass is too little to matter beside drag and stiffness."""

KEEP_RATE, KEEP_SIZE = 0.25, 0.02
"""A factorised matrix serves again after a step of at most this share of the limits, while it
brings the force down to this share at least."""

COLLAPSED_NORMAL = -0.2
"""Vertical part of a board's outward normal below which it has fallen on its face."""


@dataclass(frozen=True)
class Equilibrium:
    """A root of the forces.

    ``state`` is in ``map`` axes with the ship at the origin; ``outside_law`` says that a board
    works outside the range of eq. 14; ``highest`` is the height (m) of the gear's highest
    point, positive when it breaks the surface.
    """

    point: OperatingPoint
    tow: Tow
    state: State
    observables: Observables
    iterations: int
    residual: float
    outside_law: bool
    highest: float

    @property
    def surfaced(self) -> bool:
        """Whether gear breaks the surface."""
        return self.highest > 0.0


def find_equilibrium(
    model: GearModel,
    point: OperatingPoint,
    start: Equilibrium | None = None,
    *,
    near: State | None = None,
) -> Equilibrium:
    """Find the root at an operating point: warm from ``start``, from the shape ``near``
    at this very point, or cold.

    Raises
    ------
    NoSteadyState
        When none is found, or only a collapsed one.
    """
    tow = steady_tow(model, point)
    if near is not None:
        here = at_velocity(near, tow.block_velocities.mean(0))
        state, iterations, residual = relax(model, here, tow, tolerance=TOLERANCE, time_step=10.0)
    elif start is not None:
        state, iterations, residual = relax(
            model,
            shifted_to(model, start.state, start.tow, tow),
            tow,
            tolerance=TOLERANCE,
            time_step=WARM_TIME_STEP,
            limit=WARM_LIMIT,
        )
    if (near is None and start is None) or residual > TOLERANCE:
        state, iterations, residual = _cold(model, point, tow)
    where = _where(point)
    if residual > TOLERANCE:
        raise NoSteadyState(
            f'{where}: no steady state found in {iterations} iterations, {residual:.3g} N left'
        )
    seen = observe(model, state, tow)
    attack = np.array([seen.port_attack, seen.starboard_attack])
    lift = outward_normal_lift(state)
    if lift.min() < COLLAPSED_NORMAL or attack.min() < 0.0:
        angles = ', '.join(f'{np.degrees(a):.1f}' for a in attack)
        lean = ', '.join(f'{np.degrees(np.arcsin(up)):.1f}' for up in lift)
        raise NoSteadyState(
            f'{where}: only a collapsed state was found, attack angles {angles}°, outward normals '
            f'{lean}° up',
            'collapsed',
        )
    return Equilibrium(
        point=point,
        tow=tow,
        state=state,
        observables=seen,
        iterations=iterations,
        residual=residual,
        outside_law=bool(attack.max() > LAW_RANGE[1]),
        highest=highest_point(model, state),
    )


def _cold(model: GearModel, point: OperatingPoint, tow: Tow) -> tuple[State, int, float]:
    """From the shape of a coarser net or, for the coarsest, from a first guess.

    Unequal warps are reached from equal ones: the boards' first attitudes are equal too.
    """
    even = replace(tow, lengths=np.full(2, tow.lengths.mean()))
    soft = softened(model)
    coarse = coarser_model(model)
    spent = 0
    if coarse is None:
        state = first_guess(model, even, point.heading)
        # Boards keep their attitude until ropes and net have found a shape.
        held = without_attitude(model)
        state, spent, _ = relax(
            soft, state, even, tolerance=1000.0, time_step=2.0, free=held, limit=120
        )
    else:
        state, spent, residual = _cold(coarse, point, even)
        if residual > TOLERANCE:
            return state, spent, residual
        state = carried_over(coarse, state, model)
    state, more, _ = relax(soft, state, even, tolerance=100.0, time_step=1.0, limit=200)
    state, most, residual = relax(model, state, even, tolerance=TOLERANCE, time_step=1.0)
    spent += more + most
    if residual > TOLERANCE or tow.lengths[0] == tow.lengths[1]:
        return state, spent, residual
    state, more, residual = relax(
        model, shifted_to(model, state, even, tow), tow, tolerance=TOLERANCE, time_step=2.0
    )
    return state, spent + more, residual


@dataclass(frozen=True)
class SteadyState:
    """An equilibrium that was found usable: stable, under water, within the board's law."""

    equilibrium: Equilibrium
    stability: Stability

    @property
    def observables(self) -> Observables:
        """What can be seen of it."""
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
    """The steady state at a warp length and speed, or the reason why there is none.

    Parameters
    ----------
    model
        From `build_model`.
    warp_length
        Unstretched length from the block to the board, m; one for both sides or (port,
        starboard).
    speed
        Through the water at the surface, m/s.
    heading
        ENU yaw, rad; matters when there is a current.
    start
        A known equilibrium nearby, which makes this fast.
    near
        A shape close to the one sought, at this very operating point.

    Raises
    ------
    NoSteadyState
        There is none, it is unstable, the gear breaks the surface, or a board works outside
        the range of its law.
    """
    port, starboard = np.broadcast_to(np.asarray(warp_length, float), 2)
    point = OperatingPoint(float(port), float(starboard), float(speed), float(heading))
    return require_usable(model, find_equilibrium(model, point, start, near=near))


def require_usable(model: GearModel, found: Equilibrium) -> SteadyState:
    """Check an equilibrium for what `steady_state` promises."""
    where = _where(found.point)
    if found.surfaced:
        raise NoSteadyState(
            f'{where}: the gear breaks the surface by {found.highest:.1f} m', 'surfaced'
        )
    if found.outside_law:
        attack = np.degrees(max(found.observables.port_attack, found.observables.starboard_attack))
        raise NoSteadyState(
            f'{where}: a board works at {attack:.1f}° of attack, outside the '
            f'range of its law ({np.degrees(LAW_RANGE[1]):.0f}°)',
            'outside law',
        )
    motion = stability(model, found.state, found.tow)
    if not motion.stable:
        raise NoSteadyState(
            f'{where}: the steady state is unstable, it grows by a factor e in '
            f'{1 / motion.growth:.0f} s',
            'unstable',
        )
    return SteadyState(found, motion)


def relax(
    model: GearModel,
    state: State,
    tow: Tow,
    *,
    tolerance: float,
    time_step: float,
    free: np.ndarray | None = None,
    limit: int = 300,
) -> tuple[State, int, float]:
    """Drive the forces to zero.

    Parameters
    ----------
    free
        Mask (dof,) of what may move; all by default.
    limit
        Iterations after which the search is given up.

    Returns
    -------
    state, iterations, residual
        The residual is the largest force or moment left.
    """
    tau = time_step
    n = model.nodes
    iteration = 0
    last = np.inf
    factor: Factor | None = None
    while True:
        if factor is None:
            here = linearised(model, state, tow)
            force = here.force
        else:
            force = forces(model, state, tow)
        if free is not None:
            force = np.where(free, force, 0.0)
        residual = float(np.abs(force).max())
        if residual < tolerance or iteration == limit or not np.isfinite(residual):
            return state, iteration, residual
        if factor is not None and residual > KEEP_RATE * last:
            factor = None
            continue
        iteration += 1
        if factor is None:
            data = here.stiffness + here.damping / tau
            if tau < HEAVY:
                data += mass(model, state, tow) / tau**2
            try:
                factor = factorised(
                    model.pattern, data if free is None else model.pattern.held(data, free)
                )
            except RuntimeError:  # singular: a shorter time step adds mass and drag
                tau /= 4.0
                continue
        step = factor.solve(force)
        body = step[3 * n :].reshape(2, 6)
        size = max(np.abs(step[: 3 * n]).max(), np.abs(body[:, :3]).max()) / LIMIT_METRES
        size = max(size, np.abs(body[:, 3:]).max() / LIMIT_RADIANS)
        # Bars that flip between slack and taut raise the residual and ask for shorter steps.
        growth = 3.0 if residual < last else max(0.25, last / residual)
        tau = max(tau / 1.5, 0.3) if size > 1.0 else min(max(growth * tau, 0.3), 1e9)
        if size > KEEP_SIZE:
            factor = None
        last = residual
        state = state.moved(step / max(size, 1.0))


def without_attitude(model: GearModel) -> np.ndarray:
    """Mask (dof,) of everything but the boards' attitudes."""
    free = np.ones(model.dof, bool)
    free[3 * model.nodes :].reshape(2, 6)[:, 3:] = False
    return free


def _where(point: OperatingPoint) -> str:
    lengths = f'{point.port_length:g}'
    if point.port_length != point.starboard_length:
        lengths += f'/{point.starboard_length:g}'
    return f'warp {lengths} m at {point.speed:g} m/s'
