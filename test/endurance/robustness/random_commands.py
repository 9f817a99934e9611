"""An hour of random commands: hauled, veered, slowed down and turned, in calm and in swell."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import fallen_boards
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.heave import irregular_heave
from trawl_ros.simulation.random_commands import CommandLimits, RandomCommands
from trawl_ros.simulation.sea import Sea
from trawl_ros.simulation.simulation import CALM, Simulation
from trawl_ros.solver.stepper import StepFailed

START = Command(500.0, 500.0, 2.1)


LIMITS = CommandLimits()
RECOVERY = Command(500.0, 500.0, 2.4)
"""Command of the last part of an hour: straight on, and faster."""

CALM_PERIOD, SWELL_PERIOD = 0.25, 0.1
"""Half of the solver's step, s."""

GLANCE = 5.0
"""Time between two looks at the boards, s."""


@dataclass(frozen=True)
class CommandedHour:
    """Outcome of an hour: the failure in a sentence, '' for none; times (s) reached and with a
    fallen board, and whether a board lay at the end.
    """

    failure: str
    reached_s: float
    fallen_s: float
    fallen_at_end: bool


def commanded_hour(
    model: GearModel,
    seed: int,
    *,
    duration: float = 3600.0,
    recovery: float = 900.0,
    limits: CommandLimits = LIMITS,
) -> CommandedHour:
    """Tow under random commands, and at last for ``recovery`` seconds straight on and faster."""
    draws = np.random.default_rng(seed)
    sea, period = CALM, CALM_PERIOD
    if draws.random() < 0.25:
        height, peak = draws.uniform(0.5, 3.0), draws.uniform(8.0, 14.0)
        sea = Sea(heave=irregular_heave(height, peak, draws, begin=60.0, growth=60.0))
        period = SWELL_PERIOD
    simulation = Simulation(model, START, period=period, sea=sea)
    commands = RandomCommands(draws, limits)
    time, fallen_s, fallen = 0.0, 0.0, False
    while time < duration:
        if time >= duration - recovery:
            simulation.command = RECOVERY
        else:
            simulation.command = commands.after(simulation.command, time)
        try:
            for _ in range(round(GLANCE / period)):
                now = simulation.advance()
        except StepFailed as reason:
            return CommandedHour(str(reason), time, fallen_s, fallen)
        time += GLANCE
        state = now.motion.state
        if not (np.isfinite(state.nodes).all() and np.isfinite(state.velocity).all()):
            return CommandedHour('a place or speed is no number', time, fallen_s, fallen)
        fallen = any(fallen_boards(state))
        fallen_s += GLANCE * fallen
    return CommandedHour('', time, fallen_s, fallen)
