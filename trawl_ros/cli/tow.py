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
from trawl_ros.cli.console.state_lines import state_lines
from trawl_ros.cli.options import NEW_BAG, SCENARIO, UNITS_OPTION
from trawl_ros.core.display_units import DisplayUnits


@click.command('tow')
@click.argument('scenario', type=SCENARIO)
@click.option('--out', required=True, type=NEW_BAG, help='New folder for the bag.')
@UNITS_OPTION
def command(scenario: Path, out: Path, units: DisplayUnits) -> None:
    """Tow SCENARIO and record it as a bag. The same seed gives the same bytes.

    The command prints the messages of the bag and the state at the end.
    """
    console = error_console()
    began = time.monotonic()
    with ProgressDisplay(console) as display, Interruption() as interruption:
        bag = tows.tow(scenario, out, stopped=lambda: interruption.requested, on_progress=display)
    _summarise(bag, time.monotonic() - began, units)
    if not bag.complete:
        console.print(
            f'Interrupted after {bag.duration_s / 60:.1f} of {bag.planned_s / 60:.1f} min: '
            f'{out} can be read up to this time.'
        )
        raise SystemExit(INTERRUPTED)


def _summarise(bag: tows.TowedBag, elapsed_s: float, units: DisplayUnits) -> None:
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
    if bag.end.observables is not None:
        lengths = dict.fromkeys(units.shown(winch.length, 'warp') for winch in bag.end.winches)
        speed = units.shown(float(bag.end.vessel.velocity_water[0]), 'speed')
        paired = bag.gear.pair is not None
        lines = state_lines(bag.end.observables, units, paired=paired)
        console.print(f'At the end, on {" and ".join(lengths)} of warp at {speed}:')
        console.print('\n'.join(lines))
