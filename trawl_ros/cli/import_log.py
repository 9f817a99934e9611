# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl import-log``."""

from pathlib import Path

import click

from trawl_ros.bags.logs.draft import draft_mapping
from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.cli.options import NEW_BAG
from trawl_ros.core.errors import LogError
from trawl_ros.core.foreign import open_file


@click.command('import-log')
@click.argument('log', type=click.Path(path_type=Path))
@click.option(
    '--mapping',
    type=click.Path(path_type=Path),
    help='YAML file that assigns columns or sentences to topics, or a name: notus, esonar, '
    'netmind, scanmar_scd, tv80, nmea, door_test_haul_log.',
)
@click.option('--out', type=NEW_BAG, help='New folder for the bag.')
@click.option(
    '--draft', is_flag=True, help='Print a mapping of the columns that are recognised; no bag.'
)
@click.option(
    '--leave-out',
    is_flag=True,
    help='Leave out and count rows that cannot be read; otherwise the first one is an error.',
)
def command(
    log: Path, mapping: Path | None, out: Path | None, draft: bool, leave_out: bool
) -> None:
    """Convert a log from sea to a bag.

    LOG is a table, such as CSV, or a file of NMEA 0183 sentences. The mapping determines the kind
    and assigns columns or sentences to topics.
    """
    with open_file(log, LogError) as content:
        if not content.read(1):
            raise LogError(f'{log}: the file is empty, expected a log')
    if draft:
        click.echo(draft_mapping(log), nl=False)
        return
    if mapping is None or out is None:
        raise click.UsageError(
            f'found {"neither --mapping nor" if mapping is None else "no"} --out, expected both; '
            'or --draft, which prints a mapping to begin with'
        )
    done = import_log(log, mapping, out, leave_out=leave_out)
    rows = 'lines' if done.of_sentences else 'rows'
    click.echo(f'{out}: {sum(done.counts.values())} messages from {done.rows} {rows}')
    for topic, count in done.counts.items():
        click.echo(f'{count:8d}  {topic}')
    for reason, count in done.left_out.items():
        click.echo(f'{count:8d}  {rows} left out: {reason}')
    for note in done.notes:
        click.echo(f'Note: {note}')
