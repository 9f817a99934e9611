# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Towed wire in this package's own model, advanced by its own time stepper."""

import time
from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.lone_line import holding, loaded, lone_line, settled
from trawl_ros.lab.reference_codes.manoeuvre import History, WireManoeuvre
from trawl_ros.lab.reference_codes.towed_wire import TowedWire, WireSteadyState
from trawl_ros.model.assembly import block_forces
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.model.water import Water
from trawl_ros.solver.stepper import Stepper, at_rest

TRACK_STEP = 0.1
"""Longest step (s) over which the block's track is integrated."""


def own_model(wire: TowedWire, segments: int) -> GearModel:
    """Return the wire in ``segments`` bars, with its lump."""
    model = lone_line(
        {
            'diameter_m': wire.diameter,
            'weight_in_water_n_m': wire.weight_in_water,
            'stiffness_n': wire.stiffness,
            'damping_time_s': wire.damping_time,
            'normal_drag': wire.normal_drag,
            'tangential_drag': wire.tangential_drag,
            'added_mass_normal': wire.added_normal,
            'added_mass_tangential': 0.0,
        },
        segments,
        Water(density=wire.density, gravity=wire.gravity),
    )
    model = loaded(model, wire.lump_mass, wire.lump_volume, wire.lump_drag_area)
    return replace(model, lump_added=wire.lump_added * model.lump_volume)


def own_steady(wire: TowedWire, model: GearModel) -> tuple[State, WireSteadyState]:
    """Solve the steady tow along x with the block at the origin.

    Raises
    ------
    NoSteadyState
        If none is found.
    """
    tow = holding(wire.length, np.zeros(3), np.zeros(3), wire.speed)
    share = np.arange(1, model.nodes + 1)[:, None] / model.nodes
    astern = wire.length / np.sqrt(2.0) * np.array([-1.0, 0.0, -1.0])
    state = settled(model, share * astern, tow)
    end = state.nodes[-1]
    pull = float(np.linalg.norm(block_forces(model, state, tow)[0]))
    return state, WireSteadyState(depth=float(-end[2]), lag=float(-end[0]), tension=pull)


def own_history(model: GearModel, start: State, manoeuvre: WireManoeuvre, step: float) -> History:
    """Follow a manoeuvre from a steady tow in steps of ``step`` seconds.

    Raises
    ------
    StepFailed
        If the equations of a step could not be solved.
    """
    tows, times = tows_of(manoeuvre, step)
    stepper, motion = Stepper(model), at_rest(start)
    states = [start]
    began = time.process_time()
    for tow in tows[1:]:
        motion = stepper.step(motion, tow, step)
        states.append(motion.state)
    seconds = time.process_time() - began
    pulls = [block_forces(model, state, tow)[0] for state, tow in zip(states, tows, strict=True)]
    return History(
        times=times,
        depth=np.array([-state.nodes[-1, 2] for state in states]),
        tension=np.linalg.norm(pulls, axis=1),
        seconds=seconds,
    )


def tows_of(manoeuvre: WireManoeuvre, step: float) -> tuple[list[Tow], FloatArray]:
    """Towing boundaries of a manoeuvre at the end of each step, from time 0 on, and those times."""
    count = round(manoeuvre.duration / step)
    finer = int(np.ceil(step / TRACK_STEP))
    times: FloatArray = step * np.arange(count + 1, dtype=float)
    track = manoeuvre.track(step / finer * np.arange(count * finer + 1, dtype=float))[::finer]
    tows = []
    for t, place in zip(times, track, strict=True):
        length, rate, velocity = (
            manoeuvre.length_at(t),
            manoeuvre.length_rate(t),
            manoeuvre.velocity(t),
        )
        tows.append(
            Tow(
                blocks=np.stack([place, place]),
                block_velocities=np.stack([velocity, velocity]),
                lengths=np.array([length, length]),
                length_rates=np.array([rate, rate]),
            )
        )
    return tows, times
