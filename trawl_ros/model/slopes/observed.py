# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Observables of a state and their derivatives along directions, in one pass."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP, stepped
from trawl_ros.model.observables import observe, observed_nodes, observed_values
from trawl_ros.model.rotations import rotation
from trawl_ros.model.state import State, Tow, TowSlopes, held_boundary


def observed_slopes(
    model: GearModel,
    state: State,
    tow: Tow,
    places: FloatArray,
    velocities: FloatArray | None = None,
    boundary: TowSlopes | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return observables (n_observables,) and their derivatives (n_observables, m).

    Parameters
    ----------
    model, state, tow
        Gear, its state and boundary.
    places
        Directions (dof, m): metres, and rotation vectors of boards in fixed axes.
    velocities
        Change (dof, m) of the velocities along them; none by default.
    boundary
        Change of the towing boundary along them; none by default.
    """
    number = places.shape[1]
    if not number:
        values = observe(model, state, tow).array()
        return values, np.zeros((len(values), 0))
    velocities = np.zeros_like(places) if velocities is None else velocities
    boundary = held_boundary(number) if boundary is None else boundary
    there = Tow(
        stepped(tow.blocks, boundary.blocks),
        stepped(tow.block_velocities, boundary.block_velocities),
        stepped(tow.lengths, boundary.lengths),
        stepped(tow.length_rates, boundary.length_rates),
    )
    found = observed_values(model, _stepped_states(model, state, places, velocities), there)
    return found[0].real, found.T.imag / STEP


def _stepped_states(
    model: GearModel, state: State, places: FloatArray, velocities: FloatArray
) -> State:
    """Return states with a complex step along each direction, with the `observed_nodes` only."""
    n, number, at = model.nodes, places.shape[1], observed_nodes(model)
    rows = (3 * at[:, None] + np.arange(3)).ravel()
    shifted, going = (part[rows].T.reshape(number, -1, 3) for part in (places, velocities))
    moved, rates = (part[3 * n :].T.reshape(number, 2, 6) for part in (places, velocities))
    turns = rotation(stepped(np.zeros(3), moved[..., 3:]))
    return State(
        nodes=stepped(state.nodes[at], shifted),
        board_positions=stepped(state.board_positions, moved[..., :3]),
        board_rotations=turns @ state.board_rotations,
        node_velocities=stepped(state.node_velocities[at], going),
        board_velocities=stepped(state.board_velocities, rates[..., :3]),
        board_rates=stepped(state.board_rates, rates[..., 3:]),
    )
