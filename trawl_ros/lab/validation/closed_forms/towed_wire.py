# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Towed elastic wire with a lump at its end, compared with integration along the wire."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.own_wire import own_model, own_steady
from trawl_ros.lab.reference_codes.towed_wire import INTEGRATED, UNITS, WIRE, WireSteadyState
from trawl_ros.lab.report.measured import MeasuredValue, at_least, within_share
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.closed_forms.refinement import order, refinement_figure
from trawl_ros.report.pictures import Drawing

SEGMENTS = (5, 10, 20, 40, 80)
CLAIMED = 20
"""Segments at which an error of 0.1 % is claimed."""


@dataclass(frozen=True)
class Wire(WireSteadyState):
    """Steady state with its shape.

    ``places`` (n, 2) are points at equal distances along the wire, from the block on: ahead and
    up, m.
    """

    places: FloatArray


def integrated(points: int) -> Wire:
    """The steady wire by integration from its lower end upward, at ``points`` equal pieces.

    With the unstretched length σ from the lower end, t the direction up the wire and T the
    tension: d(T t)/dσ = -(weight + drag), dr/dσ = (1 + T / EA) t. At σ = 0 the tension holds the
    lump's weight and drag, so that the integration needs no shooting.
    """
    across = 0.5 * WIRE.density * WIRE.normal_drag * WIRE.diameter
    along = 0.5 * WIRE.density * WIRE.tangential_drag * np.pi * WIRE.diameter
    flow = np.array([-WIRE.speed, 0.0])

    def slope(_: float, y: FloatArray) -> FloatArray:
        tension = np.hypot(y[0], y[1])
        t = y[:2] / tension
        slide = flow @ t
        cross = flow - slide * t
        load = across * np.hypot(*cross) * cross + along * abs(slide) * slide * t
        load[1] -= WIRE.weight_in_water
        return np.concatenate([-load, (1.0 + tension / WIRE.stiffness) * t])

    heavy = (WIRE.lump_mass - WIRE.density * WIRE.lump_volume) * WIRE.gravity
    resistance = 0.5 * WIRE.density * WIRE.lump_drag_area * WIRE.speed**2
    at = np.linspace(0.0, WIRE.length, points + 1)
    found = solve_ivp(
        slope,
        (0.0, WIRE.length),
        np.array([resistance, heavy, 0.0, 0.0]),
        method='DOP853',
        t_eval=at,
        rtol=1e-12,
        atol=1e-9,
    )
    top = found.y[:, -1]
    places = (found.y[2:] - top[2:, None]).T[::-1]
    return Wire(
        depth=float(top[3]),
        lag=float(top[2]),
        tension=float(np.hypot(top[0], top[1])),
        places=places,
    )


def modelled(segments: int) -> Wire:
    """Return the steady wire of the gear model."""
    state, found = own_steady(WIRE, own_model(WIRE, segments))
    places = np.concatenate([np.zeros((1, 2)), state.nodes[:, [0, 2]]])
    return Wire(**vars(found), places=places)


def run(quick: bool) -> Findings:
    """Compare at several numbers of segments."""
    counts = SEGMENTS[1:4] if quick else SEGMENTS
    exact = {count: integrated(count) for count in counts}
    wires = {count: modelled(count) for count in counts}
    claimed, reference = wires[CLAIMED], exact[CLAIMED]
    checks = [
        MeasuredValue(
            f'{key} of the wire, 20 segments',
            getattr(claimed, key),
            unit,
            within_share(1e-3, of=getattr(reference, key)),
            'Expected: the integrated equation.',
            key=f'{key}_at_20_segments',
        )
        for key, unit in UNITS.items()
    ]
    checks += [
        MeasuredValue(
            f'{key} by the equation integrated here',
            getattr(reference, key),
            unit,
            within_share(2e-6, of=getattr(INTEGRATED, key)),
            'Expected: an integration of the same wire made before this model, to its digits.',
            key=f'integrated_{key}',
        )
        for key, unit in UNITS.items()
    ]
    shape = [
        float(np.linalg.norm(wires[n].places - exact[n].places, axis=1).max()) / WIRE.length
        for n in counts
    ]
    errors = {
        key: [abs(getattr(wires[n], key) / getattr(exact[n], key) - 1.0) for n in counts]
        for key in UNITS
    }
    orders = {'shape': shape, **errors}
    checks += [
        MeasuredValue(
            f'order of convergence of the {key}',
            order(counts, values),
            target=at_least(1.9),
            note='A lumped line is of second order in the length of its segments.',
            key=f'order_of_{key}',
        )
        for key, values in orders.items()
    ]
    rows = tuple(
        (str(n), f'{wires[n].depth:.4f}', f'{wires[n].lag:.4f}', f'{wires[n].tension:.2f}')
        for n in counts
    )
    last = ('integrated', f'{reference.depth:.4f}', f'{reference.lag:.4f}')
    return Findings(
        rows=tuple(checks),
        drawings=(
            Drawing(
                'convergence',
                'Relative errors of the towed wire against the integrated equation; the shape is '
                'the largest distance of a node from its place, over the length.',
                refinement_figure(counts, orders, 'Towed wire, 600 m at 2 m/s'),
            ),
            Drawing('shape', 'The wire as modelled and as integrated.', _shape(claimed)),
        ),
        tables=(
            TextTable(
                'The towed wire at several numbers of segments.',
                ('segments', 'depth [m]', 'lag [m]', 'top tension [N]'),
                (*rows, (*last, f'{reference.tension:.2f}')),
            ),
        ),
        text='A steel wire of 600 m and 32 mm, towed at 2 m/s with a lump of 2000 kg at its end.',
    )


def _shape(claimed: Wire) -> Figure:
    figure, (axes,) = panes(6.4, 4.2)
    fine = integrated(200)
    axes.plot(*fine.places.T, '-', label='integrated')
    axes.plot(*claimed.places.T, 'o', ms=4, label=f'model, {CLAIMED} segments')
    axes.set(xlabel='ahead of the block [m]', ylabel='above the surface [m]', aspect='equal')
    axes.legend()
    return figure


CASE = ValidationCase('towed_wire', 'Towed elastic wire', run)
