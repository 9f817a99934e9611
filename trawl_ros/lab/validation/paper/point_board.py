"""Point board of Fig. 13 to 16: a 3-DOF board with constant coefficients.

A board whose lines all end in its centre of gravity, whose coefficients do not depend on its
angles and which is held in its attitude is a point with constant lift and drag. Everything else
of the gear stays as it is, and so do its equations.
"""

from dataclasses import replace

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.model.board import coefficients_at
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import Observables
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.first_guess import attitudes
from trawl_ros.solver.relax import FORCE_TOLERANCE, relax, without_attitude

FORCES = ('c1', 'c2', 'c3')
"""Constants of eq. 14 that are C_x^F, C_y^F and C_z^F where the slopes are zero."""


def point_board(model: GearModel, attack: float, slip: float) -> GearModel:
    """Return the gear with boards that are points.

    Parameters
    ----------
    attack, slip
        α and β (rad) at which their constant force coefficients are read off eq. 14.
    """
    values = coefficients_at(model.coefficients, np.float64(attack), np.float64(slip))
    constants = np.zeros(len(COEFFICIENTS))
    constants[[COEFFICIENTS.index(name) for name in FORCES]] = values[:3]
    return model.with_coefficients(constants).with_board(points=np.zeros((3, 3)))


def point_observables(
    model: GearModel, near: Equilibrium, attack: float, lean: float = 0.0
) -> Observables:
    """Observables of a gear from `point_board` at the operating point of ``near``.

    Parameters
    ----------
    near
        The gear with boards of six degrees of freedom: where the search starts.
    attack
        Attack angle of the boards, rad, inside the range of their law; it has no effect.
    lean
        Angle (rad) by which lift is tipped up; a point has none, its lift is level.

    Raises
    ------
    NoSteadyState
        If no root is found.
    """
    start = replace(near.state, board_rotations=attitudes(attack, 0.0, lean))
    state, iterations, residual = relax(
        model,
        start,
        near.tow,
        tolerance=FORCE_TOLERANCE,
        time_step=5.0,
        free=without_attitude(model),
    )
    if residual > FORCE_TOLERANCE:
        raise NoSteadyState(
            f'warp {near.point.port_length:g} m at {near.point.speed:g} m/s, boards as points: '
            f'no steady state found in {iterations} iterations, {residual:.3g} N left'
        )
    return observe(model, state, near.tow)
