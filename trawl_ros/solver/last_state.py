# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady states followed to lower speeds, and the reason why they end.

Where a cold start finds no steady state, one is found at a higher speed and its branch is followed
to the wanted speed. It may end on the way: in a fold, or with boards that lie over and have lost
their lift.
"""

from dataclasses import replace

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.assembly import board_loads, forces
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.observables import lies_over, outward_normal_lift
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.cold_start import BOW_PRESSURE_PA, bowed, cold_start
from trawl_ros.solver.continuation import BranchPoint, branch
from trawl_ros.solver.first_guess import FIRST_ATTACK, FIRST_LEAN, first_guess
from trawl_ros.solver.modes import linearised_motion
from trawl_ros.solver.operating_point import OperatingPoint, remedy_command, steady_tow
from trawl_ros.solver.relax import FORCE_TOLERANCE, relax, relax_warm, without_attitude
from trawl_ros.solver.stability import growing_mode, stability

TOWING_SPEED_M_S = 2.1
"""Usual towing speed, from which slower states are followed."""

FASTER = 1.2, 1.5
"""Multiples of the wanted speed from which its state is followed otherwise."""

SPEED_SCALE_M_S = 0.1
"""Change of speed that counts as one step along the branch."""

MAX_BRANCH_POINTS = 60
"""Points along a branch after which it is given up."""

HELD_FORCE_N, HELD_ITERATIONS = 1000.0, 300
"""Force left at which the shape with held boards is accepted, and iterations until it is given up:
boards with forces far from those of the first guess need many."""

FOLD_SHIFT = 1e-3
"""Shift (1/s) near the eigenvalue that vanishes in a fold."""


def followed(
    model: GearModel,
    point: OperatingPoint,
    where: str,
    known: tuple[OperatingPoint, State] | None = None,
) -> State:
    """Follow the steady state from a faster tow to an operating point.

    Parameters
    ----------
    where
        The operating point in words, at the beginning of messages.
    known
        Shape at another operating point. If it differs only by a higher speed, its branch is
        followed instead of one from a cold start.

    Raises
    ------
    NoSteadyState
        If the branch ends before the point: with the last solved speed and the reason.
    """
    if known is not None and point == replace(known[0], speed=point.speed):
        speed = known[0].speed
        state, _, residual = relax_warm(model, known[1], steady_tow(model, known[0]))
        if speed > point.speed and residual <= FORCE_TOLERANCE and not lies_over(model, state):
            return _followed(model, point, where, speed, state)
    tried = []
    for speed in sorted({max(TOWING_SPEED_M_S, FASTER[0] * point.speed), FASTER[1] * point.speed}):
        tow = steady_tow(model, replace(point, speed=speed))
        state, _, residual = cold_start(model, point.heading, tow)
        if residual <= FORCE_TOLERANCE and not lies_over(model, state):
            return _followed(model, point, where, speed, state)
        tried.append(f'{speed:.2g}')
    if not model.paired and (unbalanced := _imbalance(model, point)):
        speeds = ' or '.join(tried)
        raise NoSteadyState(
            f'{where}: the boards do not stay upright, and neither at {speeds} m/s; {unbalanced}',
            'no balance',
        )
    upright = '' if model.paired else ' with upright boards'
    raise NoSteadyState(
        f'{where}: no steady state found, and none{upright} at {" or ".join(tried)} m/s'
    )


def _imbalance(model: GearModel, point: OperatingPoint) -> str:
    """Describe the moments on boards that are held upright; '' where no shape is found."""
    tow = steady_tow(model, point)
    loose = bowed(model, BOW_PRESSURE_PA)
    state, _, residual = relax(
        loose,
        first_guess(model, tow, point.heading),
        tow,
        tolerance=HELD_FORCE_N,
        time_step=2.0,
        free=without_attitude(model),
        limit=HELD_ITERATIONS,
    )
    if residual > HELD_FORCE_N:
        return ''
    port = forces(loose, state, tow)[3 * model.nodes :].reshape(2, 6)[0]
    roll, pitch, yaw = state.board_rotations[0].T @ port[3:] / 1000.0
    return (
        f'moments on each board, held at {np.degrees(FIRST_ATTACK):.0f}° of attack and '
        f'{np.degrees(FIRST_LEAN):.0f}° of lean: {roll:.1f} kN m upward, {pitch:.1f} kN m nose '
        f'down and {yaw:.1f} kN m outward'
    )


def _followed(
    model: GearModel, point: OperatingPoint, where: str, speed: float, state: State
) -> State:
    def family(value: float) -> tuple[GearModel, Tow]:
        return model, steady_tow(model, replace(point, speed=value))

    first = last = None
    for count, here in enumerate(branch(family, speed, state, scale=-SPEED_SCALE_M_S)):
        first, last, before = first or here, here, last
        if here.value <= point.speed:
            _, tow = family(point.speed)
            arrived, _, residual = relax_warm(model, here.state, tow)
            if residual > FORCE_TOLERANCE:
                break
            return arrived
        if here.rate < 0.0 and before is not None:
            slow, _ = linearised_motion(model, before.state, before.tow).nearest(
                FOLD_SHIFT, 1, tolerance=1e-3
            )
            least = slow[0].real if len(slow) else np.nan
            raise NoSteadyState(
                f'{where}: no steady state below {before.value:.3f} m/s, where the branch from '
                f'{speed:.3g} m/s folds back; its smallest eigenvalue is {least:.2g} 1/s',
                'fold',
            )
        if lies_over(model, here.state):
            raise NoSteadyState(
                f'{where}: {_lift_lost(first, here)}',
                'lift lost',
                remedy_command(model.gear, point),
            )
        if count == MAX_BRANCH_POINTS:
            break
    assert last is not None
    raise NoSteadyState(
        f'{where}: no steady state found; the branch from {speed:.3g} m/s was followed to '
        f'{last.value:.3f} m/s'
    )


def _lift_lost(first: BranchPoint, last: BranchPoint) -> str:
    """Compare the boards' forces where they lie over with those of the faster tow."""
    lean = np.degrees(np.arcsin(np.abs(outward_normal_lift(last.state)).max()))
    outward = [_outward(first), _outward(last)]
    sentence = (
        f'the boards lie over: at {last.value:.3f} m/s they lean by {lean:.0f}° and push outward '
        f'with {outward[1]:.1f} kN, compared with {outward[0]:.1f} kN at {first.value:.3g} m/s'
    )
    motion = stability(last.model, last.state, last.tow)
    if not motion.stable:
        worst = motion.eigenvalues[np.argmax(motion.eigenvalues.real)]
        mode = growing_mode(last.model, last.state, last.tow, worst)
        sentence += f'; {mode} grows by a factor e in {1.0 / motion.growth:.0f} s'
    return sentence


def _outward(here: BranchPoint) -> float:
    """Return the mean outward force (kN) of water and weight on the boards."""
    ahead = here.tow.block_velocities.mean(0)
    to_port = np.array([-ahead[1], ahead[0], 0.0]) / np.hypot(ahead[0], ahead[1])
    loads = board_loads(here.model, here.state)[:, :3]
    return float((OUTWARD * (loads @ to_port)).mean() / 1000.0)
