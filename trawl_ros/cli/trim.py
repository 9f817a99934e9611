# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl trim``."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
from click.core import ParameterSource

from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.options import FILE, SPEED, UNITS_OPTION, WARP, Number, QuantityNumber
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.display_units import DisplayUnits

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel
    from trawl_ros.records.observables import Observables
    from trawl_ros.solver.advising.rig_changes import RigChange
    from trawl_ros.solver.equilibrium import SteadyState
    from trawl_ros.solver.trimming.measured import MeasuredAngles
    from trawl_ros.solver.trimming.over_range import RangeTrim
    from trawl_ros.solver.trimming.traded import Traded

KINDS = 'bridles', 'weights', 'floats', 'clump', 'boards'
"""Kinds of changes, those of `trawl_ros.solver.advising.rig_changes`, which is slow to load."""

SPREAD = QuantityNumber('width', 1.0, 2000.0)
DEPTH = QuantityNumber('depth', 1.0, 2000.0)

MAX_RELATIVE_MISS = 0.05
"""Largest relative difference of the trimmed gear from a wanted spread or depth."""


def _kinds(
    context: click.Context, parameter: click.Parameter, value: str | None
) -> tuple[str, ...]:
    kinds = tuple(kind.strip() for kind in (value or '').split(',') if kind.strip())
    for kind in kinds:
        if kind not in KINDS:
            raise click.BadParameter(f"found '{kind}', expected one of {', '.join(KINDS)}")
    return kinds


@click.command('trim')
@click.argument('gear', metavar='GEAR')
@click.option('--attack', type=Number(1.0, 40.0), help='Wanted attack angle α of the doors, deg.')
@click.option(
    '--inclination',
    type=Number(-45.0, 60.0),
    help='Wanted inclination δ of the doors, deg: above 0 the upper edge leans inward, below 0 '
    'outward.',
)
@click.option(
    '--pitch',
    default=0.0,
    show_default=True,
    type=Number(-30.0, 30.0),
    help='Wanted pitch of the doors, nose down, deg.',
)
@click.option('--spread', type=SPREAD, help='Door spread that determines the angles, m.')
@click.option('--depth', type=DEPTH, help='Door depth that determines the angles, m.')
@click.option(
    '--tension',
    type=QuantityNumber('tension', 100.0, 2e6),
    help='Tension of a warp measured with --spread and --depth, kN; compared with the model.',
)
@click.option(
    '--warp',
    default=500.0,
    show_default=True,
    type=WARP,
    help='Warp length of the wanted angles or of the measurement, m.',
)
@click.option(
    '--speed',
    default=2.1,
    show_default=True,
    type=SPEED,
    help='Speed through the water for the same, m/s.',
)
@click.option('--warps', nargs=2, type=WARP, help='Shortest and longest warp of a range, m.')
@click.option('--speeds', nargs=2, type=SPEED, help='Lowest and highest speed of a range, m/s.')
@click.option(
    '--free',
    callback=_kinds,
    help='Changes that are allowed if fastening points are not enough, separated by commas: '
    f'{", ".join(KINDS)}.',
)
@click.option(
    '--in-motion',
    is_flag=True,
    help='Choose the points so that the doors stand while they are hauled, veered and turned over '
    'the range of --warps and --speeds; takes minutes on all cores.',
)
@click.option('--out', type=FILE, help='New file for a copy of GEAR with the result.')
@UNITS_OPTION
@click.pass_context
def command(
    context: click.Context,
    gear: str,
    attack: float | None,
    inclination: float | None,
    pitch: float,
    spread: float | None,
    depth: float | None,
    tension: float | None,
    warp: float,
    speed: float,
    warps: tuple[float, float] | None,
    speeds: tuple[float, float] | None,
    free: tuple[str, ...],
    in_motion: bool,
    out: Path | None,
    units: DisplayUnits,
) -> None:
    """Find fastening points that give the doors of GEAR the wanted angles.

    GEAR is a gear file or the name of a gear of the package. The search starts from the points of
    the file and changes them as little as possible. The result is printed in the format of a gear
    file; only --out writes a file.

    The printed δ has no sign; 'upper edge outward' is added if the doors lean that way. For another
    door use `trawl gear set-door`.

    Instead of angles you can give --spread and --depth of the doors, measured at --warp and
    --speed. The command then finds the nearest angles. With --warps or --speeds it chooses all
    coordinates so that the angles change little over the range. With --free it also changes the
    rigging, if the wanted values are not reached or part of the range is not usable.

    With --in-motion every rigging that is tried has the wanted angles in the middle of the range
    and is towed for 88 minutes under random commands, in calm water and in swell. The rigging whose
    doors lean least is chosen. Give the result to the command again to search further.
    """
    from trawl_ros.gear.edit import WRITTEN_DECIMALS, require_new, write_changed
    from trawl_ros.gear.load import load_gear
    from trawl_ros.model.gear_model import build_model
    from trawl_ros.solver.advising.rig_changes import changes_of
    from trawl_ros.solver.trimming.drawn_board import with_fastening
    from trawl_ros.solver.trimming.traded import Traded

    angles, wanted = None, None
    if attack is not None and inclination is not None and spread is None and depth is None:
        angles = float(np.radians(attack)), float(np.radians(inclination))
        _refuse_ignored(context, {'warp': warps, 'speed': speeds})
    elif spread is None or depth is None or attack is not None or inclination is not None:
        raise click.UsageError('expected either --attack and --inclination or --spread and --depth')
    if in_motion and (angles is None or warps is None or speeds is None or free):
        raise click.UsageError(
            '--in-motion: expected together with --attack, --inclination, --warps and --speeds, '
            'and without --free'
        )
    if tension is not None and angles is not None:
        raise click.UsageError('--tension: expected together with --spread and --depth')
    if out is not None:
        require_new(out)
    record = load_gear(gear)
    tell = Comment(units)
    model, changes, traded = build_model(record), changes_of(record, free), Traded()
    if angles is None:
        assert spread is not None
        assert depth is not None
        wanted, traded = _measured(
            model, changes, spread, depth, tension, (warp, speed), pitch, tell
        )
        angles = wanted.attack, wanted.inclination
        model, changes = traded.model(model), ()
    low, high = speeds or (speed, speed)
    wish = WantedTrim(*angles, float(np.radians(pitch)), warps or (warp, warp), (low, high))
    find = _trimmed_in_motion if in_motion else _trimmed
    points, usable, more, steady = find(model, changes, wish, tell)
    if wanted is not None and steady is not None:
        reached = replace(wanted, observables=steady.observables)
        if reached.missed_by > MAX_RELATIVE_MISS:
            tell(f'with these points the gear misses the wanted values: {reached.missed}')
            usable = False
    traded = Traded((*traded.changes, *more.changes))
    if out is not None:
        write_changed(
            gear, out, with_fastening(traded.gear(record), points.round(WRITTEN_DECIMALS))
        )
        click.echo(f'# written: {out}')
    if not usable:
        raise SystemExit(1)


def _refuse_ignored(context: click.Context, ranges: dict[str, tuple[float, float] | None]) -> None:
    """Refuse a single value if its range is given too."""
    for name, given in ranges.items():
        if given is not None and context.get_parameter_source(name) is not ParameterSource.DEFAULT:
            raise click.UsageError(f'--{name} and --{name}s: found both, expected one of them')


@dataclass(frozen=True)
class Comment:
    """Printer of comments of a gear file, in the units of a user."""

    units: DisplayUnits

    def __call__(self, text: str) -> None:
        """Print a sentence."""
        click.echo(f'# {self.units.sentence(text)}')


@dataclass(frozen=True)
class WantedTrim:
    """Wanted angles (rad), and shortest and longest warp (m), lowest and highest speed (m/s)."""

    attack: float
    inclination: float
    pitch: float
    warps: tuple[float, float]
    speeds: tuple[float, float]

    @property
    def angles(self) -> dict[str, float]:
        """Angles as keyword arguments of a search."""
        return {'attack': self.attack, 'inclination': self.inclination, 'pitch': self.pitch}

    @property
    def places(self) -> tuple[list[float], list[float]]:
        """Warps and speeds of the range."""
        return _with_middle(self.warps), _with_middle(self.speeds)


def _with_middle(ends: tuple[float, float]) -> list[float]:
    """Return the ends of a range and their geometric mean."""
    return sorted({ends[0], float(np.sqrt(ends[0] * ends[1])), ends[1]})


def _trimmed(
    model: 'GearModel', changes: 'tuple[RigChange, ...]', wish: WantedTrim, tell: 'Comment'
) -> 'tuple[FloatArray, bool, Traded, SteadyState | None]':
    """Find points and print them.

    Returns the points, True if all of the range is usable, the changes, and the steady state of a
    range that is a single place, if there is one.
    """
    from trawl_ros.core.errors import NoSteadyState
    from trawl_ros.solver.trim import trim
    from trawl_ros.solver.trimming.over_range import trim_over_range
    from trawl_ros.solver.trimming.traded import Traded, trade_for_range

    warps, speeds = wish.places
    if len(warps) == len(speeds) == 1:
        try:
            trimmed = trim(model, **wish.angles, warp_length=warps[0], speed=speeds[0])
        except NoSteadyState as reason:
            tell(f'{reason}; the search goes on with all coordinates free')
        else:
            click.echo('\n'.join(points_lines(trimmed.points)))
            tell(state_line(warps[0], speeds[0], trimmed.steady))
            return trimmed.points, True, Traded(), trimmed.steady
    traded = Traded()
    with ProgressDisplay(error_console()) as display:
        found = trim_over_range(
            model, **wish.angles, warp_lengths=warps, speeds=speeds, on_progress=display
        )
        if found.usable < len(found.found) and changes:
            found, traded = trade_for_range(
                model, changes, found, **wish.angles, on_progress=display
            )
    click.echo('\n'.join(points_lines(found.points)))
    if traded.changes:
        tell(f'with {traded.told}')
    elif changes and found.usable < len(found.found):
        tell('none of the allowed changes makes more of the range usable')
    _tell_range(found, wish, tell)
    steady = found.found[0].steady if len(found.found) == 1 else None
    return found.points, found.usable == len(found.found), traded, steady


def _trimmed_in_motion(
    model: 'GearModel', changes: 'tuple[RigChange, ...]', wish: WantedTrim, tell: 'Comment'
) -> 'tuple[FloatArray, bool, Traded, SteadyState | None]':
    """Find points with which the boards stand in motion, print and return as `_trimmed` does."""
    from trawl_ros.simulation.trim_in_motion import trim_in_motion
    from trawl_ros.solver.trimming.over_range import states_over_range
    from trawl_ros.solver.trimming.traded import Traded

    with ProgressDisplay(error_console()) as display:
        best = trim_in_motion(
            model,
            attack=wish.attack,
            inclination=wish.inclination,
            pitch=wish.pitch,
            warp_lengths=wish.warps,
            speeds=wish.speeds,
            on_progress=display,
        )
    found = states_over_range(model.with_board(points=best.points), *wish.places)
    click.echo('\n'.join(points_lines(found.points)))
    tell(
        f'under random commands the largest lean of two minutes is {np.degrees(best.lean):.0f}° '
        f'in the root mean square, {np.degrees(best.first_lean):.0f}° with the points of the file'
    )
    _tell_range(found, wish, tell)
    return found.points, found.usable == len(found.found), Traded(), None


def _tell_range(found: 'RangeTrim', wish: WantedTrim, tell: 'Comment') -> None:
    """Print all places of a range, the coordinates on a bound, and advice."""
    lines = [*range_lines(found), *wish_lines(found, wish.attack, wish.inclination)]
    lines.extend(f'at its bound: {coordinate}' for coordinate in found.at_bounds)
    for line in (*lines, closing_line(found), *_advice_lines(found)):
        tell(line)


def _advice_lines(found: 'RangeTrim') -> tuple[str, ...]:
    """Return lines of advice on the first operating point that is not usable."""
    from trawl_ros.solver.advising.advice import advice

    refused = next((point for point in found.found if point.steady is None), None)
    if refused is None:
        return ()
    with ProgressDisplay(error_console()) as display:
        told = advice(found.model, refused.warp_length, refused.speed, on_progress=display)
    return told.lines[1:] if told is not None else ()


def _measured(
    model: 'GearModel',
    changes: 'tuple[RigChange, ...]',
    spread: float,
    depth: float,
    tension: float | None,
    place: tuple[float, float],
    pitch: float,
    tell: 'Comment',
) -> 'tuple[MeasuredAngles, Traded]':
    from trawl_ros.solver.trimming.measured import angles_from
    from trawl_ros.solver.trimming.traded import Traded, trade_for_place

    at = {'warp_length': place[0], 'speed': place[1], 'pitch': float(np.radians(pitch))}
    found, traded = angles_from(model, spread=spread, depth=depth, **at), Traded()
    if changes and not found.met:
        tell(found.told())
        found, traded = trade_for_place(model, changes, found, **at)
    tell(found.told(tension))
    if traded.changes:
        tell(f'with {traded.told}')
    return found, traded


def points_lines(points: FloatArray) -> tuple[str, ...]:
    """Return fastening points in the format of a gear file."""
    from trawl_ros.gear.edit import fastening_lines

    return ('  fastening:', *(f'    {line}' for line in fastening_lines(points)))


def state_line(warp: float, speed: float, steady: 'SteadyState') -> str:
    """Describe a steady state at a warp length (m) and speed (m/s)."""
    observables: Observables = steady.observables
    # δ has no sign. Roll is positive with the top to starboard: inward for the port board.
    edge = ', upper edge outward' if observables.port_roll < 0.0 else ''
    return (
        f'at {warp:g} m and {speed:g} m/s: α {np.degrees(observables.port_attack):.1f}°, '
        f'δ {np.degrees(observables.port_inclination):.1f}°{edge}, '
        f'β {np.degrees(observables.port_slip):.1f}°, '
        f'spread {observables.door_spread:.1f} m, door depth {observables.door_depth:.1f} m, '
        f'tension {observables.warp_tension / 1e3:.1f} kN; the slowest motion settles in '
        f'{steady.stability.settling_time:.0f} s'
    )


def range_lines(found: 'RangeTrim') -> list[str]:
    """Describe every operating point of a range."""
    lines = []
    for point in found.found:
        if point.steady is None:
            lines.append(
                f'not at {point.warp_length:g} m and {point.speed:.3g} m/s: {point.reason}'
            )
        else:
            lines.append(state_line(point.warp_length, round(point.speed, 3), point.steady))
    return lines


def wish_lines(found: 'RangeTrim', attack: float, inclination: float) -> list[str]:
    """Compare the wanted angles with those of the usable states."""
    seen = [point.steady.observables for point in found.found if point.steady is not None]
    if not seen:
        return []
    # δ is printed without a sign, for wanted and found angles alike.
    angles = np.degrees([[o.port_attack, o.port_inclination] for o in seen])
    (alpha, delta), (most_alpha, most_delta) = angles.min(axis=0), angles.max(axis=0)
    return [
        f'wanted α {np.degrees(attack):.1f}° and δ {np.degrees(abs(inclination)):.1f}°; nearest '
        f'over the range: α {alpha:.1f}° to {most_alpha:.1f}°, δ {delta:.1f}° to {most_delta:.1f}°'
    ]


def closing_line(found: 'RangeTrim') -> str:
    """Count the usable states of a range, and describe the change of attitude over it."""
    speeds = sorted({point.speed for point in found.found})
    percent = 100.0 * np.log(speeds[-1] / speeds[0])
    attack, lean = np.degrees(found.by_speed)
    closing = f'{found.usable} of {len(found.found)} are usable'
    if percent > 0.0 and found.usable > 1:
        closing += (
            f'; with speed α changes by {attack:.1f}° and δ by {lean:.1f}°, '
            f'{attack / percent:.2f}° and {lean / percent:.2f}° per % of speed'
        )
    if len({point.warp_length for point in found.found}) > 1 and found.usable > 1:
        attack, lean = np.degrees(found.by_warp)
        closing += f'; with warp length by {attack:.1f}° and {lean:.1f}°'
    return closing
