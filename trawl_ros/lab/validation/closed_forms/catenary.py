# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hanging wire, and wire sagging between two points, against closed forms."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import root

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.lone_line import SEA, WIRE, holding, loaded, lone_line, settled
from trawl_ros.lab.report.measured import MeasuredValue, at_least, within_share
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.closed_forms.refinement import order, refinement_figure
from trawl_ros.model.assembly import block_forces
from trawl_ros.model.bar import SLACK_WIDTH
from trawl_ros.report.pictures import Drawing

WEIGHT, STIFFNESS = WIRE['weight_in_water_n_m'], WIRE['stiffness_n']

HANGING_LENGTH = 600.0
HUNG_LOAD = 20_000.0
"""Weight in water (N) at the end of a wire that is taut over its whole length."""

SAGGING_LENGTH = 480.0
START, END = np.array([0.0, 0.0, -20.0]), np.array([400.0, 0.0, -60.0])

SEGMENTS = (5, 10, 20, 40, 80)
CLAIMED = 20


def stretch_of_hanging(load: float) -> float:
    """Elastic elongation (m) of a hanging wire by eq. 20, with a weight at its end (N)."""
    return (load * HANGING_LENGTH + 0.5 * WEIGHT * HANGING_LENGTH**2) / STIFFNESS


def rounded_off() -> float:
    """Elongation (m) lost by the smooth transition between slack and taut.

    Below w EA of tension a bar is strained by 2 √(w T / EA) - w and not by T / EA; integrated
    over the lower part of a wire that carries nothing but itself.
    """
    return SLACK_WIDTH**2 / 6.0 * STIFFNESS / WEIGHT


def hanging(segments: int, load: float = 0.0) -> tuple[float, float]:
    """Stretch (m) and pull at the block (N) of a hanging wire as modelled."""
    model = loaded(lone_line(WIRE, segments, SEA), load / SEA.gravity, 0.0, 0.0)
    tow = holding(HANGING_LENGTH, np.zeros(3), np.zeros(3))
    share = np.arange(1, segments + 1)[:, None] / segments
    state = settled(model, share * HANGING_LENGTH * np.array([0.0, 0.0, -1.0]), tow)
    pull = float(np.linalg.norm(block_forces(model, state, tow)[0]))
    return -float(state.nodes[-1, 2]) - HANGING_LENGTH, pull


@dataclass(frozen=True)
class Sagging:
    """Shape and end forces of a sagging wire.

    ``places`` (n, 3) are points at equal distances along the wire, m. ``pulls`` (2, 3) are its
    forces on both supports, N.
    """

    places: FloatArray
    pulls: FloatArray


def elastic_catenary(points: int) -> Sagging:
    """Elastic catenary between `START` and `END`, at ``points`` equal pieces.

    With H the horizontal and V the vertical pull at the start, at the unstretched length s:
    x = H s / EA + H/w (asinh((w s - V) / H) + asinh(V / H)),
    z = (w s² / 2 - V s) / EA + (√(H² + (w s - V)²) - √(H² + V²)) / w.
    """

    def place(s: FloatArray, across: float, up: float) -> tuple[FloatArray, FloatArray]:
        below = WEIGHT * s - up
        x = across * s / STIFFNESS
        x = x + across / WEIGHT * (np.arcsinh(below / across) + np.arcsinh(up / across))
        z = (0.5 * WEIGHT * s**2 - up * s) / STIFFNESS
        return x, z + (np.hypot(across, below) - np.hypot(across, up)) / WEIGHT

    def missed(pull: FloatArray) -> FloatArray:
        distance: FloatArray = (
            np.array(place(np.array(SAGGING_LENGTH), *pull)) - (END - START)[[0, 2]]
        )
        return distance

    half = 0.5 * WEIGHT * SAGGING_LENGTH
    across, up = root(missed, np.array([half, half]), tol=1e-13).x
    x, z = place(np.linspace(0.0, SAGGING_LENGTH, points + 1), across, up)
    return Sagging(
        places=START + np.stack([x, np.zeros_like(x), z], axis=1),
        pulls=np.array([[across, 0.0, -up], [-across, 0.0, up - WEIGHT * SAGGING_LENGTH]]),
    )


def sagging(segments: int) -> Sagging:
    """The sagging wire as modelled."""
    model = lone_line(WIRE, segments, SEA, 'at both ends')
    tow = holding(SAGGING_LENGTH, START, END)
    share = np.arange(1, segments)[:, None] / segments
    bow = 200.0 * share * (1.0 - share) * np.array([0.0, 0.0, -1.0])
    state = settled(model, START + share * (END - START) + bow, tow)
    return Sagging(
        places=np.concatenate([START[None], state.nodes, END[None]]),
        pulls=block_forces(model, state, tow),
    )


def run(quick: bool) -> Findings:
    """Compare both wires with their closed forms, the sagging wire at several segment counts."""
    counts = SEGMENTS[1:4] if quick else SEGMENTS
    models = {count: sagging(count) for count in counts}
    exact = {count: elastic_catenary(count) for count in counts}
    errors = {
        'shape': [
            float(np.linalg.norm(models[n].places - exact[n].places, axis=1).max()) / SAGGING_LENGTH
            for n in counts
        ],
        'horizontal pull': [abs(models[n].pulls[0, 0] / exact[n].pulls[0, 0] - 1) for n in counts],
        'pull at the start': [
            abs(np.linalg.norm(models[n].pulls[0]) / np.linalg.norm(exact[n].pulls[0]) - 1)
            for n in counts
        ],
    }
    checks = [*_hanging_checks(), *_sagging_checks(models[CLAIMED], exact[CLAIMED])]
    checks += [
        MeasuredValue(
            f'order of convergence of the sagging wire, {key}',
            order(counts, values),
            target=at_least(1.9),
            note='A lumped line is of second order in the length of its segments.',
            key=f'order_of_{key.replace(" ", "_")}',
        )
        for key, values in errors.items()
    ]
    rows = tuple(
        (str(n), *(f'{values[k]:.2e}' for values in errors.values())) for k, n in enumerate(counts)
    )
    return Findings(
        rows=tuple(checks),
        drawings=(
            Drawing(
                'convergence',
                'Relative errors of the sagging wire against the elastic catenary; the shape is '
                'the largest distance of a node from its place, over the length.',
                refinement_figure(counts, errors, 'Sagging wire, 480 m between points 402 m apart'),
            ),
            Drawing('shape', 'The sagging wire.', _shape(models[CLAIMED])),
        ),
        tables=(
            TextTable(
                'Relative errors of the sagging wire.',
                ('segments', *errors),
                rows,
            ),
        ),
        text='A wire of 32 mm in still water, hanging with nothing and with 20 kN at its end, and '
        'sagging between two points at unequal depth. Bars pass from slack to taut over a '
        'strain of ±1e-4, which shortens the wire that hangs alone by '
        f'{1e3 * rounded_off():.1f} mm against eq. 20; its stretch is held against a closed form '
        'with that term.',
    )


def _hanging_checks() -> list[MeasuredValue]:
    stretch, pull = hanging(CLAIMED)
    fine, _ = hanging(2 * CLAIMED)
    loaded_stretch, loaded_pull = hanging(CLAIMED, HUNG_LOAD)
    alone = 'a wire of 600 m hanging alone'
    under = 'a wire of 600 m hanging with 20 kN at its end, 20 segments'
    weight, exact = WEIGHT * HANGING_LENGTH, stretch_of_hanging(0.0)
    rounding = (
        'w L² / 2 EA less the rounding between slack and taut, in closed form. There strain is a '
        'square root of tension, which makes this figure of order 1.5 only'
    )
    letter = '(P L + w L² / 2) / EA; taut all along, so eq. 20 holds to the letter'
    loaded = stretch_of_hanging(HUNG_LOAD)
    rows = (
        ('hanging_depth', f'depth of the end of {alone}, 20 segments', HANGING_LENGTH + stretch,
         'm', 1e-5, HANGING_LENGTH + exact, 'L + w L² / 2 EA'),
        ('hanging_stretch', f'stretch of {alone}, 40 segments', fine, 'm',
         1e-3, exact - rounded_off(), rounding),
        ('hanging_tension', f'pull at the block of {alone}, 20 segments', pull, 'N',
         1e-6, weight, 'the weight of the wire'),
        ('loaded_stretch', f'stretch of {under}', loaded_stretch, 'm', 1e-6, loaded, letter),
        ('loaded_tension', f'pull at the block of {under}', loaded_pull, 'N',
         1e-6, HUNG_LOAD + weight, 'the weight of wire and load'),
    )  # fmt: skip
    return [
        MeasuredValue(
            what, value, unit, within_share(share, of=wanted), f'Expected: {why}.', key=key
        )
        for key, what, value, unit, share, wanted, why in rows
    ]


def _sagging_checks(model: Sagging, exact: Sagging) -> list[MeasuredValue]:
    what = 'of the sagging wire, 20 segments'
    pairs = {
        'lowest_node': (f'height of the lowest node {what}', model.places, exact.places, 'm'),
        'horizontal': (f'horizontal pull {what}', model.pulls, exact.pulls, 'N'),
        'start': (f'pull at the start {what}', model.pulls, exact.pulls, 'N'),
        'end': (f'pull at the end {what}', model.pulls, exact.pulls, 'N'),
    }
    read: dict[str, Callable[[FloatArray], float]] = {
        'lowest_node': lambda a: a[:, 2].min(),
        'horizontal': lambda a: a[0, 0],
        'start': lambda a: float(np.linalg.norm(a[0])),
        'end': lambda a: float(np.linalg.norm(a[1])),
    }
    return [
        MeasuredValue(
            text,
            float(read[key](found)),
            unit,
            within_share(1e-3, of=float(read[key](wanted))),
            'Expected: the elastic catenary.',
            key=f'sagging_{key}',
        )
        for key, (text, found, wanted, unit) in pairs.items()
    ]


def _shape(model: Sagging) -> Figure:
    figure, (axes,) = panes(6.4, 3.6)
    axes.plot(*elastic_catenary(200).places[:, [0, 2]].T, '-', label='elastic catenary')
    axes.plot(*model.places[:, [0, 2]].T, 'o', ms=4, label=f'model, {CLAIMED} segments')
    axes.set(xlabel='x [m]', ylabel='above the surface [m]', aspect='equal')
    axes.legend()
    return figure


CASE = ValidationCase('catenary', 'Hanging and sagging wire', run)
