"""The slowest motion is the one that a tow shows when all others have died out."""

import numpy as np
import pytest

from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.equilibrium import find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.slow_mode import NET, PORT, STARBOARD, slow_mode


@pytest.mark.slow
def test_a_gear_that_comes_to_rest_does_so_along_its_slow_mode(model):
    length, speed = 300.0, 2.1
    found = find_equilibrium(model, OperatingPoint(length, length, speed))
    mode = slow_mode(model, found)
    simulation = Simulation(model, Command(length + 4.0, length + 4.0, speed), period=0.2)
    simulation.command = Command(length, length, speed)
    rest = found.observables.array()[[NET, PORT, STARBOARD]]
    away = []
    for until_s in (500, 700):
        while simulation.now.stamp < until_s * 1_000_000_000:
            simulation.advance()
        truth = simulation.truth()
        depths = [-truth.net.sonar_position[2], *(-door.position[2] for door in truth.doors)]
        away.append(np.array(depths) - rest)
    decay = 200.0 / np.log(away[0][0] / away[1][0])
    # Faster motions are not yet gone: at 1000 s it is 244 s, and rises.
    assert 0.7 * mode.decay_s < decay < mode.decay_s
    shape = mode.shape[[NET, PORT, STARBOARD]]
    np.testing.assert_allclose(shape, away[1] / away[1][0], rtol=0.03)
