"""Each gear that comes with the package is solved, turned, and hauled by 100 m."""

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.equilibrium import steady_state

TOWS = {
    'kaifuha': (500.0, 2.1),
    'krill_800': (400.0, 1.2),
    'krill_1600': (400.0, 1.3),
    'krill_1420': (400.0, 1.2),
    'harstad_1436': (400.0, 1.5),
    'four_seam': (250.0, 1.5),
    'pair_368': (220.0, 1.0),
    'flume_83_112': (250.0, 1.2),
}
"""Length of warp (m) and speed (m/s) at which each begins."""

HAUL, HAUL_RATE = 100.0, 0.3
TURN_RATE = np.radians(0.1)
STEP = 0.1


@pytest.mark.slow
@pytest.mark.parametrize('name', TOWS)
def test_it_is_found_turned_and_hauled(name: str) -> None:
    warp, speed = TOWS[name]
    model = build_model(load_gear(name).refined(net=0.4))
    steady = steady_state(model, warp, speed)
    assert steady.stability.stable
    simulation = Simulation(model, Command(warp, warp, speed), period=STEP)
    start = simulation.truth()
    simulation.command = Command(warp, warp, speed, turn_rate=TURN_RATE)
    for _ in range(int(300 / STEP)):
        simulation.advance()
    turned = simulation.truth()
    assert turned.vessel.heading == pytest.approx(300 * TURN_RATE, rel=0.05)
    simulation.command = Command(warp - HAUL, warp - HAUL, speed)
    for _ in range(int((HAUL / HAUL_RATE + 60) / STEP)):
        simulation.advance()
    hauled = simulation.truth()
    for winch in hauled.winches:
        assert winch.length == pytest.approx(warp - HAUL, abs=0.5)
    for before, after in zip(start.doors, hauled.doors, strict=True):
        assert after.position[2] > before.position[2]
        assert after.position[2] < 0.0
    assert hauled.net.vertical_opening > 0.3 * start.net.vertical_opening
