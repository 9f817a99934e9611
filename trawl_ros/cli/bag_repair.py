"""``trawl bag repair``."""

from pathlib import Path

import click

from trawl_ros.bags.repair import SUFFIX, repair_bag
from trawl_ros.cli.files import BAG, FOLDER
from trawl_ros.cli.progress import ProgressDisplay, error_console

LOST = 3
"""Exit code where something was lost; 1 is an error, 2 a wrong call."""


@click.command('repair')
@click.argument('bag', type=BAG)
@click.option(
    '--out',
    type=FOLDER,
    help=f'Folder to be made; by default beside the bag, with {SUFFIX} behind its name.',
)
@click.pass_context
def repair(context: click.Context, bag: Path, out: Path | None) -> None:
    """Make a whole bag of one that was cut short or damaged, or whose metadata are wrong.

    BAG is a bag's folder or one MCAP file of it, and is left as it is. All that passes its
    checksum goes into a new bag, with indexes and metadata.

    Exit codes: 0 nothing was lost, or there was nothing to repair; 3 messages were lost, or may
    have been in what could not be read; 1 nothing could be saved.
    """
    with ProgressDisplay(error_console()) as display:
        done = repair_bag(bag, out, on_progress=display)
    count = sum(done.saved.values())
    if done.out is None:
        click.echo(f'{bag}: sound, {count} messages; nothing to repair')
        return
    click.echo(f'{done.out}: {count} messages saved')
    for problem in done.problems:
        click.echo(f'Damaged: {problem}', err=True)
    for topic, number in done.lost.items():
        click.echo(f'Lost: {number} of {number + done.saved.get(topic, 0)} on {topic}')
    if done.lost:
        click.echo(f'Lost: {sum(done.lost.values())} messages that the bag had counted')
    elif done.unread:
        click.echo('Lost: what may have been in the damaged parts was not counted by the bag')
    context.exit(0 if done.whole else LOST)
