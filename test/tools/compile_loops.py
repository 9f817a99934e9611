"""Compile the loops that steady states, their derivatives and tows run, once for all processes.

Otherwise each worker of the tests, and each process of a demo, would begin by compiling them at the
same time as the others.
"""

import numpy as np

from trawl_ros import Command, Simulation, build_model, load_gear, steady_state
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.sea_water import CurrentAt
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.sensitivity import sensitivities

CURRENT = tuple(
    CurrentAt(depth_m=depth, east_m_s=0.1, north_m_s=0.0) for depth in (0.0, 40.0, 80.0, 120.0)
)


def compile_loops() -> None:
    """Call what calls them, with arrays of each kind."""
    # Boards by a table of their forces, in water that flows.
    tabled = load_gear('krill_800')
    flowing = tabled.water.model_copy(update={'current': CURRENT})
    steady_state(build_model(tabled.model_copy(update={'water': flowing})), 400.0, 1.3)
    model = build_model(load_gear('kaifuha').refined(net=0.25))
    found = steady_state(model, 500.0, 2.1)
    sensitivities(model, steady_state(model, 510.0, 2.1, start=found.equilibrium).equilibrium)
    simulation = Simulation(model, Command(500.0, 500.0, 2.1))
    simulation.advance()
    simulation.truth()
    parameters = MotionParameters(
        coefficients=model.board.law.parameters.names,
        net=True,
        effects=(catalogue()['board_added_mass'],),
        motions=1,
    )
    point = InputPoint(inputs=np.array([500.0, 500.0, 2.1]), rates=np.zeros(3), hours=0.0)
    tow = DifferentiatedTow(model, parameters, lambda time: point)
    for _ in range(2):
        tow.step(0.2)


if __name__ == '__main__':
    compile_loops()
