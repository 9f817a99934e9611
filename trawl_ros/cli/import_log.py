"""``trawl import-log``."""

from pathlib import Path

import click

from trawl_ros.bags.import_log import import_log
from trawl_ros.cli.files import BAG
from trawl_ros.files import packaged


@click.command('import-log')
@click.argument('log', metavar='CSV', type=click.Path(path_type=Path))
@click.option(
    '--mapping',
    required=True,
    type=click.Path(path_type=Path),
    help='YAML file that says which column is what, or a name such as door_test_haul_log.',
)
@click.option('--out', required=True, type=BAG, help='Folder of the bag; must not exist yet.')
def command(log: Path, mapping: Path, out: Path) -> None:
    """Turn a CSV log from sea into a bag that replays like any other."""
    done = import_log(log, packaged(mapping, 'logs'), out)
    click.echo(f'{out}: {sum(done.counts.values())} messages from {done.rows} rows')
    for topic, count in done.counts.items():
        click.echo(f'{count:8d}  {topic}')
