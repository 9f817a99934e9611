"""Manoeuvres of hauling at a chosen time step: with smooth inputs, and with ship and winches."""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import bar_tensions
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation, tow_of
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.stepper import Stepper, at_rest

SAMPLE = 0.8
"""Time (s) between the instants that are compared; a whole multiple of every step."""

START = Command(port_length=500.0, starboard_length=500.0, speed=2.1)

HAULING = np.array([1.0, 0.8])
"""Share of the largest speed with which the port and starboard winch haul."""

GAIN = 0.2
"""Speed (m/s) that the ship gains meanwhile."""


@dataclass(frozen=True)
class SteppedManoeuvre:
    """A manoeuvre at one time step.

    Attributes
    ----------
    step
        Time step, s.
    seen : (samples, observables) array
        Observables.
    places : (samples, nodes and boards, 3) array
        Places of all nodes and boards, m.
    tension
        Lowest tension of any bar at any sample, N.
    """

    step: float
    seen: FloatArray
    places: FloatArray
    tension: float


def smooth_tow(model: GearModel, tow: Tow, t: float, duration: float) -> Tow:
    """Towing boundary at a time of a smooth manoeuvre.

    Both winches haul at a rate of one cosine wave, from rest to their largest speed and back. The
    ship gains speed along half a cosine wave.
    """
    wave = 2 * np.pi * t / duration
    hauled = 0.5 * model.gear.winch.max_speed_m_s * HAULING
    way = 0.5 * GAIN * (t - duration / np.pi * np.sin(0.5 * wave))
    faster = 0.5 * GAIN * (1.0 - np.cos(0.5 * wave))
    ahead = np.array([1.0, 0.0, 0.0])
    return replace(
        tow,
        blocks=tow.blocks + t * tow.block_velocities + way * ahead,
        block_velocities=tow.block_velocities + faster * ahead,
        lengths=tow.lengths - hauled * (t - np.sin(wave) * duration / (2 * np.pi)),
        length_rates=-hauled * (1.0 - np.cos(wave)),
    )


def smooth_haul(
    model: GearModel, start: Equilibrium, step: float, duration: float
) -> SteppedManoeuvre:
    """The stepper through the smooth manoeuvre, from a steady state."""
    stepper, motion = Stepper(model), at_rest(start.state)
    each = round(SAMPLE / step)
    seen, places, tension = [], [], np.inf
    for k in range(1, round(duration / step) + 1):
        tow = smooth_tow(model, start.tow, k * step, duration)
        motion = stepper.step(motion, tow, step)
        if k % each == 0:
            seen.append(observe(model, motion.state, tow).array())
            places.append(_places(motion.state))
            tension = min(tension, float(bar_tensions(model, motion.state, tow).min()))
    return SteppedManoeuvre(step, np.array(seen), np.array(places), tension)


def winch_ramp(model: GearModel, step: float, duration: float, hauled: float) -> SteppedManoeuvre:
    """Simulate hauling ``hauled`` metres to port and fewer to starboard while the ship speeds up.

    Winches and ship accelerate as the gear file says, with abrupt starts and stops.
    """
    simulation = Simulation(model, START, period=0.5 * step)
    simulation.command = Command(
        START.port_length - hauled * HAULING[0],
        START.starboard_length - hauled * HAULING[1],
        START.speed + 0.5 * GAIN,
    )
    each = round(2 * SAMPLE / step)
    seen, places, tension = [], [], np.inf
    for k in range(1, round(2 * duration / step) + 1):
        now = simulation.advance()
        if k % each == 0:
            tow = tow_of(model, now.ship, now.winches)
            seen.append(observe(model, now.motion.state, tow).array())
            places.append(_places(now.motion.state))
            tension = min(tension, float(bar_tensions(model, now.motion.state, tow).min()))
    return SteppedManoeuvre(step, np.array(seen), np.array(places), tension)


def _places(state: State) -> FloatArray:
    return np.concatenate([state.nodes, state.board_positions])
