"""``trawl trim``."""

import click
import numpy as np


@click.command('trim')
@click.argument('gear', metavar='GEAR')
@click.option('--attack', required=True, type=click.FloatRange(1.0, 40.0), help='Wanted α, deg.')
@click.option(
    '--inclination', required=True, type=click.FloatRange(0.0, 60.0), help='Wanted δ, deg.'
)
@click.option(
    '--pitch',
    default=0.0,
    show_default=True,
    type=click.FloatRange(-30.0, 30.0),
    help='Wanted pitch, nose down, deg.',
)
@click.option(
    '--warp',
    default=500.0,
    show_default=True,
    type=click.FloatRange(20.0, 3000.0),
    help='Warp length at which the angles are wanted, m.',
)
@click.option(
    '--speed',
    default=2.1,
    show_default=True,
    type=click.FloatRange(0.5, 4.0),
    help='Speed through the water, m/s.',
)
def command(
    gear: str, attack: float, inclination: float, pitch: float, warp: float, speed: float
) -> None:
    """Find fastening points that give the boards of GEAR wanted angles.

    GEAR is a gear file or the name of one that comes with the package. The search starts from
    the file's own points and changes them as little as it can. The result is printed as the
    file has it; nothing is written.
    """
    from trawl_ros.gear.load import load_gear
    from trawl_ros.model.gear_model import build_model
    from trawl_ros.solver.trim import trim

    model = build_model(load_gear(gear))
    trimmed = trim(
        model,
        attack=np.radians(attack),
        inclination=np.radians(inclination),
        pitch=np.radians(pitch),
        warp_length=warp,
        speed=speed,
    )
    click.echo('  fastening:')
    for name, point in zip(
        ('warp_m', 'upper_bridle_m', 'lower_bridle_m'), trimmed.points, strict=True
    ):
        click.echo(f'    {name}: [{", ".join(f"{x:.3f}" for x in point)}]')
    observables = trimmed.steady.observables
    click.echo(
        f'# at {warp:g} m and {speed:g} m/s: α {np.degrees(observables.port_attack):.1f}°, '
        f'δ {np.degrees(observables.port_inclination):.1f}°, '
        f'β {np.degrees(observables.port_slip):.1f}°, '
        f'spread {observables.door_spread:.1f} m, door depth {observables.door_depth:.1f} m, '
        f'tension {observables.warp_tension / 1e3:.1f} kN; the slowest motion settles in '
        f'{trimmed.steady.stability.settling_time:.0f} s'
    )
