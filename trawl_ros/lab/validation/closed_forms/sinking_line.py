# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Free line sinking in still water, compared with the speed at which drag balances its weight."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.lone_line import SEA, WIRE, holding, lone_line, lying
from trawl_ros.lab.report.measured import MeasuredValue, at_most, within_share
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.model.assembly import forces, mass
from trawl_ros.report.pictures import Drawing
from trawl_ros.solver.stepper import Motion, Stepper

LENGTH, SEGMENTS = 200.0, 20
SLOPES = (0.0, 30.0)
"""Angles (degrees) of the line below the horizontal; its start is the upper end."""

SLACK_NODE_DISTANCE = 1.0 - 2e-4
"""Distance of the nodes over the segments' length, for a line that is slack everywhere."""

TIME_STEP = 0.01

DURATION_S = 8.0
"""Time (s) after which the slowest motion is within 1e-6 of its final speed."""


@dataclass(frozen=True)
class Sinking:
    """Velocities of a sinking line.

    Attributes
    ----------
    times : (k,) array
        In s.
    velocities : (k, 2) array
        Velocity of the line's middle along the line and across it, downward positive, m/s.
    uneven
        Largest difference between the velocities of two nodes at the end, m/s.
    """

    times: FloatArray
    velocities: FloatArray
    uneven: float


def terminal(slope: float) -> FloatArray:
    """Terminal speeds (2,) m/s along and across a line, at which drag balances its weight.

    w sin φ = ½ ρ C_t π d u², w cos φ = ½ ρ C_n d u².
    """
    diameter = WIRE['diameter_m']
    weights = WIRE['weight_in_water_n_m'] * np.array([np.sin(slope), np.cos(slope)])
    drags = np.array([WIRE['tangential_drag'] * np.pi, WIRE['normal_drag']])
    return np.sqrt(weights / (0.5 * SEA.density * diameter * drags))


def fall(slope: float, times: FloatArray) -> FloatArray:
    """Speeds (k, 2) m/s along and across a line released from rest: U tanh(w t / m U).

    The mass m includes added mass across the line (coefficient 1), and none along it.
    """
    displaced = SEA.density * np.pi / 4 * WIRE['diameter_m'] ** 2
    own = WIRE['weight_in_water_n_m'] / SEA.gravity + displaced
    masses = np.array([own, own + displaced])
    weights = WIRE['weight_in_water_n_m'] * np.array([np.sin(slope), np.cos(slope)])
    final = terminal(slope)
    time_constants = masses * final / np.where(weights > 0.0, weights, 1.0)
    safe = np.where(time_constants > 0.0, time_constants, 1.0)
    return final * np.tanh(times[:, None] / safe)


def sinking(slope: float, seconds: float) -> Sinking:
    """Return the motion of a line released from rest, by the stepper."""
    model = lone_line(
        {**WIRE, 'added_mass_normal': 1.0, 'added_mass_tangential': 0.0}, SEGMENTS, SEA, 'nowhere'
    )
    along = np.array([np.cos(slope), 0.0, -np.sin(slope)])
    across = np.array([-np.sin(slope), 0.0, -np.cos(slope)])
    place = np.linspace(0.0, SLACK_NODE_DISTANCE * LENGTH, SEGMENTS + 1)[:, None]
    state = lying(np.array([0.0, 0.0, -50.0]) + place * along, np.zeros(3))
    tow = holding(LENGTH, np.zeros(3), np.zeros(3))
    inertia = model.pattern.matrix(mass(model, state, tow)).toarray()
    first = np.linalg.solve(inertia, forces(model, state, tow))
    stepper, motion = Stepper(model), Motion(state, first, first)
    steps = round(seconds / TIME_STEP)
    middle = SEGMENTS // 2
    speeds = [np.zeros(2)]
    for _ in range(steps):
        motion = stepper.step(motion, tow, TIME_STEP)
        velocity = motion.state.node_velocities[middle]
        speeds.append(np.array([velocity @ along, velocity @ across]))
    return Sinking(
        times=TIME_STEP * np.arange(steps + 1, dtype=float),
        velocities=np.array(speeds),
        uneven=float(np.ptp(motion.state.node_velocities, axis=0).max()),
    )


def run(quick: bool) -> Findings:
    """Release a level line and a sloping one."""
    found = {slope: sinking(np.radians(slope), DURATION_S) for slope in SLOPES}
    level, sloping = (found[slope] for slope in SLOPES)
    across_level = terminal(0.0)[1]
    along, across = terminal(np.radians(SLOPES[1]))
    sloped = 'a line that slopes by 30°'
    last = (
        ('level', 'sinking speed of a level line', level, 1, across_level, 'w = ½ ρ C_n d U²'),
        ('sloping_across', f'speed across {sloped}', sloping, 1, across, 'w cos φ = ½ ρ C_n d U²'),
        ('sloping_along', f'speed along {sloped}', sloping, 0, along, 'w sin φ = ½ ρ C_t π d U²'),
    )
    history = {
        slope: float(
            np.abs(line.velocities - fall(np.radians(slope), line.times)).max()
            / terminal(np.radians(slope)).max()
        )
        for slope, line in found.items()
    }
    checks = (
        *(
            MeasuredValue(
                f'last {what}',
                float(line.velocities[-1, part]),
                'm/s',
                within_share(1e-4, of=float(wanted)),
                f'Expected: the speed at which drag carries the weight, {law}.',
                key=key,
            )
            for key, what, line, part, wanted, law in last
        ),
        MeasuredValue(
            'largest difference of velocity between two nodes at the end',
            max(line.uneven for line in found.values()),
            'm/s',
            at_most(1e-6),
            'Weight and drag are alike all along, so the line keeps straight.',
            key='together',
        ),
        *(
            MeasuredValue(
                f'largest error of the speed on the way, line sloping by {slope:.0f}°, as a '
                'share of the last speed',
                error,
                target=at_most(1e-3),
                note=f'Against U tanh(w t / m U), with steps of {TIME_STEP} s.',
                key=f'history_{slope:.0f}',
            )
            for slope, error in history.items()
        ),
    )
    rows = tuple(
        (
            f'{slope:.0f}',
            f'{line.velocities[-1, 0]:.5f}',
            f'{terminal(np.radians(slope))[0]:.5f}',
            f'{line.velocities[-1, 1]:.5f}',
            f'{terminal(np.radians(slope))[1]:.5f}',
        )
        for slope, line in found.items()
    )
    return Findings(
        rows=checks,
        drawings=(Drawing('speed', 'Speed of a free line let go from rest.', _drawn(found)),),
        tables=(
            TextTable(
                'Last speeds.',
                (
                    'slope [°]',
                    'along, model [m/s]',
                    'along, closed form [m/s]',
                    'across, model [m/s]',
                    'across, closed form [m/s]',
                ),
                rows,
            ),
        ),
        text='A steel wire of 200 m and 32 mm, free at both ends, let go from rest in still water.',
    )


def _drawn(found: dict[float, Sinking]) -> Figure:
    figure, (axes,) = panes(6.4, 4.2)
    fine = np.linspace(0.0, DURATION_S, 400)
    for slope, line in found.items():
        exact = fall(np.radians(slope), fine)
        for part, name in enumerate(('along', 'across')):
            if slope == 0.0 and name == 'along':
                continue
            (curve,) = axes.plot(fine, exact[:, part], '-', label=f'{slope:.0f}°, {name}')
            axes.plot(
                line.times[::40], line.velocities[::40, part], 'o', ms=4, color=curve.get_color()
            )
    axes.plot([], [], 'ko', ms=4, label='model')
    axes.set(xlabel='time [s]', ylabel='speed [m/s]', xlim=(0.0, DURATION_S))
    axes.legend()
    return figure


CASE = ValidationCase('sinking_line', 'Terminal sinking of a free line', run)
