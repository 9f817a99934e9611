"""Last states of a gear that is towed more and more slowly, and the reason why they end.

Where a search from nothing finds no steady state, one is found at a speed at which the gear does
tow, and its branch is followed to the speed asked for. Either it arrives, or it ends on the way:
in a fold, or with boards that lie over and have lost their hold.
"""

from dataclasses import replace

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.assembly import board_loads, forces
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.observables import lies_over, outward_normal_lift
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.cold_start import PRESSURE, bowed, cold_start
from trawl_ros.solver.continuation import BranchPoint, branch
from trawl_ros.solver.first_guess import ATTACK, LEAN, first_guess
from trawl_ros.solver.growing_mode import growing_mode
from trawl_ros.solver.modes import linearised_motion
from trawl_ros.solver.operating_point import OperatingPoint, remedy_command, steady_tow
from trawl_ros.solver.relax import (
    TOLERANCE,
    WARM_LIMIT,
    WARM_TIME_STEP,
    relax,
    without_attitude,
)
from trawl_ros.solver.stability import stability

USUAL = 2.1
"""Speed (m/s) at which gears are towed, from which slower ones are followed."""

FASTER = 1.2, 1.5
"""Multiples of the speed asked for at which a state is sought besides."""

STRIDE = 0.1
"""Change of speed (m/s) that counts as one along the branch."""

MOST = 60
"""Points along a branch after which it is given up."""

HELD_TOLERANCE = 1000.0
"""Force (N) left at which the shape of a gear with held boards is good enough."""

HELD_LIMIT = 300
"""Iterations after which such a shape is given up: boards whose forces are far from those of the
first guess have a long way to go."""

AT_REST = 1e-3
"""Point (1/s) around which the eigenvalue that vanishes in a fold is sought."""


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
        The operating point in words, with which messages begin.
    known
        Shape at another operating point; if that is the same but for a faster tow, its branch is
        followed rather than one from a cold start.

    Raises
    ------
    NoSteadyState
        If the branch ends before: with the last solved speed and what ends it.
    """
    if known is not None and point == replace(known[0], speed=point.speed):
        speed = known[0].speed
        state, _, residual = relax(
            model,
            known[1],
            steady_tow(model, known[0]),
            tolerance=TOLERANCE,
            time_step=WARM_TIME_STEP,
            limit=WARM_LIMIT,
        )
        if speed > point.speed and residual <= TOLERANCE and not lies_over(model, state):
            return _followed(model, point, where, speed, state)
    tried = []
    for speed in sorted({max(USUAL, FASTER[0] * point.speed), FASTER[1] * point.speed}):
        tow = steady_tow(model, replace(point, speed=speed))
        state, _, residual = cold_start(model, point.heading, tow)
        if residual <= TOLERANCE and not lies_over(model, state):
            return _followed(model, point, where, speed, state)
        tried.append(f'{speed:.2g}')
    if not model.paired and (unbalanced := _imbalance(model, point)):
        speeds = ' or '.join(tried)
        raise NoSteadyState(
            f'{where}: boards do not stay upright, nor at {speeds} m/s: {unbalanced}', 'no balance'
        )
    upright = '' if model.paired else ' one with upright boards'
    raise NoSteadyState(f'{where}: no steady state found, nor{upright} at {" or ".join(tried)} m/s')


def _imbalance(model: GearModel, point: OperatingPoint) -> str:
    """Moments that turn boards which are held upright, in words; '' where no shape is found."""
    tow = steady_tow(model, point)
    loose = bowed(model, PRESSURE)
    state, _, residual = relax(
        loose,
        first_guess(model, tow, point.heading),
        tow,
        tolerance=HELD_TOLERANCE,
        time_step=2.0,
        free=without_attitude(model),
        limit=HELD_LIMIT,
    )
    if residual > HELD_TOLERANCE:
        return ''
    port = forces(loose, state, tow)[3 * model.nodes :].reshape(2, 6)[0]
    roll, pitch, yaw = state.board_rotations[0].T @ port[3:] / 1000.0
    return (
        f'held at {np.degrees(ATTACK):.0f}° of attack and {np.degrees(LEAN):.0f}° of lean each is '
        f'turned by {roll:.1f} kN m upward, {pitch:.1f} kN m nose down and {yaw:.1f} kN m outward'
    )


def _followed(
    model: GearModel, point: OperatingPoint, where: str, speed: float, state: State
) -> State:
    def family(value: float) -> tuple[GearModel, Tow]:
        return model, steady_tow(model, replace(point, speed=value))

    first = last = None
    for count, here in enumerate(branch(family, speed, state, scale=-STRIDE)):
        first, last, before = first or here, here, last
        if here.value <= point.speed:
            _, tow = family(point.speed)
            arrived, _, residual = relax(
                model,
                here.state,
                tow,
                tolerance=TOLERANCE,
                time_step=WARM_TIME_STEP,
                limit=WARM_LIMIT,
            )
            if residual > TOLERANCE:
                break
            return arrived
        if here.rate < 0.0 and before is not None:
            slow, _ = linearised_motion(model, before.state, before.tow).nearest(
                AT_REST, 1, tolerance=1e-3
            )
            least = slow[0].real if len(slow) else np.nan
            raise NoSteadyState(
                f'{where}: no steady state below {before.value:.3f} m/s, where the branch from '
                f'{speed:.3g} m/s folds back, smallest eigenvalue {least:.2g} 1/s',
                'fold',
            )
        if lies_over(model, here.state):
            raise NoSteadyState(
                f'{where}: {_lift_lost(first, here)}',
                'lift lost',
                remedy_command(model.gear, point),
            )
        if count == MOST:
            break
    assert last is not None
    raise NoSteadyState(
        f'{where}: no steady state found, the branch from {speed:.3g} m/s was followed to '
        f'{last.value:.3f} m/s'
    )


def _lift_lost(first: BranchPoint, last: BranchPoint) -> str:
    """Balance of the boards' forces where they lie over, beside that of the faster tow."""
    lean = np.degrees(np.arcsin(np.abs(outward_normal_lift(last.state)).max()))
    outward = [_outward(first), _outward(last)]
    sentence = (
        f'boards lie over: at {last.value:.3f} m/s they lean by {lean:.0f}° and push outward with '
        f'{outward[1]:.1f} kN, at {first.value:.3g} m/s with {outward[0]:.1f} kN'
    )
    motion = stability(last.model, last.state, last.tow)
    if not motion.stable:
        worst = motion.eigenvalues[np.argmax(motion.eigenvalues.real)]
        mode = growing_mode(last.model, last.state, last.tow, worst)
        sentence += f'; {mode} grows by a factor e in {1.0 / motion.growth:.0f} s'
    return sentence


def _outward(here: BranchPoint) -> float:
    """Mean force (kN) with which water and weight push the boards away from the net's middle."""
    ahead = here.tow.block_velocities.mean(0)
    to_port = np.array([-ahead[1], ahead[0], 0.0]) / np.hypot(ahead[0], ahead[1])
    loads = board_loads(here.model, here.state)[:, :3]
    return float((OUTWARD * (loads @ to_port)).mean() / 1000.0)
