# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl swept``."""

import json
from dataclasses import asdict
from pathlib import Path

import click

from trawl_ros.cli.console.tables import output_console, plain_table
from trawl_ros.cli.options import BAG, GEAR_OPTION, NAMESPACE_OPTION
from trawl_ros.core.resources import bag_name


@click.command('swept')
@click.argument('bags', metavar='BAG...', nargs=-1, required=True, type=BAG)
@GEAR_OPTION
@NAMESPACE_OPTION
@click.option('--json', 'as_json', is_flag=True, help='Print JSON.')
def command(bags: tuple[Path, ...], gear: str, namespace: str, as_json: bool) -> None:
    """Print swept area and volume of each BAG, a haul, with 95 % intervals.

    The area is door spread, or width of the net's mouth, times the way over ground. The volume is
    width times height of the mouth times the way through the water. The haul lasts while more than
    half of the longest warp is out. The last column says what was measured and what was modelled.
    """
    from trawl_ros.api.swept import swept

    found = {bag_name(bag): swept(bag, gear, namespace=namespace) for bag in bags}
    if as_json:
        rows = {
            bag: [asdict(one) | {'interval': one.interval} for one in values]
            for bag, values in found.items()
        }
        click.echo(json.dumps(rows, indent=2, ensure_ascii=False))
        return
    for bag, values in found.items():
        table = plain_table(
            bag, 'value', '95 % interval', 'unit', 'from', right=('value', '95 % interval')
        )
        for one in values:
            low, high = one.interval
            table.add_row(
                one.name, f'{one.value:.4g}', f'{low:.4g}–{high:.4g}', one.unit, one.source
            )
        output_console().print(table)
