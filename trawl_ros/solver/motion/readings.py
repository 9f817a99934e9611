"""Observables of a gear in motion and their derivatives."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import STEP, stepped
from trawl_ros.model.observables import observe, observed_nodes
from trawl_ros.model.rotations import rotation
from trawl_ros.model.state import State, Tow, TowSlopes
from trawl_ros.solver.motion.slopes import MotionSlopes


@dataclass(frozen=True)
class MotionPrediction:
    """Observables (n_observables,) of an instant and their derivatives (n_observables, m)."""

    values: FloatArray
    slopes: FloatArray


def observed_slopes(
    model: GearModel, state: State, tow: Tow, slopes: MotionSlopes, boundary: TowSlopes
) -> MotionPrediction:
    """Observables and their derivatives along those of motion and boundary."""
    if not slopes.places.shape[1]:
        values = observe(model, state, tow).array()
        return MotionPrediction(values, np.zeros((len(values), 0)))
    there = Tow(
        stepped(tow.blocks, boundary.blocks),
        stepped(tow.block_velocities, boundary.block_velocities),
        stepped(tow.lengths, boundary.lengths),
        stepped(tow.length_rates, boundary.length_rates),
    )
    found = observe(model, _stepped_state(model, state, slopes), there).array()
    return MotionPrediction(found[:, 0].real, found.imag / STEP)


def _stepped_state(model: GearModel, state: State, slopes: MotionSlopes) -> State:
    """State stepped along all directions at once; nodes that nothing is read of stay at nought."""
    n, number = model.nodes, slopes.places.shape[1]
    nodes, velocities = np.zeros((2, number, n, 3), complex)
    for node in observed_nodes(model):
        own = slice(3 * node, 3 * node + 3)
        nodes[:, node] = stepped(state.nodes[node], slopes.places[own].T)
        velocities[:, node] = stepped(state.node_velocities[node], slopes.velocities[own].T)
    places, rates = (
        part[3 * n :].T.reshape(number, 2, 6) for part in (slopes.places, slopes.velocities)
    )
    turns = rotation(stepped(np.zeros(3), places[..., 3:]))
    return State(
        nodes=nodes,
        board_positions=stepped(state.board_positions, places[..., :3]),
        board_rotations=turns @ state.board_rotations,
        node_velocities=velocities,
        board_velocities=stepped(state.board_velocities, rates[..., :3]),
        board_rates=stepped(state.board_rates, rates[..., 3:]),
    )
