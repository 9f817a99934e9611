# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loads on a board at random attitudes, compared with separately coded equations of the paper."""

from dataclasses import dataclass, replace
from math import pi, radians

import numpy as np
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.boards import BoardRecord
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.closed_forms.paper_board import PaperBoard, coefficients
from trawl_ros.model.assembly import board_loads, points_of
from trawl_ros.model.board_laws import EQ14
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.state import State
from trawl_ros.model.water import Water
from trawl_ros.report.pictures import Drawing
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow

ATTITUDES = 50
TOLERANCE = 1e-9

WATER = Water(
    density=1024.0,
    density_gradient=0.02,
    depths=np.array([0.0, 100.0, 300.0]),
    currents=np.array([[0.3, -0.1], [0.1, 0.2], [-0.2, 0.1]]),
)
"""Water whose density and current vary with depth, to show that both are evaluated locally."""

WITHIN = (0.0, radians(40.0)), (radians(-40.0), radians(40.0))
"""Ranges of attack and slip in which eq. 14 holds unchanged."""

ANYWHERE = (-pi, pi), (radians(-85.0), radians(85.0))
"""Ranges of attack, and of the angle of the flow to the plane across the span."""


@dataclass(frozen=True)
class LoadDifferences:
    """Largest differences, as shares of the force and of the moment.

    ``attack`` holds the smallest and largest attack angles (rad) that occurred.
    """

    force: float
    moment: float
    attack: tuple[float, float]


def moving_at(
    model: GearModel, random: np.random.Generator, attack: FloatArray, slip: FloatArray
) -> State:
    """Place both boards at random attitudes in a flow at given angles (2,).

    ``slip`` is that of eq. 2 for flow from ahead.
    """
    outward = np.array([1.0, -1.0])
    flow = np.stack([-np.cos(attack), np.sin(attack), np.tan(slip) * np.abs(np.cos(attack))], 1)
    flow *= random.uniform(0.5, 4.0, (2, 1)) / np.linalg.norm(flow, axis=1)[:, None]
    flow[:, 1] *= outward
    turns = Rotation.from_quat(random.normal(size=(2, 4))).as_matrix()
    places = random.uniform([-500.0, -100.0, -250.0], [0.0, 100.0, -5.0], (2, 3))
    rates = random.normal(0.0, 0.1, (2, 3))
    velocities = WATER.current(places[:, 2]) - np.einsum('sij,sj->si', turns, flow)
    still = State(
        nodes=np.zeros((model.nodes, 3)),
        board_positions=places,
        board_rotations=turns,
        node_velocities=np.zeros((model.nodes, 3)),
        board_velocities=velocities,
        board_rates=rates,
    )
    # The velocity of eq. 4 is that of the vertices, which a turning board moves as well.
    points = points_of(model, still, steady_tow(model, OperatingPoint(500.0, 500.0, 2.0)))
    ahead = np.cross(rates[:, None], points.arms).mean(1)
    return replace(still, board_velocities=velocities - ahead)


def on_paper(gear: GearRecord, model: GearModel, state: State) -> list[PaperBoard]:
    """Return the same two boards in the paper's terms: vertices and their velocities."""
    tow = steady_tow(model, OperatingPoint(500.0, 500.0, 2.0))
    points = points_of(model, state, tow)
    places = points.positions[model.nodes : model.nodes + 6].reshape(2, 3, 3)
    speeds = points.velocities[model.nodes : model.nodes + 6].reshape(2, 3, 3)
    heights = state.board_positions[:, 2]
    return [
        PaperBoard(
            gear.board,
            side == 0,
            a=places[side, 0],
            b=places[side, 1],
            c=places[side, 2],
            va=speeds[side, 0],
            vb=speeds[side, 1],
            vc=speeds[side, 2],
            rate=state.board_rates[side],
            water=WATER.current(heights[side]),
            density=float(WATER.density_at(heights[side])),
            gravity=WATER.gravity,
        )
        for side in range(2)
    ]


def compare_laws(
    gear: GearRecord,
    random: np.random.Generator,
    *,
    within: bool,
    paper: GearRecord | None = None,
) -> LoadDifferences:
    """Compare both boards at all attitudes, with the equations of ``gear`` or of ``paper``."""
    model = replace(build_model(gear), water=WATER)
    # The gyroscopic moment is no part of eq. 1-14.
    model = model.with_board(inertia=np.zeros((3, 3)))
    of_force, of_moment = [], []
    seen: list[float] = []
    for _ in range(ATTITUDES):
        attacks, slips = WITHIN if within else ANYWHERE
        attack, slip = random.uniform(*attacks, 2), random.uniform(*slips, 2)
        state = moving_at(model, random, attack, slip)
        loads = board_loads(model, state)
        for board, load in zip(on_paper(paper or gear, model, state), loads, strict=True):
            force, moment = board.load()
            of_force.append(np.linalg.norm(load[:3] - force) / np.linalg.norm(force))
            of_moment.append(np.linalg.norm(load[3:] - moment) / np.linalg.norm(moment))
        seen.extend(attack)
    return LoadDifferences(
        float(max(of_force)), float(max(of_moment)), (float(min(seen)), float(max(seen)))
    )


def run(quick: bool) -> Findings:
    """Compare inside and outside the range of the law."""
    random = np.random.default_rng(20)
    default = load_gear('kaifuha')
    checks, rows = [], []
    for within in (True, False):
        found = compare_laws(default, random, within=within)
        where = 'within' if within else 'anywhere'
        what = (
            f'at {ATTITUDES} random attitudes on each side, {where} '
            f'{"the range of eq. 14" if within else "around the board"}'
        )
        for part in ('force', 'moment'):
            checks.append(
                MeasuredValue(
                    f'largest difference of the {part} {what}, as a share of it',
                    getattr(found, part),
                    target=at_most(TOLERANCE),
                    note='Against eq. 1-14 evaluated from the vertices of the board.',
                    key=f'{part}_{where}',
                )
            )
        low, high = np.degrees(found.attack)
        rows.append(
            (where, f'{low:.0f} to {high:.0f}', f'{found.force:.1e}', f'{found.moment:.1e}')
        )
    checks.extend(_continuation_checks(default.board))
    return Findings(
        rows=tuple(checks),
        drawings=(
            Drawing(
                'coefficients',
                'Force and moment coefficients over the attack angle without slip, as the model '
                'has them, and evaluated independently; between the dotted lines eq. 14 holds.',
                _drawn(default.board),
            ),
        ),
        tables=(
            TextTable(
                'Largest differences as shares of the force and of the moment.',
                ('attitudes', 'α [°]', 'force', 'moment'),
                tuple(rows),
            ),
        ),
        text='Loads act aft, outward and down; the resistance to turning is that of the gear file.',
    )


def _continuation_checks(record: BoardRecord) -> list[MeasuredValue]:
    """Check the continuation of the law outside its range."""
    attack = np.radians(np.linspace(-180.0, 180.0, 3601))
    seen = EQ14(record.coefficients.array(), attack, np.zeros_like(attack))
    ends = np.radians([-40.0, 90.0])
    gone = EQ14(record.coefficients.array(), ends, np.zeros(2))
    jumps = np.abs(np.diff(seen, axis=0)).max()
    return [
        MeasuredValue(
            'least drag coefficient at any attack angle',
            float(seen[:, 0].min()),
            target=at_least(0.0),
            note='Drag never becomes thrust.',
            key='no_thrust',
        ),
        MeasuredValue(
            'largest lift coefficient, and moment coefficient of α, at -40° and 90°',
            float(np.abs(gone[:, [1, 3, 5]]).max()),
            target=at_most(1e-12),
            note='There lift and moments have faded.',
            key='lift_gone',
        ),
        MeasuredValue(
            'largest change of a coefficient over 0.1° of attack',
            float(jumps),
            target=at_most(2.0 * np.abs(record.coefficients.array()).max() * np.radians(0.1)),
            note='At most twice that of the steepest line of eq. 14: the law has no step.',
            key='no_jump',
        ),
    ]


def _drawn(record: BoardRecord) -> Figure:
    figure, every = panes(8.4, 4.2, 1, 2)
    fine, dots = np.linspace(-90.0, 120.0, 421), np.linspace(-90.0, 120.0, 43)
    curves = EQ14(record.coefficients.array(), np.radians(fine), np.zeros_like(fine))
    points = np.array([coefficients(record, np.radians(alpha), 0.0) for alpha in dots])
    names = ('$C_x^F$', '$C_y^F$', '$C_z^F$', '$C_x^M$', '$C_y^M$', '$C_z^M$')
    for axes, group, title in zip(every, ((0, 1, 2), (3, 4, 5)), ('force', 'moment'), strict=True):
        for k in group:
            (curve,) = axes.plot(fine, curves[:, k], '-', label=names[k])
            axes.plot(dots, points[:, k], 'o', ms=3, color=curve.get_color())
        axes.plot([], [], 'ko', ms=3, label='evaluated independently')
        for edge in (0.0, 40.0):
            axes.axvline(edge, color='k', ls=':', lw=1)
        axes.set(xlabel='attack angle α [°]', ylabel=f'{title} coefficient [-]')
        axes.legend()
    return figure


CASE = ValidationCase('board_law', 'A board alone, eq. 1 to 14', run)
