"""``trawl trim``."""

from typing import TYPE_CHECKING

import click
import numpy as np

from trawl_ros.cli.options import SPEED, WARP
from trawl_ros.cli.progress import ProgressDisplay, error_console
from trawl_ros.core.arrays import FloatArray

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel
    from trawl_ros.records.observables import Observables
    from trawl_ros.solver.equilibrium import SteadyState
    from trawl_ros.solver.trimming.over_range import RangeTrim

METRES = click.FloatRange(1.0, 2000.0)


@click.command('trim')
@click.argument('gear', metavar='GEAR')
@click.option('--attack', type=click.FloatRange(1.0, 40.0), help='Wanted α, deg.')
@click.option(
    '--inclination',
    type=click.FloatRange(-45.0, 60.0),
    help='Wanted δ, deg; below 0 the boards lean inward.',
)
@click.option(
    '--pitch',
    default=0.0,
    show_default=True,
    type=click.FloatRange(-30.0, 30.0),
    help='Wanted pitch, nose down, deg.',
)
@click.option('--spread', type=METRES, help='Door spread, m, from which angles are found.')
@click.option('--depth', type=METRES, help='Door depth, m, from which angles are found.')
@click.option(
    '--tension-kn',
    type=click.FloatRange(0.1, 2000.0),
    help='Tension of a warp measured with them, kN; the model is held against it.',
)
@click.option(
    '--warp',
    default=500.0,
    show_default=True,
    type=WARP,
    help='Warp length at which the angles are wanted or were measured, m.',
)
@click.option(
    '--speed',
    default=2.1,
    show_default=True,
    type=SPEED,
    help='Speed through the water at which they are, m/s.',
)
@click.option('--warps', nargs=2, type=WARP, help='Shortest and longest warp of a range, m.')
@click.option('--speeds', nargs=2, type=SPEED, help='Lowest and highest speed of a range, m/s.')
def command(
    gear: str,
    attack: float | None,
    inclination: float | None,
    pitch: float,
    spread: float | None,
    depth: float | None,
    tension_kn: float | None,
    warp: float,
    speed: float,
    warps: tuple[float, float] | None,
    speeds: tuple[float, float] | None,
) -> None:
    """Find fastening points that give the boards of GEAR wanted angles.

    GEAR is a gear file or the name of one that comes with the package. The search starts from
    the file's own points and changes them as little as it can. The result is printed as the
    file has it; nothing is written.

    In place of angles it takes the --spread and --depth of the doors as measured at --warp and
    --speed, and says which angles come nearest. With --warps or --speeds all coordinates are used
    so that the angles change little over the range.
    """
    from trawl_ros.gear.load import load_gear
    from trawl_ros.model.gear_model import build_model
    from trawl_ros.solver.trim import trim
    from trawl_ros.solver.trimming.over_range import trim_over_range

    model = build_model(load_gear(gear))
    if spread is not None and depth is not None and attack is None and inclination is None:
        alpha, delta = _measured(model, spread, depth, tension_kn, (warp, speed), pitch)
    elif attack is not None and inclination is not None and spread is None and depth is None:
        alpha, delta = np.radians([attack, inclination])
    else:
        raise click.UsageError('expected either --attack and --inclination or --spread and --depth')
    if tension_kn is not None and spread is None:
        raise click.UsageError('--tension-kn: expected beside --spread and --depth')
    if warps is None and speeds is None:
        trimmed = trim(
            model,
            attack=alpha,
            inclination=delta,
            pitch=np.radians(pitch),
            warp_length=warp,
            speed=speed,
        )
        _points(trimmed.points)
        click.echo(f'# {_state(warp, speed, trimmed.steady)}')
        return
    low, high = speeds or (speed, speed)
    with ProgressDisplay(error_console()) as display:
        found = trim_over_range(
            model,
            attack=alpha,
            inclination=delta,
            pitch=np.radians(pitch),
            warp_lengths=sorted(set(warps or (warp,))),
            speeds=sorted({low, float(np.sqrt(low * high)), high}),
            on_progress=display,
        )
    _points(found.points)
    for line in (*_range_lines(found), *_wish_lines(found, alpha, delta), _closing(found)):
        click.echo(f'# {line}')
    if found.usable < len(found.found):
        raise SystemExit(1)


def _measured(
    model: 'GearModel',
    spread: float,
    depth: float,
    tension_kn: float | None,
    place: tuple[float, float],
    pitch: float,
) -> tuple[float, float]:
    from trawl_ros.solver.trimming.measured import angles_from

    found = angles_from(
        model,
        spread=spread,
        depth=depth,
        warp_length=place[0],
        speed=place[1],
        pitch=np.radians(pitch),
    )
    click.echo(f'# {found.told(None if tension_kn is None else 1e3 * tension_kn)}')
    return found.attack, found.inclination


def _points(points: FloatArray) -> None:
    click.echo('  fastening:')
    for name, point in zip(('warp_m', 'upper_bridle_m', 'lower_bridle_m'), points, strict=True):
        click.echo(f'    {name}: [{", ".join(f"{x:.3f}" for x in point)}]')


def _state(warp: float, speed: float, steady: 'SteadyState') -> str:
    observables: Observables = steady.observables
    return (
        f'at {warp:g} m and {speed:g} m/s: α {np.degrees(observables.port_attack):.1f}°, '
        f'δ {np.degrees(observables.port_inclination):.1f}°, '
        f'β {np.degrees(observables.port_slip):.1f}°, '
        f'spread {observables.door_spread:.1f} m, door depth {observables.door_depth:.1f} m, '
        f'tension {observables.warp_tension / 1e3:.1f} kN; the slowest motion settles in '
        f'{steady.stability.settling_time:.0f} s'
    )


def _range_lines(found: 'RangeTrim') -> list[str]:
    lines = []
    for point in found.found:
        if point.steady is None:
            lines.append(
                f'not at {point.warp_length:g} m and {point.speed:.3g} m/s: {point.reason}'
            )
        else:
            lines.append(_state(point.warp_length, round(point.speed, 3), point.steady))
    return lines


def _wish_lines(found: 'RangeTrim', attack: float, inclination: float) -> list[str]:
    """Wanted angles beside those that the range has, where a state is usable."""
    seen = [point.steady.observables for point in found.found if point.steady is not None]
    if not seen:
        return []
    # δ is told without a sign: boards that lean inward are wanted and found with it alike.
    angles = np.degrees([[o.port_attack, o.port_inclination] for o in seen])
    (alpha, delta), (most_alpha, most_delta) = angles.min(axis=0), angles.max(axis=0)
    return [
        f'wanted α {np.degrees(attack):.1f}° and δ {np.degrees(abs(inclination)):.1f}°; nearest '
        f'over the range: α {alpha:.1f}° to {most_alpha:.1f}°, δ {delta:.1f}° to {most_delta:.1f}°'
    ]


def _closing(found: 'RangeTrim') -> str:
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
