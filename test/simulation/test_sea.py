"""The bottom lies where it was put, and schools are where they have drifted to."""

import math

import numpy as np
import pytest

from trawl_ros.model.gear_model import GearModel
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.sea import School, Sea
from trawl_ros.simulation.seabed import Seabed, SeabedTouched
from trawl_ros.simulation.simulation import Simulation

START = Command(500.0, 500.0, 2.1)


def flat(depth: float) -> Sea:
    return Sea(seabed=Seabed(depths=np.array([depth])))


def test_without_a_seabed_it_is_infinitely_deep() -> None:
    seabed = Sea().seabed_under(np.zeros(3), np.array([-700.0, 3.0, -80.0]))
    assert (seabed.under_ship, seabed.under_headrope) == (math.inf, math.inf)


def test_a_profile_runs_along_its_direction_and_is_level_across_and_beyond() -> None:
    north = Seabed(math.pi / 2, np.array([0.0, 1000.0]), np.array([300.0, 320.0]))
    places = np.array(
        [[0, 0, 0], [0, 500, -50], [800, 500, 0], [0, 1000, 0], [0, 5000, 0], [0, -900, 0]], float
    )
    assert north.depth_at(places) == pytest.approx([300, 310, 310, 320, 320, 300])


def test_truth_has_the_depths_under_ship_and_headrope(model: GearModel) -> None:
    seabed = Seabed(0.0, np.array([-1000.0, 1000.0]), np.array([400.0, 600.0]))
    truth = Simulation(model, START, sea=Sea(seabed=seabed)).truth()
    assert truth.seabed.under_ship == pytest.approx(500.0)
    astern = truth.net.sonar_position[0]
    assert astern < -500.0
    assert truth.seabed.under_headrope == pytest.approx(500.0 + 0.1 * astern)


def test_gear_that_would_start_on_the_seabed_is_refused(model: GearModel) -> None:
    simulation = Simulation(model, START)
    lowest = -simulation.now.motion.state.nodes[:, 2].min()
    Simulation(model, START, sea=flat(lowest + 0.1))
    with pytest.raises(SeabedTouched, match=r'\d+\.\d m'):
        Simulation(model, START, sea=flat(lowest - 0.1))


def test_the_lowest_corner_of_a_door_is_what_touches(model: GearModel) -> None:
    state = Simulation(model, START).now.motion.state
    net = -state.nodes[:, 2].min()
    door = -state.board_positions[0, 2]
    assert door < net
    # A bank under the doors alone, which the net has still ahead of it.
    ahead = state.board_positions[0, 0]
    for depth, touching in ((door + 3.5, False), (door + 1.0, True)):
        bank = Sea(
            seabed=Seabed(0.0, np.array([ahead - 3.0, ahead - 2.0]), np.array([net + 50.0, depth]))
        )
        if touching:
            with pytest.raises(SeabedTouched, match='port door'):
                Simulation(model, START, sea=bank)
        else:
            Simulation(model, START, sea=bank)


def test_a_tow_ends_where_a_bank_rises_into_the_gear(model: GearModel) -> None:
    deepest = -Simulation(model, START).now.motion.state.nodes[:, 2].min()
    # High enough for the doors, too low for the warps before them.
    bank = Seabed(0.0, np.array([-556.0, -476.0, -396.0]), np.array([deepest + 20.0, 148.0, 138.0]))
    simulation = Simulation(model, START, period=0.25, sea=Sea(seabed=bank))

    def advance() -> None:
        for _ in range(200):
            simulation.advance()

    with pytest.raises(SeabedTouched, match=r'port (door|warp|lower bridle)'):
        advance()
    assert 15.0 < simulation.now.stamp / 1e9 < 35.0


def test_schools_move_evenly_and_are_in_every_truth(model: GearModel) -> None:
    school = School(
        np.array([800.0, -30.0, -90.0]),
        np.array([60.0, 40.0, 20.0]),
        0.75,
        np.array([0.25, -0.5, 0.0]),
    )
    simulation = Simulation(model, START, stamp=5_000_000_000, sea=Sea(schools=(school,)))
    (first,) = simulation.truth().schools
    np.testing.assert_array_equal(first.position, school.position)
    np.testing.assert_array_equal(first.size, school.size)
    assert first.density == 0.75
    for _ in range(20):
        simulation.advance()
    (later,) = simulation.truth().schools
    np.testing.assert_allclose(later.position, [800.5, -31.0, -90.0])
    simulation.reset()
    np.testing.assert_array_equal(simulation.truth().schools[0].position, school.position)
