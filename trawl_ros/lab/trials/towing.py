# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Simulation of planned tows: the gear is hauled, veered and left to reach a steady state."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.lab.trials.hidden_effects.hidden import Hidden
from trawl_ros.lab.trials.linearised_plant import LinearisedState
from trawl_ros.lab.trials.tows import PlannedTow
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Instant, Simulation, tow_of

HOLD_S = 90.0
"""Time for which a state is kept after its planned instant; one or two windows fit into it."""

AWAY_M = 150.0
"""Shorter warp at the beginning of a tow, so that nothing is steady before the first state."""

EARLY_S = 60.0
"""Time by which a state is reached before it is needed."""


@dataclass(frozen=True)
class Course:
    """Course of a tow, second by second.

    Attributes
    ----------
    times : (n,) array
        Since it began, s.
    inputs : (n, 3) array
        Both warp lengths (m) and speed (m/s) as counters and log would show them.
    values : (n, 24) array
        Observables as sensors would show them.
    heading
        ENU yaw, rad.
    moments
        Time (s) of each state.
    """

    times: FloatArray
    inputs: FloatArray
    values: FloatArray
    heading: float
    moments: tuple[float, ...]

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Inputs (m, 3) and values (m, 24) at other times (m,)."""
        inputs, values = (
            np.column_stack([np.interp(times, self.times, column) for column in table.T])
            for table in (self.inputs, self.values)
        )
        return inputs, values


def settling_time(length: float, speed: float) -> float:
    """Settling time (s) before a state counts as steady."""
    options = WindowOptions()
    passages = options.settle_passages * (length + options.net_length) / speed
    return max(options.settle_s, min(passages, options.longest_settle_s))


def quasi_steady(tow: PlannedTow, looks: Sequence[LinearisedState]) -> Course:
    """Return a quasi-steady course: one steady state after another, also in between."""
    length, speed = looks[0].state
    shooting = replace(looks[0], state=(length - AWAY_M, speed))
    times, rows, moments = [0.0], [shooting], []
    for place, look in enumerate(looks):
        moment = 3600.0 * tow.moment(place).hours
        moments.append(moment)
        reached = moment - EARLY_S - settling_time(*look.state)
        times += [max(reached, times[-1]), moment + HOLD_S]
        rows += [look, look]
    return Course(
        np.array(times),
        np.array([look.inputs for look in rows]),
        np.array([look.values for look in rows]),
        0.0 if tow.eastward else np.pi,
        tuple(moments),
    )


HAULING_SPEED = 2.4
"""Towing speed while hauling and veering, m/s; at a lower one boards lose their lift."""

PERIOD_S, SEEN_S = 0.25, 1.0
"""Of the simulation, and how often it is looked at."""

FIXED_POINT_ITERATIONS = 20


@dataclass(frozen=True)
class InTime(Effect):
    """Hidden effect for the simulation; its value is its size."""

    hidden: Hidden | None = None

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Apply to inputs: true warp lengths and speed (3,)."""
        assert self.hidden is not None
        return self.hidden.towed(float(values[0]), inputs, at)

    def gear(self, values: FloatArray, model: GearModel, at: Situation) -> GearModel:
        """Gear model with the hidden effect."""
        assert self.hidden is not None
        return self.hidden.gear(float(values[0]), model, at)

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Apply to sensors: readings with the hidden effect."""
        assert self.hidden is not None
        return self.hidden.shown(float(values[0]), readings, at)


def hidden_effect_set(effects: Sequence[tuple[Hidden, float]]) -> EffectSet:
    """Effect set of hidden effects with their sizes."""
    return EffectSet(
        tuple(
            ActiveEffect(
                InTime(
                    name=hidden.name,
                    sentence='',
                    parameters=(Parameter('size', hidden.unit, 0.0, -np.inf, np.inf, 1.0),),
                    excited_by='',
                    hidden=hidden,
                ),
                np.array([size]),
            )
            for hidden, size in effects
        )
    )


def towed_in_time(
    model: GearModel, tow: PlannedTow, effects: Sequence[tuple[Hidden, float]]
) -> Course:
    """Tow the states of a tow one after another.

    Raises
    ------
    NoSteadyState
        If the gear cannot be towed in the first state.
    StepFailed
        If its motion cannot be computed.
    """
    heading, there = (0.0 if tow.eastward else np.pi), hidden_effect_set(effects)
    length, speed = tow.states[0]
    simulation = Simulation(
        model, Command(length, length, speed), heading=heading, period=PERIOD_S, effect_set=there
    )
    steps = round(SEEN_S / PERIOD_S)
    times, inputs, values, moments = [], [], [], []

    def tow_on(command: Command, done: float | None) -> None:
        """Simulate a command for so many seconds, or until the winches have reached it."""
        simulation.command = command
        begun = simulation.now.stamp
        while True:
            for _ in range(steps):
                now = simulation.advance()
            seconds = now.stamp / 1e9
            shown = _shown(now, there, heading, seconds / 3600.0)
            times.append(seconds)
            inputs.append(shown)
            values.append(_seen(simulation, there, tow.sense, shown, seconds / 3600.0))
            standing = all(winch.speed == 0.0 for winch in now.winches)
            if standing if done is None else (now.stamp - begun) / 1e9 >= done:
                return

    for length, speed in tow.states:
        tow_on(Command(length, length, HAULING_SPEED), None)
        tow_on(Command(length, length, speed), EARLY_S + settling_time(length, speed))
        moments.append(times[-1])
        tow_on(Command(length, length, speed), HOLD_S)
    return Course(np.array(times), np.array(inputs), np.array(values), heading, tuple(moments))


def _shown(now: Instant, there: EffectSet, heading: float, hours: float) -> FloatArray:
    """Return the indicated inputs from the true ones, by fixed-point iteration."""
    towed = np.array([now.winches[0].length, now.winches[1].length, now.ship.speed])
    shown = towed
    for _ in range(FIXED_POINT_ITERATIONS):
        at = Situation((shown[0], shown[1], shown[2]), heading, hours=hours)
        shown = shown + towed - there.apply_to_inputs(shown, at)
    return shown


def _seen(
    simulation: Simulation, there: EffectSet, sense: float, shown: FloatArray, hours: float
) -> FloatArray:
    """Readings (22,) of the sensors."""
    now, model = simulation.now, simulation.model
    state = now.motion.state
    seen = observe(model, state, tow_of(model, now.ship, now.winches)).array()
    readings = dict(zip(OBSERVABLES, map(float, seen), strict=True))
    at = Situation((shown[0], shown[1], shown[2]), sense=sense, hours=hours)
    readings = there.apply_to_sensors(readings, at)
    return np.array([readings[name] for name in OBSERVABLES])
