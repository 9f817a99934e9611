# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl tow``: make a bag in one process, without DDS."""

import time
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from trawl_ros.api import tows
from trawl_ros.cli.console.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.options import NEW_BAG, SCENARIO


@click.command('tow')
@click.argument('scenario', type=SCENARIO)
@click.option('--out', required=True, type=NEW_BAG, help='New folder for the bag.')
def command(scenario: Path, out: Path) -> None:
    """Tow SCENARIO and record it as a bag. The same seed gives the same bytes."""
    console = error_console()
    began = time.monotonic()
    with ProgressDisplay(console) as display, Interruption() as interruption:
        bag = tows.tow(scenario, out, stopped=lambda: interruption.requested, on_progress=display)
    _summarise(bag, time.monotonic() - began)
    if not bag.complete:
        console.print(
            f'Interrupted after {bag.duration_s / 60:.1f} of {bag.planned_s / 60:.1f} min: '
            f'{out} can be read up to this time.'
        )
        raise SystemExit(INTERRUPTED)


def _summarise(bag: tows.TowedBag, elapsed_s: float) -> None:
    table = Table(box=None, pad_edge=False)
    table.add_column('messages', justify='right')
    table.add_column('topic')
    for topic, count in bag.messages.items():
        table.add_row(str(count), topic)
    console = Console(soft_wrap=True, highlight=False)
    console.print(table)
    console.print(
        f'{bag.path}: {sum(bag.messages.values())} messages, {bag.duration_s / 60:.1f} min at sea '
        f'in {elapsed_s:.1f} s, {bag.duration_s / elapsed_s:.1f} × real time'
    )
