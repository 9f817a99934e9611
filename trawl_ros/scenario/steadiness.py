# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Check of a scenario for steady states, before hours of simulation."""

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from trawl_ros.control.autopilot import FollowTrack, HoldCourse, HoldHeading
from trawl_ros.control.track import Way
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.geodesy import Datum
from trawl_ros.model.gear_model import GearModel
from trawl_ros.scenario.driving import SteerRecord
from trawl_ros.scenario.scenario import Scenario
from trawl_ros.simulation.command import Command
from trawl_ros.solver.equilibrium import SteadyState, steady_state

Found = dict[tuple[Command, float], SteadyState]


def require_steady_states(scenario: Scenario, model: GearModel) -> None:
    """Check that the gear has a steady state at each command of a scenario.

    Steps with a constant rate of turn are not checked, because a turning ship has no steady state
    in ``map``. With an autopilot, the states on course are checked: on each leg of a track, with
    the drift angle in the current. Headings on the way to a track or to fish are unknown, so they
    are not checked in a current. An autotrawl in mode ``tension`` makes unequal lengths nearly
    equal, so their mean is checked.

    Raises
    ------
    NoSteadyState
        With file, step and the reason, if the gear has no usable steady state there.
    """
    found: Found = {}
    for name, command, heading in _states(scenario, model):
        if (command, heading) in found:
            continue
        try:
            found[command, heading] = _steady(model, command, heading, found)
        except NoSteadyState as reason:
            raise NoSteadyState(
                f'{scenario.path}: {name}: {reason}; expected warp lengths and a speed with a '
                'steady state',
                reason.reason,
                reason.remedy,
            ) from reason


def _states(scenario: Scenario, model: GearModel) -> Iterator[tuple[str, Command, float]]:
    """Yield the steady states of a trial: name, command and heading of each."""
    still = not np.any(model.water.currents)
    yield 'start', scenario.start, scenario.heading
    heading: float | None = scenario.heading
    steps = zip(scenario.record.steps, scenario.commands, scenario.drivings, strict=True)
    for record, (_, command), driving in steps:
        name = f"step '{record.name}'"
        if driving.steer is not None:
            headings = _final_headings(driving.steer, scenario, command.speed, model)
            heading = headings[-1] if headings else None
        elif command.turn_rate:
            if heading is not None:
                heading += command.turn_rate * 60.0 * record.minutes
            continue
        else:
            headings = [] if heading is None else [heading]
        if driving.autotrawl.mode == 'tension':
            mean = 0.5 * (command.port_length + command.starboard_length)
            command = Command(mean, mean, command.speed)
        for final in [scenario.heading] if still else headings:
            yield name, command, final


def _final_headings(
    steer: SteerRecord, scenario: Scenario, speed: float, model: GearModel
) -> list[float]:
    """Return the final headings of a ship with this target, if they are known."""
    vessel = scenario.instruments.vessel
    target = steer.target(Datum(vessel.datum_lat_deg, vessel.datum_lon_deg))
    way = Way(speed, model.water.surface_current[:2], math.radians(steer.max_turn_deg_s))
    if isinstance(target, HoldHeading):
        return [target.heading]
    if isinstance(target, HoldCourse):
        return [way.heading_on(target.course)]
    if isinstance(target, FollowTrack):
        legs = [after - before for before, after in pairwise(target.waypoints)]
        return [way.heading_on(math.atan2(north, east)) for east, north in legs]
    return []


def _steady(model: GearModel, command: Command, heading: float, found: Found) -> SteadyState:
    """Solve warm from the last state on this heading, and cold if that fails."""
    lengths = (command.port_length, command.starboard_length)
    near = [state.equilibrium for (_, course), state in found.items() if course == heading]
    if near:
        try:
            return steady_state(model, lengths, command.speed, heading=heading, start=near[-1])
        except NoSteadyState:
            pass
    return steady_state(model, lengths, command.speed, heading=heading)
