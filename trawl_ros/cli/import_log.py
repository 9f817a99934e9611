"""``trawl import-log``."""

from pathlib import Path

import click

from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.cli.options import BAG


@click.command('import-log')
@click.argument('log', type=click.Path(path_type=Path))
@click.option(
    '--mapping',
    required=True,
    type=click.Path(path_type=Path),
    help='YAML file that says what is what, or a name: door_test_haul_log, nmea, tv80.',
)
@click.option('--out', required=True, type=BAG, help='Folder of the bag; must not exist yet.')
@click.option(
    '--leave-out',
    is_flag=True,
    help='Leave out rows that cannot be understood, and count them; else the first is an error.',
)
def command(log: Path, mapping: Path, out: Path, leave_out: bool) -> None:
    """Turn a log from sea into a bag that replays like any other.

    LOG is a table (CSV and its relatives) or a file of NMEA 0183 sentences; the mapping says
    which, and which column or sentence becomes which topic.
    """
    done = import_log(log, mapping, out, leave_out=leave_out)
    rows = 'lines' if done.of_sentences else 'rows'
    click.echo(f'{out}: {sum(done.counts.values())} messages from {done.rows} {rows}')
    for topic, count in done.counts.items():
        click.echo(f'{count:8d}  {topic}')
    for reason, count in done.left_out.items():
        click.echo(f'{count:8d}  {rows} left out: {reason}')
    for note in done.notes:
        click.echo(f'Note: {note}')
