"""Derivatives of every observable at a steady state, by the implicit function theorem.

At a root F(x, p) = 0, so dx/dp = K⁻¹ ∂F/∂p with K = -∂F/∂x; one factorisation serves all
parameters. The partial derivatives and the observables along dx/dp are taken by the complex
step, so the result is exact to the accuracy of the linear solution.
"""

from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import board_loads, forces
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP, stepped
from trawl_ros.model.slopes.observed import observed_slopes
from trawl_ros.model.state import State, Tow, TowSlopes, held_boundary
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.factor import solve_refined
from trawl_ros.solver.rest_linearisation import rest_linearisation
from trawl_ros.solver.warm_start import Tangent

PARAMETERS = (*COEFFICIENTS, 'port_length', 'starboard_length', 'speed')
"""Parameters of the derivatives: per unit coefficient, per m, per m, per m/s."""


def _perturbed(model: GearModel, found: Equilibrium, index: int) -> tuple[GearModel, State, Tow]:
    """Model, state and tow with parameter ``index`` perturbed by an imaginary step."""
    state, tow = found.state, found.tow
    if index < len(COEFFICIENTS):
        values = model.coefficients.astype(complex)
        values[index] += 1j * STEP
        return model.with_coefficients(values), state, tow
    side = index - len(COEFFICIENTS)
    if side < 2:
        lengths = tow.lengths.astype(complex)
        lengths[side] += 1j * STEP
        return model, state, replace(tow, lengths=lengths)
    ahead = _ahead(found)
    return (
        model,
        replace(
            state,
            node_velocities=stepped(state.node_velocities, ahead),
            board_velocities=stepped(state.board_velocities, ahead),
        ),
        replace(tow, block_velocities=stepped(tow.block_velocities, ahead)),
    )


def _ahead(found: Equilibrium) -> FloatArray:
    heading = found.point.heading
    return np.array([np.cos(heading), np.sin(heading), 0.0])


def sensitivities(model: GearModel, found: Equilibrium) -> FloatArray:
    """Derivatives of the observables by the parameters.

    Returns
    -------
    (n_observables, n_parameters) array
        In the orders of `OBSERVABLES` and `PARAMETERS`.
    """
    moved = [_perturbed(model, found, index) for index in range(len(PARAMETERS))]
    pushes = np.zeros((model.dof, len(PARAMETERS)))
    boards = slice(model.dof - 12, None)
    for index, (changed, state, tow) in enumerate(moved):
        if index < len(COEFFICIENTS):
            # Coefficients push the boards and nothing else.
            pushes[boards, index] = board_loads(changed, state).imag.ravel() / STEP
        else:
            pushes[:, index] = forces(changed, state, tow).imag / STEP
    shifts = solve_refined(rest_linearisation(model, found.state, found.tow).factor, pushes)
    found.remember(Tangent(model.coefficients, model.rest, shifts))
    along = shifts, *_changed_motion(model, found)
    return observed_slopes(model, found.state, found.tow, *along)[1]


def _changed_motion(model: GearModel, found: Equilibrium) -> tuple[FloatArray, TowSlopes]:
    """Change of velocities (dof, n_parameters) and boundary with the parameters."""
    number, ahead = len(PARAMETERS), _ahead(found)
    velocities, boundary = np.zeros((model.dof, number)), held_boundary(number)
    boards = velocities[3 * model.nodes :].reshape(2, 6, number)
    velocities[: 3 * model.nodes, -1] = np.tile(ahead, model.nodes)
    boards[:, :3, -1] = ahead
    boundary.block_velocities[-1] = ahead
    boundary.lengths[-3:-1] = np.eye(2)
    return velocities, boundary


def net_sensitivities(model: GearModel, found: Equilibrium) -> FloatArray:
    """Derivatives of the observables by factors on drag and weight in water of the net.

    Forces are linear in both, so their derivatives are differences.

    Returns
    -------
    (n_observables, 2) array
        In the order of `OBSERVABLES`; of drag, then of weight, per unit factor.
    """
    at = model, found.state, found.tow
    here = forces(*at)
    pushes = np.column_stack(
        [forces(model.with_net(*twice), *at[1:]) - here for twice in ((2.0, 1.0), (1.0, 2.0))]
    )
    shifts = solve_refined(rest_linearisation(*at).factor, pushes)
    return observed_slopes(model, found.state, found.tow, shifts)[1]
