"""``trawl gear``."""

from pathlib import Path

import click

from trawl_ros.cli.options import FILE, FOLDER
from trawl_ros.cli.tables import output_console, plain_table

WRONG = 3
"""Exit code of ``trawl gear check`` where something looks wrong; 1 is an error, 2 a wrong call."""


@click.group('gear')
def command() -> None:
    """Check gear files and make them from net plans."""


@command.command('check')
@click.argument('gear', metavar='GEAR')
@click.option('--out', type=FOLDER, help='Folder for pictures of the net plan and the rigged gear.')
def check(gear: str, out: Path | None) -> None:
    """Load GEAR and say what it comes to, before anything is solved.

    GEAR is a gear file or the name of one that comes with the package. Prints twine area, weights
    in water, the drag that empirical formulas expect, what was derived, and what looks wrong; ends
    with code 3 if anything does.
    """
    from trawl_ros.api.gear_check import check_gear, drag_of_model, draw_gear
    from trawl_ros.gear.drag_bands import BANDS

    found = check_gear(gear)
    console, plan = output_console(), found.gear.netting.plan
    model = found.model
    click.echo(
        f'{found.gear.name}: {found.twine_area:.4g} m² of twine; {len(model.layout.net)} nodes in '
        f'the net, {model.gear.netting.around} meshes around the mouth'
    )
    if plan is not None:
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
            netting = ', '.join(
                f'{kind} {metres:.4g} m' for kind, metres in plan.hung_netting(rope).items()
            )
            click.echo(f'{rope}: {length:.4g} m of rope on netting of {netting}')
        for rope, rim in zip(('headrope', 'footrope', 'side_rope'), model.net_mesh.frame or ()):
            cut = {
                kind: sum(m for k, m in zip(rim.kinds, rim.netting, strict=True) if k == kind)
                for kind in plan.hung_netting(rope)
            }
            netting = ', '.join(f'{kind} {metres:.4g} m' for kind, metres in cut.items())
            click.echo(f'{rope} as the meshes of the model are cut: {netting}')
    table = plain_table('weight in water', 'N', right=('N',))
    for name, weight in found.weights.items():
        table.add_row(name, f'{weight:.0f}')
    table.add_row('all but the warps', f'{sum(found.weights.values()):.0f}')
    console.print(table)
    table = plain_table(
        'drag of the net, kN', *BANDS, 'the model as built', right=(*BANDS, 'the model as built')
    )
    for knots, bands in found.drag.items():
        table.add_row(
            f'{knots:g} knots',
            *(f'{1e-3 * bands[name]:.0f}' for name in BANDS),
            f'{1e-3 * drag_of_model(model, knots):.0f}',
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
        raise SystemExit(WRONG)


@command.command('import')
@click.argument('plan', type=FILE)
def import_plan(plan: Path) -> None:
    """Turn a net plan from a table into the section of a gear file, on the standard output.

    PLAN is a CSV file whose columns are the keys of a piece: part, panel, section, mesh_mm,
    front_meshes, back_meshes, long_meshes, rtex or twine_diameter_mm, material, knots, twines,
    pieces, cut. Cells may be empty where a key may be missing.
    """
    from trawl_ros.gear.plan_table import plan_text, read_plan

    click.echo(plan_text(read_plan(plan)), nl=False)


@command.command('doors')
def doors() -> None:
    """List the doors of the catalogue, with their sources."""
    from trawl_ros.core.resources import share_path
    from trawl_ros.gear.polars import load_door

    table = plain_table('door', 'angles', 'C_L at most', 'source')
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
