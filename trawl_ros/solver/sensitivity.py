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
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES
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
    ahead = np.array([np.cos(found.point.heading), np.sin(found.point.heading), 0.0])
    return (
        model,
        replace(
            state,
            node_velocities=stepped(state.node_velocities, ahead),
            board_velocities=stepped(state.board_velocities, ahead),
        ),
        replace(tow, block_velocities=stepped(tow.block_velocities, ahead)),
    )


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
    found.remember(Tangent(model.coefficients, shifts))
    result = np.empty((len(OBSERVABLES), len(PARAMETERS)))
    for index, (changed, state, tow) in enumerate(moved):
        along = state.moved(stepped(np.zeros(model.dof), shifts[:, index]))
        result[:, index] = observe(changed, along, tow).array().imag / STEP
    return result


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
    return np.column_stack(
        [
            observe(model, found.state.moved(1j * STEP * shift), found.tow).array().imag / STEP
            for shift in shifts.T
        ]
    )
