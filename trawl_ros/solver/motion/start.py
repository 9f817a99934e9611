"""Derivatives of a tow's beginning: an equilibrium of its first inputs, and slow motions in it."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow, TowSlopes
from trawl_ros.solver.linear.factor import solve_refined
from trawl_ros.solver.modes import linearised_motion
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.slopes import MotionSlopes
from trawl_ros.solver.rest_linearisation import rest_linearisation

SEARCHED = 6
"""Modes that are sought beyond those asked for: swings come in pairs, and some may be missed."""


def starting_slopes(
    model: GearModel,
    state: State,
    tow: Tow,
    parameters: MotionParameters,
    boundary: TowSlopes,
    push: FloatArray,
) -> MotionSlopes:
    """Derivatives of the equilibrium that a tow begins in.

    Parameters
    ----------
    model, state, tow
        The equilibrium.
    parameters
        Of the derivatives.
    boundary
        Derivatives of the boundary there. The whole gear goes with the blocks.
    push
        Derivatives (dof, m) of the forces, by the boundary too, all motion held.

    Raises
    ------
    NoSteadyState
        If the gear has fewer slow motions than are asked for.
    """
    known = rest_linearisation(model, state, tow)
    n, number = model.nodes, len(parameters)
    along = boundary.block_velocities.mean(axis=1).T
    velocities = np.zeros((model.dof, number))
    velocities[: 3 * n] = np.tile(along, (n, 1))
    velocities[3 * n :].reshape(2, 6, number)[:, :3] = along
    pattern, motion = model.pattern, known.motion
    right = push - pattern.matrix(motion.damping) @ velocities
    slopes = MotionSlopes(
        solve_refined(known.factor, right), velocities, *np.zeros((2, model.dof, number))
    )
    if parameters.motions:
        rates, shapes = slow_motions(model, state, tow, parameters.motions)
        own = parameters.of_motions
        slopes.places[:, own] = shapes
        slopes.velocities[:, own] = shapes * rates
        slopes.accelerations[:, own] = slopes.averaged[:, own] = shapes * rates**2
    return slopes


def slow_motions(
    model: GearModel, state: State, tow: Tow, number: int
) -> tuple[FloatArray, FloatArray]:
    """Slowest motions that die out without swinging: rates (k,), 1/s, and shapes (dof, k) of which
    the largest displacement of a node is a metre.

    Raises
    ------
    NoSteadyState
        If there are fewer of them.
    """
    wanted = number + SEARCHED
    motion = linearised_motion(model, state, tow)
    rates, vectors = motion.nearest(0.0, wanted, tolerance=1e-8)
    still = np.abs(rates.imag) <= 1e-6 * np.abs(rates)
    quiet = np.flatnonzero(still & (rates.real < 0.0))
    if len(quiet) < number:
        raise NoSteadyState(
            f'found {len(quiet)} slow motions of the gear that die out, expected {number}'
        )
    chosen = quiet[np.argsort(-rates.real[quiet])[:number]]
    shapes = vectors[:, chosen].real
    sizes = np.abs(shapes[: 3 * model.nodes]).max(axis=0)
    signs = np.sign(shapes[np.abs(shapes[: 3 * model.nodes]).argmax(axis=0), range(number)])
    return rates.real[chosen], shapes * signs / sizes
