# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl gear``."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console

from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.console.state_lines import state_lines
from trawl_ros.cli.console.tables import output_console, plain_table
from trawl_ros.cli.options import FILE, FOLDER, SPEED, UNITS_OPTION, WARP, Number
from trawl_ros.core.display_units import DisplayUnits
from trawl_ros.core.errors import GearError

if TYPE_CHECKING:
    from trawl_ros.api.gear_check import GearCheck
    from trawl_ros.gear.net_plan import NetPlanRecord

EXIT_FINDINGS = 3
"""Exit code of ``trawl gear check`` with findings; 1 is an error, 2 wrong usage."""


@click.group('gear')
def command() -> None:
    """Check, copy and change gear files, find their steady states, and read net plans."""


@command.command('check')
@click.argument('gear', metavar='GEAR')
@click.option('--out', type=FOLDER, help='Folder for drawings of the net plan and the rigged gear.')
@UNITS_OPTION
def check(gear: str, out: Path | None, units: DisplayUnits) -> None:
    """Check GEAR without solving it, and print its main quantities.

    GEAR is a gear file or the name of a gear of the package. The command prints twine area, weights
    in water, the drag by empirical formulas, derived values, and findings. It exits with 3 if there
    are findings.
    """
    from trawl_ros.api.gear_check import check_gear, drag_of_model, draw_gear
    from trawl_ros.gear.drag_bands import BANDS, KNOT
    from trawl_ros.model.rigging import ropes_of

    found = check_gear(gear)
    console, model = output_console(), found.model
    click.echo(
        f'{found.gear.name}: {found.twine_area:.4g} m² of twine; {len(model.layout.net)} nodes in '
        f'the net, {model.gear.netting.around} meshes around the mouth'
    )
    if found.gear.netting.plan is not None:
        _print_plan(found.gear.netting.plan, found, console)
    if model.catch is not None:
        body = model.catch.body
        click.echo(
            f'catch: {body.volume:.3g} m³ in {body.length:.3g} m of the codend, '
            f'{2 * body.radius:.3g} m across'
        )
    head = 0.5 * model.water.density * (2.0 * KNOT) ** 2
    for item in found.gear.hung:
        if item.lift_area_m2:
            lift = head * item.lift_area_m2 * len(ropes_of(item))
            click.echo(f'{item.name}: lift of {units.weight(lift)} at 2 knots')
    table = plain_table('weight in water', '', right=('',))
    for name, weight in found.weights.items():
        table.add_row(name, units.weight(weight))
    table.add_row('all but the warps', units.weight(sum(found.weights.values())))
    console.print(table)
    table = plain_table(
        'drag of the net', *BANDS, 'the model as built', right=(*BANDS, 'the model as built')
    )
    for knots, bands in found.drag.items():
        table.add_row(
            f'{knots:g} knots',
            *(units.shown(bands[name], 'tension', 0) for name in BANDS),
            units.shown(drag_of_model(model, knots), 'tension', 0),
        )
    console.print(table)
    for key, value in found.derived.items():
        click.echo(f'derived: {key}: {value}')
    for finding in found.findings:
        click.echo(f'looks wrong: {finding}')
    if not found.findings:
        click.echo('nothing looks wrong')
    for picture in draw_gear(found, out) if out is not None else ():
        click.echo(picture)
    if found.findings:
        raise SystemExit(EXIT_FINDINGS)


def _print_plan(plan: 'NetPlanRecord', found: 'GearCheck', console: Console) -> None:
    """Print the pieces of a net plan, and the netting along its ropes as planned and as cut."""

    def told(lengths: Mapping[str, float]) -> str:
        return ', '.join(f'{kind} {metres:.4g} m' for kind, metres in lengths.items())

    table = plain_table(
        'part', 'panel', 'section', 'mesh mm', 'across', 'along', 'm long', 'twine', 'mm', 'm²',
        'kg', right=('mesh mm', 'along', 'm long', 'mm', 'm²', 'kg'),
    )  # fmt: skip
    for piece in plan.pieces:
        table.add_row(
            piece.part,
            f'{piece.count} × {piece.panel}' if piece.panel != 'all' else 'all',
            piece.section,
            f'{piece.mesh_mm:g}',
            f'{piece.front_meshes:g}–{piece.back_meshes:g}',
            f'{piece.long_meshes:g}',
            f'{piece.length:.2f}',
            f'{piece.material}{"" if piece.knots == "knotted" else " knotless"}'
            f'{"" if piece.orientation == "T0" else f" {piece.orientation}"}',
            f'{1e3 * piece.twine.diameter:.2f}',
            f'{piece.twine_area:.1f}',
            f'{piece.mass:.1f}',
        )
    console.print(table)
    for rope in ('headrope', 'footrope', 'side_rope'):
        record = getattr(found.gear, rope)
        given = None if record is None else record.length_m
        length = plan.rope_length(rope) if given is None else given
        netting = told(plan.hung_netting(rope))
        click.echo(f'{rope}: {length:.4g} m of rope on netting of {netting}')
    for rope, rim in zip(('headrope', 'footrope', 'side_rope'), found.model.net_mesh.frame or ()):
        cut = {
            kind: sum(m for k, m in zip(rim.kinds, rim.netting, strict=True) if k == kind)
            for kind in plan.hung_netting(rope)
        }
        click.echo(f'{rope} as the meshes of the model are cut: {told(cut)}')


@command.command('state')
@click.argument('gear', metavar='GEAR')
@click.option('--warp', required=True, type=WARP, help='Warp length, m or with its unit.')
@click.option(
    '--speed', required=True, type=SPEED, help='Speed through the water, m/s or with its unit.'
)
@UNITS_OPTION
def state(gear: str, warp: float, speed: float, units: DisplayUnits) -> None:
    """Print the steady state of GEAR, or why there is none.

    GEAR is a gear file or the name of a gear of the package. If there is no usable state, the
    command prints the reason, the speeds at which the gear can be towed on this warp, and changes
    of the gear that help. Each change was solved. The exit code is then 1.
    """
    from trawl_ros.core.errors import NoSteadyState
    from trawl_ros.gear.load import load_gear
    from trawl_ros.model.gear_model import build_model
    from trawl_ros.solver.advising.advice import advice
    from trawl_ros.solver.equilibrium import steady_state

    model = build_model(load_gear(gear))
    try:
        steady = steady_state(model, warp, speed)
    except NoSteadyState:
        with ProgressDisplay(error_console()) as display:
            found = advice(model, warp, speed, on_progress=display)
        for line in found.lines if found is not None else ():
            click.echo(units.sentence(line))
        raise SystemExit(1) from None
    *lines, tension = state_lines(steady.observables, units, paired=model.gear.pair is not None)
    settles = f'the slowest motion settles in {steady.stability.settling_time:.0f} s'
    click.echo('\n'.join((*lines, f'{tension}; {settles}')))


@command.command('import')
@click.argument('plan', type=FILE)
def import_plan(plan: Path) -> None:
    """Print the net plan of a table as lines of a gear file.

    PLAN is a CSV file with one row per piece. Its columns are the keys of a piece: part, panel,
    section, mesh_mm, front_meshes, back_meshes, long_meshes, rtex or twine_diameter_mm, material,
    knots, twines, pieces, cut. Cells of optional keys may be empty.
    """
    from trawl_ros.gear.plan_table import plan_text, read_plan

    click.echo(plan_text(read_plan(plan)), nl=False)


@command.command('doors')
def doors() -> None:
    """List the doors of the catalogue, with their sources."""
    from trawl_ros.core.resources import share_path
    from trawl_ros.gear.polars import load_door

    table = plain_table('door', 'angles', 'C_L at most', 'source', wrapped=('source',))
    for path in sorted(share_path('config', 'doors').glob('*.yaml')):
        door = load_door(path.stem)
        best = max(door.points, key=lambda point: point.lift)
        table.add_row(
            door.name,
            f'{door.points[0].attack_deg:g}–{door.points[-1].attack_deg:g}°',
            f'{best.lift:g} at {best.attack_deg:g}°',
            ' '.join(door.source.split()),
        )
    output_console().print(table)


@command.command('copy')
@click.argument('gear', metavar='GEAR')
@click.argument('file', type=FILE)
def copy(gear: str, file: Path) -> None:
    """Copy GEAR to a new FILE of your own.

    GEAR is a gear file or the name of a gear of the package.
    """
    from trawl_ros.gear.door_text import copy_gear

    copy_gear(gear, file)
    click.echo(f'{file}: a copy of {gear}')


@command.command('set-door')
@click.argument('file', type=FILE)
@click.argument('door')
@click.option('--warp', required=True, type=WARP, help='Warp length of a usual tow, m.')
@click.option('--speed', required=True, type=SPEED, help='Its speed through the water, m/s.')
@click.option(
    '--area', type=Number(0.1, 100.0), help='Area of the new plate, m²; by default that of FILE.'
)
@UNITS_OPTION
def set_door(
    file: Path, door: str, warp: float, speed: float, area: float | None, units: DisplayUnits
) -> None:
    """Put another door on the gear in FILE.

    DOOR is a name of the catalogue or a door file. The command finds shackle points at which the
    doors have a usable steady state at --warp and --speed, and prints what it changed. If it finds
    none, FILE stays as it is, and the command says what was tried and which plate area would have
    the old lift. `trawl gear doors` lists the doors. Mass and volume of the plate stay: write those
    of the new door into FILE. `trawl trim` finds points for other angles.
    """
    from trawl_ros.cli.trim import points_lines, state_line
    from trawl_ros.gear.door_text import with_door, write_door
    from trawl_ros.gear.load import load_gear
    from trawl_ros.gear.polars import load_door
    from trawl_ros.solver.trimming.new_door import fit_door

    if not file.is_file():
        raise GearError(
            f'{file}: no such file, expected a gear file of your own: '
            '`trawl gear copy GEAR FILE` makes one'
        )
    old, published = load_gear(file), load_door(door)
    with ProgressDisplay(error_console()) as display:
        found = fit_door(
            old, door, warp_length=warp, speed=speed, area_m2=area, on_progress=display
        )
    board, text = found.gear.board, file.read_text(encoding='utf-8')
    write_door(file, with_door(text, board, found.trim.points, plate=area is not None))
    if found.before is not None:
        click.echo(units.sentence(f'before: {state_line(warp, speed, found.before)}'))
    click.echo(units.sentence(f'now: {state_line(warp, speed, found.trim.steady)}'))
    click.echo(f'{file}: changed; its board now has the law of {published.name} and these points:')
    click.echo('\n'.join(points_lines(found.trim.points)))
    click.echo(
        'Coefficients and `identification` of the old board are gone: corrections of the law begin '
        f'at zero. The plate has {board.area_m2:.4g} m², '
        f'{board.span_m:.3g} by {board.chord_m:.3g} m, and {board.mass_kg:g} kg. Its aspect ratio '
        f'is {board.span_m**2 / board.area_m2:.2g}'
        + (f'; that of the door is {published.aspect_ratio:g}' if published.aspect_ratio else '')
        + '.'
    )
