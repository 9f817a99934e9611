# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Free rotation of boards without water and weight: conserved energy and angular momentum."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.lone_line import WIRE, holding, lone_line, lying
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.closed_forms.refinement import order
from trawl_ros.model.assembly import forces, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.rotations import rotation
from trawl_ros.model.state import State, Tow
from trawl_ros.model.water import Water
from trawl_ros.report.pictures import Drawing
from trawl_ros.solver.stepper import Motion, Stepper

VOID = Water(density=1e-12, gravity=0.0)

DURATION_S = 100.0
STEPS = (0.8, 0.4, 0.2)
"""Time steps (s); the last one is that of a simulation."""

SHORT_STEP_S = 0.05
"""A step (s) much shorter than a simulation's."""

RATES = 0.2 * np.array([[1.0, 0.01, 0.02], [0.4, 0.5, 0.6]])
"""Initial rates of turn of both boards about their own axes, rad/s."""


@dataclass(frozen=True)
class Spin:
    """Conservation of momentum and energy of freely rotating boards.

    Attributes
    ----------
    times : (k,) array
        In s.
    momentum, energy : (k,) arrays
        Changes of the angular momentum (length of the difference vector, larger of both boards) and
        of the kinetic energy, as shares of the initial values.
    upright : (k, 2) array
        Cosine of the angle between each board's z axis and its initial direction.
    """

    times: FloatArray
    momentum: FloatArray
    energy: FloatArray
    upright: FloatArray


def spinning() -> tuple[GearModel, State, Tow]:
    """Return two spinning boards of the default gear, port about its axis of middle inertia.

    This spin is unstable: the board tumbles.
    """
    model = lone_line(WIRE, 3, VOID)
    tow = holding(60.0, np.zeros(3), np.zeros(3))
    turn = rotation(np.array([0.3, -0.2, 0.5]))
    line = lying(np.array([[-10.0, 0.0, 0.0], [-20.0, 0.0, 0.0], [-30.0, 0.0, 0.0]]), np.zeros(3))
    state = State(
        nodes=line.nodes,
        board_positions=line.board_positions,
        board_rotations=np.stack([turn, turn.T]),
        node_velocities=line.node_velocities,
        board_velocities=np.array([[1.0, 0.2, -0.1], [0.5, 0.0, 0.0]]),
        board_rates=np.stack([turn @ RATES[0], turn.T @ RATES[1]]),
    )
    return model, state, tow


def momentum_and_energy(model: GearModel, state: State) -> tuple[FloatArray, float]:
    """Angular momentum (2, 3), in N m s, and kinetic energy (J) of both boards.

    The momentum is about the centres of gravity. Both come from the gear file's inertia, in the
    board's own axes.
    """
    about = model.gear.board.inertia
    momentum, energy = np.zeros((2, 3)), 0.0
    for side, mirror in enumerate((1.0, -1.0)):
        # Mirrored in x-z, the products of inertia with y change their sign.
        xy, yz = mirror * about.xy_kg_m2, mirror * about.yz_kg_m2
        turn = state.board_rotations[side]
        p, q, r = turn.T @ state.board_rates[side]
        own = np.array(
            [
                about.xx_kg_m2 * p - xy * q - about.xz_kg_m2 * r,
                about.yy_kg_m2 * q - xy * p - yz * r,
                about.zz_kg_m2 * r - about.xz_kg_m2 * p - yz * q,
            ]
        )
        momentum[side] = turn @ own
        energy += 0.5 * float(own @ (p, q, r))
        energy += 0.5 * model.gear.board.mass_kg * float(np.sum(state.board_velocities[side] ** 2))
    return momentum, energy


def spun(h: float, seconds: float) -> Spin:
    """Return the boards' motion by the stepper, in steps of ``h`` seconds."""
    model, state, tow = spinning()
    inertia = model.pattern.matrix(mass(model, state, tow)).toarray()
    first = np.linalg.solve(inertia, forces(model, state, tow))
    before, energy = momentum_and_energy(model, state)
    size = np.linalg.norm(before, axis=1)
    stepper, motion = Stepper(model), Motion(state, first, first)
    rows = [(0.0, 0.0, 0.0, 1.0, 1.0)]
    for k in range(round(seconds / h)):
        motion = stepper.step(motion, tow, h)
        after, left = momentum_and_energy(model, motion.state)
        upright = np.einsum(
            'si,si->s', motion.state.board_rotations[:, :, 2], state.board_rotations[:, :, 2]
        )
        rows.append(
            (
                (k + 1) * h,
                float((np.linalg.norm(after - before, axis=1) / size).max()),
                abs(left / energy - 1.0),
                *upright,
            )
        )
    table = np.array(rows)
    return Spin(table[:, 0], table[:, 1], table[:, 2], table[:, 3:])


def run(quick: bool) -> Findings:
    """Let the boards spin with decreasing steps."""
    seconds = 0.5 * DURATION_S if quick else DURATION_S
    spins = {h: spun(h, seconds) for h in (STEPS if quick else (*STEPS, SHORT_STEP_S))}
    momentum = {h: float(spin.momentum.max()) for h, spin in spins.items()}
    energy = {h: float(spin.energy.max()) for h, spin in spins.items()}
    usual = STEPS[-1]
    kept = (
        ('momentum', 'angular momentum', momentum, 5e-3),
        ('energy', 'kinetic energy', energy, 1e-3),
    )
    counts = [round(seconds / h) for h in STEPS]
    checks = [
        *(
            MeasuredValue(
                f'largest drift of the {what} in {seconds:.0f} s, steps of {usual} s',
                drift[usual],
                target=at_most(most),
                note='As a share of it; a free body keeps it, but for the error of the time '
                'stepper.',
                key=key,
            )
            for key, what, drift, most in kept
        ),
        *(
            MeasuredValue(
                f'order with which the drift of the {what} falls with the step',
                order(counts, [drift[h] for h in STEPS]),
                target=at_least(1.9),
                note='The drift is the error of the time stepper, which is of second order.',
                key=f'order_of_{key}',
            )
            for key, what, drift, _ in kept
        ),
        MeasuredValue(
            'least cosine between the port board’s z axis and its first',
            float(spins[usual].upright[:, 0].min()),
            target=at_most(-0.9),
            note='It turns over: what is kept is kept through large rotations.',
            key='tumbles',
        ),
    ]
    if not quick:
        checks.append(_floor(momentum[SHORT_STEP_S]))
    rows = tuple((f'{h:g}', f'{momentum[h]:.2e}', f'{energy[h]:.2e}') for h in spins)
    return Findings(
        rows=tuple(checks),
        drawings=(
            Drawing(
                'drift',
                'Drift of angular momentum and energy of two free boards, and how the port one '
                'tumbles.',
                _drawn(spins),
            ),
        ),
        tables=(
            TextTable(
                'Largest drift as a share.',
                ('step [s]', 'angular momentum', 'energy'),
                rows,
            ),
        ),
        text='Two boards without ropes, water or weight, one of them spinning about its axis of '
        'middle inertia. The gyroscopic moment, which eq. 15 drops, is kept.',
    )


def _floor(drift: float) -> MeasuredValue:
    return MeasuredValue(
        f'largest drift of the angular momentum in {DURATION_S:.0f} s, steps of {SHORT_STEP_S} s',
        drift,
        target=at_most(1e-3),
        note='With the error of the method out of the way, it is the equations that keep it.',
        key='short_steps',
    )


def _drawn(spins: dict[float, Spin]) -> Figure:
    figure, (above, middle, below) = panes(7.0, 6.4, 3, sharex=True)
    for h, spin in spins.items():
        above.semilogy(spin.times[1:], spin.momentum[1:], label=f'steps of {h:g} s')
        middle.semilogy(spin.times[1:], spin.energy[1:], label=f'steps of {h:g} s')
    finest = spins[min(spins)]
    below.plot(finest.times, finest.upright, label=('port', 'starboard'))
    above.set(ylabel='angular momentum,\ndrift as a share [-]')
    middle.set(ylabel='kinetic energy,\ndrift as a share [-]')
    below.set(ylabel='cosine of z axis\nagainst its first [-]', xlabel='time [s]')
    for axes in (above, middle, below):
        axes.legend()
    return figure


CASE = ValidationCase('free_rotation', 'Free rotation of a board', run)
