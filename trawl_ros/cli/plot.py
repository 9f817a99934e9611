# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl plot``."""

import re
from collections.abc import Sequence
from pathlib import Path

import click

from trawl_ros.cli.console.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.options import BAG, FOLDER, FORCE_OPTION, NAMESPACE_OPTION
from trawl_ros.plots.album import plot


class _Time(click.ParamType[float]):
    """Time after the start, ``90``, ``1:30`` or ``0:01:30``, as seconds."""

    name = 'time'

    def convert(
        self, value: str | float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        if isinstance(value, str) and re.fullmatch(r'(\d+:){0,2}\d+(\.\d+)?', value):
            parts = [float(part) for part in reversed(value.split(':'))]
            return sum(part * 60.0**k for k, part in enumerate(parts))
        self.fail(f'found {value!r}, expected seconds, minutes:seconds or hours:minutes:seconds')


@click.command('plot')
@click.argument('bag', type=BAG)
@click.option('--out', required=True, type=FOLDER, help='Folder for the pictures.')
@click.option(
    '--at', 'times', multiple=True, type=_Time(), metavar='TIME', help='Time after the start of '
    'the bag to draw the gear and the sonar image: 90, 1:30 or 1:02:30. May be given several '
    'times. By default early, in the middle and late.',
)  # fmt: skip
@click.option('--animate', is_flag=True, help='Also write a short animation.')
@click.option(
    '--gear', default='kaifuha', show_default=True, help='Gear file or name of a gear of the '
    'package. Its water converts pressure to depth.',
)  # fmt: skip
@NAMESPACE_OPTION
@FORCE_OPTION
def command(
    bag: Path,
    out: Path,
    times: Sequence[float],
    animate: bool,
    gear: str,
    namespace: str,
    force: bool,
) -> None:
    """Draw the tow of BAG: gear, true and measured quantities, sonar and the ship's track.

    The command writes pictures, and a page with all of them, to a folder.
    """
    with ProgressDisplay(error_console()) as display, Interruption() as interruption:
        drawn = plot(
            bag,
            out,
            times=times,
            animate=animate,
            gear=gear,
            namespace=namespace,
            force=force,
            stopped=lambda: interruption.requested,
            on_progress=display,
        )
    for picture in drawn.pictures:
        click.echo(f'{out / picture.file}: {picture.caption}')
    for note in drawn.notes:
        click.echo(note)
    click.echo(f'{drawn.page}: page with all pictures')
    if not drawn.complete:
        raise SystemExit(INTERRUPTED)
