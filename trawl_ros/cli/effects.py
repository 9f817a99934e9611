# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl effects``."""

import click
from rich.console import Console

from trawl_ros.cli.console.tables import output_console, plain_table
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.registry import catalogue


@click.command('effects')
@click.argument('names', nargs=-1)
def command(names: tuple[str, ...]) -> None:
    """List all effects of the catalogue, or only NAMES.

    A gear file can contain each of them under `effects`.
    """
    known = catalogue()
    for name in names:
        if name not in known:
            raise click.UsageError(f'found {name}, expected one of {", ".join(known)}')
    console = output_console()
    for name in names or known:
        _print(known[name], console)


def _print(effect: Effect, console: Console) -> None:
    console.print(effect.name, style='bold')
    console.print(f'  {effect.sentence}', soft_wrap=True)
    table = plain_table('   parameter', 'unit', 'not there', 'from', 'to', right=('not there',))
    for parameter in effect.parameters:
        numbers = parameter.neutral, parameter.low, parameter.high
        cells = (f'{number:g}' for number in numbers)
        table.add_row(f'   {parameter.name}', parameter.unit or '–', *cells)
    if effect.parameters:
        console.print(table)
    console.print(f'  Shown by {effect.excited_by}.', soft_wrap=True)
    if effect.causes:
        console.print(f'  Looks like this: {effect.causes}', soft_wrap=True)
    if effect.direct:
        console.print(f'  To check: {effect.direct}', soft_wrap=True)
    if effect.confused_with:
        console.print(f'  Easily confused with {", ".join(effect.confused_with)}.', soft_wrap=True)
    console.print()
