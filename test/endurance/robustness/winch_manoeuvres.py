"""Winch manoeuvres from a steady tow straight ahead, and whether a board falls."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import fallen_boards
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.equilibrium import steady_state

SPEEDS_M_S = 1.6, 1.9, 2.2, 2.5, 2.8
LENGTHS_M = 300.0, 600.0
START_LENGTHS_M, START_SPEEDS_M_S = (200.0, 400.0, 600.0, 900.0), (1.6, 2.1, 2.6)
PERIOD_S, AFTER_S = 0.25, 300.0
"""Half of the solver's step, and how long the boards are watched after the last command, s."""

STANDING_POINTS_M = np.array(
    [[-0.456, 0.172, -0.181], [0.085, -0.048, 2.589], [-1.001, 0.426, -1.541]]
)
"""Points of warp, upper and lower bridle that were sought in motion, as `trawl trim --in-motion`
does: the boards of the gear file stand better with them, and boards of other coefficients worse."""


@dataclass(frozen=True)
class Manoeuvre:
    """Commands to the winches, each with the time (s) to the next one.

    Attributes
    ----------
    name
        Name in the table.
    changes
        Changes of the port and starboard warp (m) from the length at the start, and s to the next.
    """

    name: str
    changes: tuple[tuple[float, float, float], ...]


MANOEUVRES = (
    Manoeuvre('haul 100 m', ((-100.0, -100.0, 255.0),)),
    Manoeuvre('pay out 100 m', ((100.0, 100.0, 255.0),)),
    Manoeuvre('haul 100 m, one winch 10 s longer', ((-104.0, -100.0, 265.0),)),
    Manoeuvre('haul, then pay out at once', ((-60.0, -60.0, 120.0), (40.0, 40.0, 260.0))),
    Manoeuvre(
        'haul, pay out two minutes after the stop', ((-48.0, -48.0, 245.0), (40.0, 40.0, 230.0))
    ),
)


def lets_fall(model: GearModel, manoeuvre: Manoeuvre, length: float, speed: float) -> bool:
    """Return True if a board falls during a manoeuvre or in `AFTER_S` behind it."""
    simulation = Simulation(model, Command(length, length, speed), period=PERIOD_S)
    *before, (port, starboard, duration) = manoeuvre.changes
    for port_change, starboard_change, seconds in (*before, (port, starboard, duration + AFTER_S)):
        simulation.command = replace(
            simulation.command,
            port_length=length + port_change,
            starboard_length=length + starboard_change,
        )
        for step in range(round(seconds / PERIOD_S)):
            state = simulation.advance().motion.state
            if not step % 20 and any(fallen_boards(state)):
                return True
    return False


def held_places(model: GearModel) -> MeasuredValue:
    """Row of the places at which boards with the start values of identification can be towed."""
    boards = model.with_coefficients(np.array(model.gear.identification.start))
    places = list(product(START_LENGTHS_M, START_SPEEDS_M_S))
    usable = 0
    for place in places:
        with suppress(NoSteadyState):
            steady_state(boards, *place)
            usable += 1
    what = f'places of {len(places)} usable with the start values of identification'
    return MeasuredValue(what, usable)


def manoeuvre_rows(model: GearModel, speeds: Sequence[float]) -> list[MeasuredValue]:
    """Rows of all manoeuvres: in how many of the tows a board falls, and in which."""
    tows = [(length, speed) for length in LENGTHS_M for speed in speeds]
    rows = []
    for manoeuvre in MANOEUVRES:
        fell = [tow for tow in tows if lets_fall(model, manoeuvre, *tow)]
        where = ', '.join(f'{length:g} m at {speed:g} m/s' for length, speed in fell)
        what = f'{manoeuvre.name}: tows of {len(tows)} in which a board fell'
        rows.append(MeasuredValue(what, len(fell), note=where))
    return rows
