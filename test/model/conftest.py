"""Water, and states of a gear, that nothing is special about."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model.assembly import points_of
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.rotations import rotation
from trawl_ros.model.state import State, Tow
from trawl_ros.model.water import Water
from trawl_ros.solver.first_guess import first_guess
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow

RandomCase = Callable[[GearModel, int], tuple[GearModel, State, Tow]]


@pytest.fixture(scope='session')
def rich_water() -> Water:
    """Density that grows, and a current that shears and veers all the way down."""
    return Water(
        density=1024.0,
        density_gradient=0.02,
        depths=np.array([0.0, 20.0, 60.0, 110.0, 250.0, 400.0]),
        currents=np.array(
            [[0.2, 0.1], [0.3, -0.1], [0.1, -0.3], [-0.1, -0.2], [-0.2, 0.1], [0.0, 0.2]]
        ),
    )


@pytest.fixture(scope='session')
def random_case(rich_water: Water) -> RandomCase:
    """Build (model, state, tow): everything displaced, turned and moving at random, and a
    third of the bars each slack, in the rounding between slack and taut, and taut."""

    def build(model: GearModel, seed: int) -> tuple[GearModel, State, Tow]:
        random = np.random.default_rng(seed)
        model = replace(
            model,
            water=rich_water,
            board=replace(
                model.board,
                installation=(0.05, -0.03, 0.04),
                added_mass=np.array([500.0, 15_000.0, 800.0]),
            ),
        )
        tow = replace(
            steady_tow(model, OperatingPoint(400.0, 385.0, 2.1, 0.7)),
            length_rates=np.array([0.4, -0.7]),
        )
        state = first_guess(model, tow, 0.7)
        state = replace(
            state,
            nodes=state.nodes + random.normal(0.0, 2.0, state.nodes.shape),
            board_positions=state.board_positions + random.normal(0.0, 2.0, (2, 3)),
            board_rotations=rotation(random.normal(0.0, 0.15, (2, 3))) @ state.board_rotations,
            node_velocities=state.node_velocities + random.normal(0.0, 0.5, state.nodes.shape),
            board_velocities=state.board_velocities + random.normal(0.0, 0.5, (2, 3)),
            board_rates=random.normal(0.0, 0.5, (2, 3)),
        )
        points = points_of(model, state, tow)
        vector, stretching = (
            own[model.ends[:, 1]] - own[model.ends[:, 0]]
            for own in (points.positions, points.velocities)
        )
        span = np.linalg.norm(vector, axis=1)
        # The damping counts as strain; what warps are paid out by is left out of it.
        damping = model.bars.damping_time * (vector * stretching).sum(axis=1) / span
        strain = random.choice([-0.05, 3e-5, 0.01], len(model.ends))
        return replace(model, rest=(span + damping) / (1.0 + strain)), state, tow

    return build
