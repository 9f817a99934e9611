# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl compare``, and the output that it shares with ``trawl bag compare``."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.console.tables import output_console, plain_table
from trawl_ros.cli.options import (
    BAG,
    FOLDER,
    FORCE_OPTION,
    GEAR_OPTION,
    NAMESPACE_OPTION,
    UNITS_OPTION,
)
from trawl_ros.core.display_units import DisplayUnits

if TYPE_CHECKING:
    from trawl_ros.comparison.comparison import Comparison

OUT_OPTION = click.option('--out', type=FOLDER, help='Folder for page, JSON and figures.')


@click.command('compare')
@click.argument('logs', metavar='LOG...', nargs=-1, required=True, type=BAG)
@GEAR_OPTION
@click.option('--mapping', type=BAG, help='Mapping file or name, if LOGs are no bags.')
@OUT_OPTION
@UNITS_OPTION
@NAMESPACE_OPTION
@FORCE_OPTION
def command(
    logs: Sequence[Path],
    gear: str,
    mapping: Path | None,
    out: Path | None,
    units: DisplayUnits,
    namespace: str,
    force: bool,
) -> None:
    """Compare LOGs with a gear file as it is, one log per tow; nothing is fitted.

    The command prints each sensor over all steady states: measured, predicted, difference, and this
    in std of its error. With --out it writes comparison.html, comparison.json and figures, with
    each state and the course in time.
    """
    from trawl_ros.api.comparing import compare

    console = error_console()
    with ProgressDisplay(console) as display:
        found = compare(
            logs,
            gear=gear,
            mapping=mapping,
            out=out,
            namespace=namespace,
            units=units,
            force=force,
            on_note=lambda note: console.print(note, style='yellow', markup=False),
            on_progress=display,
        )
    print_comparison(found, units, out)


def print_comparison(found: 'Comparison', units: DisplayUnits, out: Path | None) -> None:
    """Print the table of sensors, the verdict and the next step."""
    from trawl_ros.comparison.page import PAGE, cells

    heads = (*found.names, 'difference', '%', 'in std', 'states')
    table = plain_table('sensor', *heads, right=heads)
    for sensor in found.sensors:
        row = cells(sensor.channel, sensor.mean, units)
        keys = ('name', 'measured', 'reference', 'difference', 'percent', 'scaled')
        table.add_row(*(str(row[key]) for key in keys), str(sensor.states))
    console = output_console()
    console.print(table)
    for note in found.notes:
        click.echo(f'Note: {note}')
    click.echo(found.verdict.sentence)
    click.echo(found.next_step)
    if out is not None:
        click.echo(out / PAGE)
