# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Derivatives of all observables at a steady state, by the implicit function theorem.

At a root F(x, p) = 0, so dx/dp = K⁻¹ ∂F/∂p with K = -∂F/∂x; one factorisation serves all
parameters. Partial derivatives use the complex step and C = -∂F/∂v, so the result is exact to the
accuracy of the linear solution.
"""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import forces
from trawl_ros.model.board import own_load_slopes
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.slopes.along import add_forces_along_tow
from trawl_ros.model.slopes.observed import observed_slopes
from trawl_ros.model.state import State, TowSlopes, held_boundary
from trawl_ros.records.channels import INPUTS
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.linear.factor import solve_refined
from trawl_ros.solver.rest_linearisation import rest_linearisation
from trawl_ros.solver.warm_start import Tangent


def _ahead(found: Equilibrium) -> FloatArray:
    heading = found.point.heading
    return np.array([np.cos(heading), np.sin(heading), 0.0])


def coefficient_pushes(model: GearModel, state: State) -> FloatArray:
    """Return derivatives (12, q) of the boards' own loads by the coefficients."""
    slopes: FloatArray = own_load_slopes(
        model.board,
        model.coefficients,
        OUTWARD,
        state.board_positions,
        state.board_rotations,
        state.board_velocities,
        state.board_rates,
        model.water,
    ).reshape(12, -1)
    return slopes


def sensitivities(model: GearModel, found: Equilibrium) -> FloatArray:
    """Return the derivatives of the observables by coefficients and towing inputs.

    Returns
    -------
    (n_observables, q + 3) array
        In the order of `OBSERVABLES`; by the q parameters of the boards' law, per unit, and by
        `INPUTS`, per m and per m/s.
    """
    number, state = len(model.coefficients), found.state
    pushes = np.zeros((model.dof, number + len(INPUTS)))
    # Coefficients change only the loads on the boards, the last twelve rows.
    pushes[-12:, :number] = coefficient_pushes(model, state)
    known = rest_linearisation(model, state, found.tow)
    velocities, boundary = _changed_motion(model, found, pushes.shape[1])
    add_forces_along_tow(model, state, found.tow, boundary, pushes)
    # The whole gear moves faster, so its drag changes by C times the velocity.
    pushes[:, -1] -= model.pattern.times(known.motion.damping, velocities[:, -1])
    shifts = solve_refined(known.factor, pushes)
    found.remember(Tangent(model.coefficients, model.rest, shifts))
    return observed_slopes(model, state, found.tow, shifts, velocities, boundary)[1]


def _changed_motion(
    model: GearModel, found: Equilibrium, number: int
) -> tuple[FloatArray, TowSlopes]:
    """Return the change of velocities (dof, number) and boundary with the parameters."""
    ahead = _ahead(found)
    velocities, boundary = np.zeros((model.dof, number)), held_boundary(number)
    boards = velocities[3 * model.nodes :].reshape(2, 6, number)
    velocities[: 3 * model.nodes, -1] = np.tile(ahead, model.nodes)
    boards[:, :3, -1] = ahead
    boundary.block_velocities[-1] = ahead
    boundary.lengths[-3:-1] = np.eye(2)
    return velocities, boundary


def net_sensitivities(model: GearModel, found: Equilibrium) -> FloatArray:
    """Return derivatives of the observables by factors on drag and weight in water of the net.

    Forces are linear in both, so differences are exact.

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
