"""What passes through the sonar's plane: each rope once, in the plane, and stable to rounding."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.truth import single
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.reading import section_of, sonar_axes
from trawl_ros.simulation.simulation import Simulation


@pytest.fixture(scope='module')
def simulation(default_model: GearModel) -> Simulation:
    return Simulation(default_model, Command(500.0, 500.0, 2.1), heading=0.7)


def test_the_axes_are_those_of_the_pose(simulation: Simulation) -> None:
    axes = sonar_axes(simulation.model, simulation.now.motion.state)
    turn = Rotation.from_quat(simulation.truth().net.sonar_orientation).as_matrix()
    np.testing.assert_allclose(axes, turn, atol=1e-12)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_every_point_lies_on_a_bar_of_the_net_in_the_plane(simulation: Simulation) -> None:
    model, state = simulation.model, simulation.now.motion.state
    net = simulation.truth().net
    turn = Rotation.from_quat(net.sonar_orientation).as_matrix()
    places = net.sonar_position + net.section[:, :2] @ turn[:, :2].T
    inner = (model.ends < model.nodes).all(axis=1)
    a, b = state.nodes[model.ends[inner, 0]], state.nodes[model.ends[inner, 1]]
    for place in places:
        share = np.clip(np.sum((place - a) * (b - a), 1) / np.sum((b - a) ** 2, 1), 0, 1)
        assert np.linalg.norm(a + share[:, None] * (b - a) - place, axis=1).min() < 1e-5


def test_no_bar_that_passes_is_left_out(simulation: Simulation) -> None:
    """Sides of the plane are counted by the truth's own pose, one bar after the other."""
    model, state = simulation.model, simulation.now.motion.state
    net = simulation.truth().net
    forward = Rotation.from_quat(net.sonar_orientation).as_matrix()[:, 2]
    ahead = (state.nodes - net.sonar_position) @ forward
    passing = sum(
        ahead[a] * ahead[b] < 0 and min(abs(ahead[a]), abs(ahead[b])) > 1e-6
        for a, b in model.ends
        if a < model.nodes and b < model.nodes
    )
    # And bars that end at the footrope's middle, which is in the plane, with the footrope.
    assert passing <= len(net.section) <= passing + 4


def test_diameters_are_those_of_rope_and_twine(simulation: Simulation) -> None:
    gear, section = simulation.model.gear, simulation.truth().net.section
    lowest = section[section[:, 0] > section[:, 0].max() - 1e-6]
    footrope, headrope = single([gear.footrope.diameter_m, gear.headrope.diameter_m])
    assert footrope in lowest[:, 2]
    twine = single([part.twine_diameter_m for part in gear.netting.body])
    others = np.delete(section[:, 2], np.flatnonzero(section[:, 2] == footrope))
    assert min(twine) <= others.min()
    assert others.max() <= max(*twine, headrope)


def test_the_sonar_does_not_see_what_it_hangs_on(simulation: Simulation) -> None:
    section = simulation.truth().net.section
    assert np.hypot(section[:, 0], section[:, 1]).min() > 1.0


def test_the_section_is_the_mouth_where_the_sonar_is(simulation: Simulation) -> None:
    net = simulation.truth().net
    turn = Rotation.from_quat(net.sonar_orientation).as_matrix()
    assert net.section_height * -turn[2, 0] == pytest.approx(net.vertical_opening, rel=1e-6)
    assert 0.3 * net.horizontal_opening < net.section_width < net.horizontal_opening
    # A gear towed straight is its own mirror image.
    port, starboard = net.section[:, 1].max(), -net.section[:, 1].min()
    assert port == pytest.approx(starboard, rel=1e-5)


def test_rounding_decides_on_nothing(simulation: Simulation) -> None:
    model, state = simulation.model, simulation.now.motion.state
    counts = set()
    for seed in range(10):
        moved = state.nodes + 1e-10 * np.random.default_rng(seed).standard_normal(state.nodes.shape)
        shaken = replace(state, nodes=moved)
        counts.add(len(section_of(model, shaken, sonar_axes(model, shaken))))
    assert len(counts) == 1
