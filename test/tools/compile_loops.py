"""Compile the loops that steady states, their derivatives and tows run, once for all processes.

Otherwise each worker of the tests, and each process of a demo, would begin by compiling them at the
same time as the others.
"""

import numpy as np

from trawl_ros import Command, Simulation, build_model, load_gear, steady_state
from trawl_ros.effects.registry import catalogue
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.motion.tow import DifferentiatedTow
from trawl_ros.solver.sensitivity import sensitivities


def compile_loops() -> None:
    """Call what calls them, with arrays of each kind."""
    model = build_model(load_gear('kaifuha').refined(net=0.25))
    found = steady_state(model, 500.0, 2.1)
    sensitivities(model, steady_state(model, 510.0, 2.1, start=found.equilibrium).equilibrium)
    simulation = Simulation(model, Command(500.0, 500.0, 2.1))
    simulation.advance()
    simulation.truth()
    parameters = MotionParameters(net=True, effects=(catalogue()['board_added_mass'],), motions=1)
    point = InputPoint(inputs=np.array([500.0, 500.0, 2.1]), rates=np.zeros(3), hours=0.0)
    tow = DifferentiatedTow(model, parameters, lambda time: point)
    for _ in range(2):
        tow.step(0.2)


if __name__ == '__main__':
    compile_loops()
