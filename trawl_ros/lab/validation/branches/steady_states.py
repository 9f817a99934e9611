# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady states of the default gear over its operating conditions: existence, and no collapse."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.measured import MeasuredValue, within
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.running.timing import factor_cost
from trawl_ros.lab.validation.branches.branch_limits import MIDDLE, limit_findings
from trawl_ros.lab.validation.branches.continuation import SAME_ROOT_M, Verdict, largest_distance
from trawl_ros.lab.validation.branches.facts import branch_checks, smoothness_checks
from trawl_ros.lab.validation.branches.lattices import (
    ANGLES,
    SPEED,
    VERDICT_STYLES,
    Lattice,
    angle_figure,
    angle_lattice,
    speed_figure,
    speed_lattice,
)
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.observables import COLLAPSED_NORMAL
from trawl_ros.model.rotations import about_axis
from trawl_ros.model.state import State
from trawl_ros.report.pictures import Drawing
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium, require_usable
from trawl_ros.solver.operating_point import OperatingPoint, steady_tow
from trawl_ros.solver.relax import relax

TURNS: Mapping[str, tuple[float, float]] = {
    'at −5° to the flow': (-5.0, 14.0),
    'along the flow': (0.0, 0.0),
    'at 45° to the flow': (45.0, 14.0),
    'across the flow': (90.0, 0.0),
    'flat, face down': (20.0, -90.0),
    'flat, face up': (20.0, 90.0),
    'upside down': (20.0, 180.0),
    'back to front': (180.0, 0.0),
}
"""Attitudes (°) of a collapsed board: leading edge outward, outward normal up."""

FOLDED = 0.05
"""Width of a folded gear as a share of its original width."""


@dataclass(frozen=True)
class OutcomeTally:
    """Tally of searches from collapsed shapes by outcome; ``refused`` by reason."""

    good: int
    refused: Counter[str]
    other: int

    @property
    def searches(self) -> int:
        """Number of searches."""
        return self.good + self.refused.total() + self.other


def turned_boards(turn: tuple[float, float]) -> FloatArray:
    """Rotations (2, 3, 3) of both boards at an attitude of `TURNS`."""
    yaw, lean = np.radians(turn)
    port = about_axis(2, yaw) @ about_axis(0, lean)
    flip = np.array([1.0, -1.0, 1.0])
    return np.stack([port, flip[:, None] * port * flip])


def collapsed_shapes(shape: State) -> list[State]:
    """Return a shape with both boards or one board collapsed, and with the whole gear folded."""
    shapes = []
    for turn in TURNS.values():
        both = turned_boards(turn)
        for rotations in (both, np.stack([both[0], shape.board_rotations[1]])):
            shapes.append(replace(shape, board_rotations=rotations))
    narrow = np.array([1.0, FOLDED, 1.0])
    folded = replace(
        shape,
        nodes=shape.nodes * narrow,
        board_positions=shape.board_positions * narrow,
        board_rotations=turned_boards(TURNS['flat, face down']),
    )
    return [*shapes, folded]


def tally(
    model: GearModel,
    point: OperatingPoint,
    shapes: Sequence[State],
    good: Equilibrium | None,
) -> OutcomeTally:
    """Search at a point from collapsed shapes; ``good`` is its steady state, or None."""
    same, other = 0, 0
    refused: Counter[str] = Counter()
    for shape in shapes:
        try:
            found = find_equilibrium(model, point, near=shape)
            if good is not None and largest_distance(found, good) <= SAME_ROOT_M:
                same += 1
            else:
                require_usable(model, found)
                other += 1
        except NoSteadyState as error:
            refused[error.reason] += 1
    return OutcomeTally(same, refused, other)


WORKING = 1.9, 2.3
"""Speeds (m/s) between which the gear is towed."""

FACTORISATIONS = 21
"""Number of factorisations that are timed."""

SHORTEST = 200.0
"""Shortest towing warp, m; on shorter warps netting is slack."""

BOWING_PRESSURE_PA = 317.0
"""Load (Pa) under which twine bows: that of water on meshes towed at 2.1 m/s with bars at 20° to
the flow."""

INSTALLED = 5.0
"""Installation angle (°) up to which the paper varies it, section IV.C."""

OVERTURNED = np.radians(-20.0)
"""Installation angle ε with which the boards collapse."""


@dataclass(frozen=True)
class SearchSize:
    """Size of the case."""

    lengths: Sequence[float]
    speeds: Sequence[float]
    angle_lengths: Sequence[float]
    degrees: Sequence[float]
    collapses: Sequence[tuple[float, float]]
    hopeless_starts: int


FULL = SearchSize(
    lengths=(150.0, 200.0, 300.0, 500.0, 700.0, 1000.0),
    speeds=(1.5, 1.6, 1.7, 1.8, 1.9, 2.0, 2.1, 2.2, 2.3, 2.4, 2.6, 2.8),
    angle_lengths=(200.0, 500.0, 900.0),
    degrees=tuple(np.arange(-10.0, 10.1, 2.5).tolist()),
    collapses=((200.0, 1.9), (900.0, 2.7), (500.0, 2.1)),
    hopeless_starts=3,
)
SMALL = SearchSize(
    lengths=(300.0, 500.0),
    speeds=(2.1, 2.6),
    angle_lengths=(500.0,),
    degrees=(-10.0, 0.0),
    collapses=((500.0, 2.1),),
    hopeless_starts=1,
)
HOPELESS = 500.0, 1.5
"""Warp length (m) and speed (m/s) at which the gear cannot be towed."""


def run(quick: bool) -> Findings:
    """Continue over the maps and search from collapsed shapes."""
    size = SMALL if quick else FULL
    gear = load_gear('kaifuha')
    if quick:
        gear = gear.changed('netting', around=12)
    model = build_model(gear)
    # Compiling at first use is no time of an answer.
    middle = find_equilibrium(model, OperatingPoint(MIDDLE, MIDDLE, SPEED))
    require_usable(model, middle)
    factor_s, _ = factor_cost(model, middle.state, middle.tow, FACTORISATIONS)
    speeds = speed_lattice(model, size.lengths, size.speeds)
    angles = [angle_lattice(model, size.angle_lengths, angle, size.degrees) for angle in ANGLES]
    collapsed_checks, collapsed_table = _collapsed(model, size)
    ends = limit_findings(model, quick=quick)
    return Findings(
        rows=(
            _without_reason(speeds),
            _bowed(model, size),
            _working(
                'working_speeds',
                f'warps of {SHORTEST:g} m and more at speeds of 1.9 to 2.3 m/s',
                [speeds],
            ),
            _working('installed', 'warp lengths and installation angles up to ±5°', angles),
            *_in_factorisations(branch_checks('speed', [speeds]), factor_s),
            *smoothness_checks(speeds),
            *branch_checks('angle', angles),
            *collapsed_checks,
            *ends.rows,
        ),
        drawings=(
            Drawing(
                'speed',
                'Steady states over warp length and speed; numbers are attack angles in degrees, '
                'also of states that are refused.',
                speed_figure(speeds),
            ),
            Drawing(
                'angles',
                f'Steady states over warp length and installation angles at {SPEED:g} m/s; '
                'numbers are attack angles in degrees.',
                angle_figure(angles),
            ),
            *ends.drawings,
        ),
        tables=(_counts(speeds, angles), collapsed_table, *ends.tables),
        text=f'{_text(speeds)} {ends.text}',
    )


def _without_reason(speeds: Lattice) -> MeasuredValue:
    """Places of the map that are neither usable nor refused with a reason."""
    counted = Counter(answer.verdict for answer in speeds.answers.values())
    words = ', '.join(f'{number} {verdict}' for verdict, number in counted.most_common())
    return MeasuredValue(
        'places over warp length and speed without usable state or physical reason',
        counted['none found'],
        target=within(0.0, of=0.0),
        note=f'Of {len(speeds.answers)}: {words}.',
        key='without_reason',
    )


def _bowed(model: GearModel, size: SearchSize) -> MeasuredValue:
    """Check the usable places on the shortest warp, with twine that bows under the water's load."""
    bowed = build_model(model.gear.changed('netting', bowing_pressure_pa=BOWING_PRESSURE_PA))
    length, refused = size.lengths[0], []
    speeds = [speed for speed in size.speeds if speed >= WORKING[0]]
    for speed in speeds:
        try:
            require_usable(bowed, find_equilibrium(bowed, OperatingPoint(length, length, speed)))
        except NoSteadyState as refusal:
            refused.append(str(refusal))
    return MeasuredValue(
        f'share of usable places at {length:g} m of warp from {WORKING[0]:g} m/s, with twine that '
        f'bows under {BOWING_PRESSURE_PA:g} Pa',
        100.0 * (1.0 - len(refused) / len(speeds)),
        '%',
        within(0.0, of=100.0),
        '; '.join(refused)
        or 'There the default gear, whose slack twine does not pull at all, is '
        'refused where its netting flutters.',
        key='bowed_short',
    )


def _in_factorisations(rows: Sequence[MeasuredValue], factor_s: float) -> Iterator[MeasuredValue]:
    """Express the longest CPU time in factorisations too, which does not depend on the machine."""
    for row in rows:
        if row.key != 'speed_slowest':
            yield row
            continue
        note = (
            f'{row.note} It is {row.value / factor_s:.0f} times that of one factorisation of this '
            f'gear with its solution, which takes {1e3 * factor_s:.2f} ms here.'
        )
        yield replace(row, note=note)


def _working(key: str, what: str, lattices: Sequence[Lattice]) -> MeasuredValue:
    """Share of usable places in the gear's working range."""
    low, high = WORKING if key == 'working_speeds' else (-INSTALLED, INSTALLED)
    places = [
        (lattice.across, lattice.columns[j], answer)
        for lattice in lattices
        for (i, j), answer in lattice.answers.items()
        if low <= lattice.columns[j] <= high and lattice.lengths[i] >= SHORTEST
    ]
    refused = [
        f'at {across} {value:g}, {answer.refusal}'
        for across, value, answer in places
        if answer.refusal is not None
    ]
    note = f'{len(places)} places.'
    if refused:
        note = f'Of {len(places)} places {len(refused)} refused: {"; ".join(refused)}.'
    return MeasuredValue(
        f'share of usable places among {what}',
        100.0 * (1.0 - len(refused) / len(places)),
        '%',
        within(0.0, of=100.0),
        note,
        key=key,
    )


def _collapsed(model: GearModel, size: SearchSize) -> tuple[list[MeasuredValue], TextTable]:
    """Search from collapsed shapes, with and without a known steady state."""
    rows = []
    tallies: list[OutcomeTally] = []
    goods: list[Equilibrium] = []
    for length, speed in size.collapses:
        good = find_equilibrium(model, OperatingPoint(length, length, speed))
        goods.append(good)
        tallies.append(tally(model, good.point, collapsed_shapes(good.state), good))
        rows.append(_row(length, speed, tallies[-1]))
    length, speed = HOPELESS
    shapes = collapsed_shapes(goods[-1].state)[-size.hopeless_starts :]
    tallies.append(tally(model, OperatingPoint(length, length, speed), shapes, None))
    rows.append(_row(length, speed, tallies[-1]))
    total = sum(each.searches for each in tallies)
    checks = [
        MeasuredValue(
            'searches from a collapsed shape that gave another state than the good branch',
            sum(each.other for each in tallies),
            target=within(0.0, of=0.0),
            note=f'{total} searches; the good branch is the one found cold, within '
            f'{SAME_ROOT_M:g} m.',
            key='collapsed_starts',
        ),
        _overturned(model, goods[-1]),
    ]
    head = ('warp (m)', 'speed (m/s)', 'searches', 'good branch', 'refused', 'another state')
    return checks, TextTable('Searches from collapsed shapes', head, tuple(rows))


def _row(length: float, speed: float, counted: OutcomeTally) -> tuple[str, ...]:
    refused = ', '.join(f'{number} {reason}' for reason, number in counted.refused.items())
    return (
        f'{length:g}',
        f'{speed:g}',
        str(counted.searches),
        str(counted.good),
        refused or '0',
        str(counted.other),
    )


def _overturned(model: GearModel, good: Equilibrium) -> MeasuredValue:
    """Check that boards installed at an angle at which they collapse are always refused."""
    overturned = model.with_board(installation=(OVERTURNED, 0.0, 0.0))
    tow = steady_tow(overturned, good.point)
    collapsed, _, left = relax(overturned, good.state, tow, tolerance=1e-3, time_step=10.0)
    given: list[str] = []
    for start, near in ((None, None), (good, None), (None, collapsed)):
        try:
            find_equilibrium(overturned, good.point, start, near=near)
            given.append('a state')
        except NoSteadyState as error:
            given.append(error.reason)
    return MeasuredValue(
        f'of three searches for boards set at ε = {np.degrees(OVERTURNED):.0f}°, refused as '
        'collapsed',
        given.count('collapsed'),
        target=within(0.0, of=3.0),
        note=f'Cold, from the gear set at 0°, and from the collapsed root itself, {left:.1g} N '
        f'from balance; they gave: {", ".join(given)}.',
        key='overturned',
    )


def _counts(speeds: Lattice, angles: Sequence[Lattice]) -> TextTable:
    kinds: list[Verdict] = list(VERDICT_STYLES)
    rows = []
    for name, lattice in zip(('speed', *ANGLES), (speeds, *angles), strict=True):
        counted = Counter(answer.verdict for answer in lattice.answers.values())
        searches = sum(answer.searches for answer in lattice.answers.values())
        rows.append((name, *(str(counted[kind]) for kind in kinds), str(searches)))
    return TextTable('Places by verdict', ('map over', *kinds, 'searches'), tuple(rows))


def _text(speeds: Lattice) -> str:
    doubtful = [a for a in speeds.answers.values() if a.verdict != 'usable' and a.root is not None]
    several = sum(answer.apart > SAME_ROOT_M or not answer.agreed for answer in doubtful)
    surfaced = any(answer.verdict == 'surfaced' for answer in speeds.answers.values())
    wet = 'Fast on short warps the headrope comes out of the water. ' if surfaced else ''
    return (
        'Each place is searched from all its neighbours that have a state, and every third one '
        'cold too. Below about 1.8 m/s the symmetric state is unstable: a real eigenvalue of a '
        'mode in which one board rises as the other sinks turns positive. Slower still, at '
        '1.6 m/s and less, boards lie over, roots are several or none, and what a search finds '
        f'depends on its start ({several} places of this map); all of these are refused. '
        f'{wet}Turned inward by ε the boards lose '
        'their lift until they fall: the good branch runs on into the collapsed states, without '
        'a fold, and is refused from where α is negative or an outward normal points '
        f'{np.degrees(np.arcsin(-COLLAPSED_NORMAL)):.0f}° down.'
    )


CASE = ValidationCase(
    'steady_states', 'Where steady states exist, over warp length, speed and installation', run
)
