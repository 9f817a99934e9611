"""``trawl bag``."""

from datetime import datetime, timezone
from pathlib import Path

import click

from trawl_ros.bags.reader import summarise
from trawl_ros.cli.files import BAG
from trawl_ros.errors import BagError

NANOSECONDS = 1_000_000_000


@click.group('bag')
def command() -> None:
    """Look into bags."""


@command.command('info')
@click.argument('bag', type=BAG)
def info(bag: Path) -> None:
    """Count what can be read in a bag, and say what cannot."""
    summary = summarise(bag)
    if summary.start is None or summary.end is None:
        raise BagError('; '.join(summary.problems))
    begin = datetime.fromtimestamp(summary.start / NANOSECONDS, timezone.utc)
    minutes = (summary.end - summary.start) / NANOSECONDS / 60
    click.echo(f'{bag}: {summary.count} messages in {minutes:.1f} min from {begin:%F %T} UTC')
    for topic in summary.topics:
        click.echo(f'{topic.count:8d}  {topic.topic}  {topic.type}')
    for problem in summary.problems:
        click.echo(f'Damaged: {problem}', err=True)
