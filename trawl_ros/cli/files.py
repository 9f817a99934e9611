# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl files``."""

import shutil
from pathlib import Path

import click

from trawl_ros.cli.options import FOLDER
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import new_folder
from trawl_ros.core.resources import share_path

FOLDERS = ('config', 'bags')


@click.command('files')
@click.option(
    '--out', type=FOLDER, help='Folder to copy config/ and bags/ into. Nothing is replaced.'
)  # fmt: skip
def command(out: Path | None) -> None:
    """Print the folder of the package's gears, doors, scenarios, tables and sample bag.

    With --out they are copied, so that they can be changed, and so that the commands of the guides
    work there as written.
    """
    if out is None:
        click.echo(share_path())
        return
    for name in FOLDERS:
        new_folder(out / name, TrawlError)
    for name in FOLDERS:
        shutil.copytree(share_path(name), out / name)
        click.echo(f'{out / name} is written')
