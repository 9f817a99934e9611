"""A towed wire with a lump at its end, against the integrated equation of a steady elastic
wire: the same line kernel, assembly and solver as the whole gear."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from trawl_ros.model.assembly import block_forces
from trawl_ros.model.state import State
from trawl_ros.model.water import Water
from trawl_ros.solver.equilibrium import relax
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow

LENGTH, SPEED = 600.0, 2.0
WIRE = {
    'diameter_m': 0.032,
    'weight_in_water_n_m': 28.0,
    'stiffness_n': 4e7,
    'normal_drag': 1.2,
    'tangential_drag': 0.02,
}
LUMP = (2000.0, 0.25, 12.0)
"""Mass (kg), volume (m³), C_D A (m²)."""


@dataclass(frozen=True)
class Towed:
    depth: float
    lag: float
    tension: float

    def error(self) -> np.ndarray:
        """Relative errors against the integrated equation."""
        exact = np.array([335.307, 498.191, 41_042.0])
        return np.array([self.depth, self.lag, self.tension]) / exact - 1.0


@pytest.fixture(scope='module')
def towed(bare_model):
    def solve(segments: int) -> Towed:
        model = bare_model(WIRE, segments, Water(density=1025.0, gravity=9.80665))
        mass, volume, drag_area = np.zeros((3, model.nodes))
        last = [segments - 1, 2 * segments - 1]
        mass[last], volume[last], drag_area[last] = LUMP
        model = replace(model, lump_mass=mass, lump_volume=volume, lump_drag_area=drag_area)
        tow = steady_tow(model, OperatingPoint(LENGTH, LENGTH, SPEED))
        share = np.tile(np.arange(1, segments + 1) / segments, 2)[:, None]
        astern = LENGTH / np.sqrt(2.0) * np.array([-1.0, 0.0, -1.0])
        state = State(
            nodes=tow.blocks.repeat(segments, axis=0) + share * astern,
            board_positions=np.tile([0.0, 0.0, -10.0], (2, 1)),
            board_rotations=np.tile(np.eye(3), (2, 1, 1)),
            node_velocities=np.tile([SPEED, 0.0, 0.0], (2 * segments, 1)),
            board_velocities=np.tile([SPEED, 0.0, 0.0], (2, 1)),
            board_rates=np.zeros((2, 3)),
        )
        free = np.arange(model.dof) < 3 * model.nodes
        state, _, left = relax(model, state, tow, tolerance=1e-4, time_step=1.0, free=free)
        assert left < 1e-4
        pull = np.linalg.norm(block_forces(model, state, tow), axis=1)
        assert pull[0] == pytest.approx(pull[1], rel=1e-12)
        end = state.nodes[segments - 1]
        return Towed(depth=-end[2], lag=-end[0], tension=pull[0])

    return solve


def test_twenty_segments_agree_within_three_per_mille(towed) -> None:
    assert np.abs(towed(20).error()).max() < 0.003


def test_the_error_falls_with_the_square_of_the_segments(towed) -> None:
    errors = np.abs([towed(segments).error() for segments in (10, 20, 40)])
    print('errors of depth, lag, tension at 10, 20, 40 segments', errors, sep='\n')  # noqa: T201
    # Down to the digits of the reference.
    assert (errors[1:] < np.maximum(errors[:-1] / 3.0, 2e-5)).all()
