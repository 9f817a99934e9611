# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Derivatives of sensor readings by the values of effects.

The change of forces by an effect is a finite difference at the steady state; the linearised gear
turns it into a change of the observables. Changes of inputs and readings follow by the chain rule.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.model.assembly import forces
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.model.slopes.observed import observed_slopes
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.linear.factor import solve_refined
from trawl_ros.solver.model_equality import same_forces, same_observables
from trawl_ros.solver.rest_linearisation import rest_linearisation

STD_FRACTION_OF_DIFFERENCES = 1e-4
"""Step of central differences by an effect's value, as a fraction of its std."""

INPUT_STEP = 1e-4
"""Step of central differences by warp length (m) and speed (m/s)."""


def shown_values(acting: EffectSet, values: FloatArray, at: Situation) -> FloatArray:
    """Return sensor readings (n_observables,) of observables, with sensor effects applied."""
    if not acting:
        return values
    readings = acting.apply_to_sensors(dict(zip(OBSERVABLES, map(float, values), strict=True)), at)
    return np.array([readings[name] for name in OBSERVABLES])


def chained(
    model: GearModel,
    gear: GearModel,
    found: Equilibrium,
    jacobian: FloatArray,
    acting: EffectSet,
    inputs: FloatArray,
    at: Situation,
) -> FloatArray:
    """Return derivatives of sensor readings by coefficients and shown inputs.

    Parameters
    ----------
    model, gear
        The gear with board coefficients set, without any effect, and with ``acting``.
    found
        The steady state with ``acting``.
    jacobian
        Derivatives (n_observables, q + 3) of the observables by coefficients and true inputs.
    acting
        Effects that act on the gear.
    inputs, at
        Inputs as instruments show them (3,), and the situation.
    """
    if not acting:
        return jacobian
    rows = []
    for place in range(len(inputs)):
        both = [inputs + sign * INPUT_STEP * np.eye(len(inputs))[place] for sign in (1.0, -1.0)]
        cases = [(acting, one, replace(at, inputs=_three(one))) for one in both]
        rows.append(_slopes(model, found, 2.0 * INPUT_STEP, cases))
    by_inputs = _carried(gear, found, jacobian, acting, rows, at)
    by_coefficients = sensor_slopes(acting, found.observables.array(), at) @ jacobian[:, :-3]
    return np.hstack((by_coefficients, by_inputs))


def by_effects(
    model: GearModel,
    gear: GearModel,
    found: Equilibrium,
    jacobian: FloatArray,
    acting: EffectSet,
    wanted: Sequence[ActiveEffect],
    inputs: FloatArray,
    at: Situation,
) -> FloatArray:
    """Return derivatives of sensor readings by the values of effects.

    Parameters
    ----------
    model, gear
        The gear with board coefficients set, without any effect, and with ``acting``.
    found
        The steady state with ``acting``.
    jacobian
        Derivatives of the observables by coefficients and true inputs.
    acting
        Effects that act on the gear.
    wanted
        Effects by whose values to differentiate; those that do not act have neutral values.
    inputs, at
        Inputs as instruments show them (3,), and the situation.

    Returns
    -------
    (n_observables, m) array
        One column per value, in the order of the effects and their parameters.
    """
    rows = []
    for active in wanted:
        for index, parameter in enumerate(active.effect.parameters):
            size = STD_FRACTION_OF_DIFFERENCES * parameter.std
            step = size * np.eye(len(active.values))[index]
            both = [
                acting.having(ActiveEffect(active.effect, active.values + sign * step))
                for sign in (1.0, -1.0)
            ]
            rows.append(_slopes(model, found, 2.0 * size, [(one, inputs, at) for one in both]))
    return _carried(gear, found, jacobian, acting, rows, at)


def _slopes(
    model: GearModel,
    found: Equilibrium,
    size: float,
    both: Sequence[tuple[EffectSet, FloatArray, Situation]],
) -> tuple[FloatArray, ...]:
    """Return difference quotients between two cases that are ``size`` apart, at a fixed gear.

    They are those of forces (dof,), observables, true inputs (3,) and sensor readings.
    """
    gears, cases = [], []
    for there, inputs, at in both:
        gears.append(there.gear(model, at))
        readings = shown_values(there, found.observables.array(), at)
        cases.append((there.apply_to_inputs(inputs, at), readings))
    up, down = gears
    at_rest = found.state, found.tow
    push, direct = np.zeros(model.dof), np.zeros(len(OBSERVABLES))
    # Most effects change no property on which forces and observables depend; skip these.
    if not same_forces(up, down):
        push = (forces(up, *at_rest) - forces(down, *at_rest)) / size
        if not same_observables(up, down):
            direct = (observe(up, *at_rest).array() - observe(down, *at_rest).array()) / size
    return push, direct, *((one - other) / size for one, other in zip(*cases, strict=True))


def _carried(
    gear: GearModel,
    found: Equilibrium,
    jacobian: FloatArray,
    acting: EffectSet,
    rows: Sequence[tuple[FloatArray, ...]],
    at: Situation,
) -> FloatArray:
    """Return the change of the readings (n_observables, n) in the new equilibrium."""
    pushes, direct, towed, shown = (np.column_stack(part) for part in zip(*rows, strict=True))
    along = np.zeros(direct.shape)
    if pushes.any():
        shifts = solve_refined(rest_linearisation(gear, found.state, found.tow).factor, pushes)
        along = observed_slopes(gear, found.state, found.tow, shifts)[1]
    change = along + direct + jacobian[:, -3:] @ towed
    readings: FloatArray = sensor_slopes(acting, found.observables.array(), at) @ change + shown
    return readings


def sensor_slopes(acting: EffectSet, values: FloatArray, at: Situation) -> FloatArray:
    """Return derivatives (n_observables, n_observables) of readings by the observables ``values``.

    Most sensors show only their own observable; swapped ones show that of the other side.
    """
    if not acting.on_sensors:
        return np.eye(len(values))
    sizes = 1e-6 * np.maximum(np.abs(values), 1e-3)
    columns = []
    for step, size in zip(np.diag(sizes), sizes, strict=True):
        up, down = (shown_values(acting, values + sign * step, at) for sign in (1.0, -1.0))
        columns.append((up - down) / (2.0 * size))
    return np.column_stack(columns)


def _three(inputs: FloatArray) -> tuple[float, float, float]:
    port, starboard, speed = map(float, inputs)
    return port, starboard, speed
