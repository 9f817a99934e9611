"""``trawl bag``."""

from pathlib import Path

import click

from trawl_ros.bags.check import GROUPS, check_bag
from trawl_ros.bags.export import ARRAY_LIMIT, DICTIONARY, export_bag
from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import SUFFIX, repair_bag
from trawl_ros.bags.sentence_log import SentenceLog, write_sentence_log
from trawl_ros.cli.bag_tables import check_as_json, info_as_json, print_check, print_info
from trawl_ros.cli.options import BAG, FOLDER, NAMESPACE_OPTION, Number
from trawl_ros.cli.progress import ProgressDisplay, error_console
from trawl_ros.cli.tables import output_console
from trawl_ros.core.errors import BagError
from trawl_ros.records.fields import WaterColumn
from trawl_ros.sentences.table import load_tables, packaged_systems

FINDINGS = 3
"""Exit code of ``trawl bag check`` where something was found; 1 is an error, 2 a wrong call."""

LOST = 3
"""Exit code where something was lost; 1 is an error, 2 a wrong call."""

JSON_OPTION = click.option('--json', 'as_json', is_flag=True, help='Print JSON for scripts.')


@click.group('bag')
def command() -> None:
    """Look into bags, check them, repair them, and turn them into tables."""


@command.command('info')
@click.argument('bag', type=BAG)
@JSON_OPTION
def info(bag: Path, as_json: bool) -> None:
    """Count what can be read in a bag, and say what cannot.

    BAG is a bag's folder or one file of it, MCAP or SQLite, of any ROS 2 distribution; it may be
    damaged.
    """
    opened = Bag(bag, lenient=True)
    summary = opened.summary()
    if not summary.count:
        raise BagError('; '.join(summary.problems))
    if as_json:
        click.echo(info_as_json(opened, summary))
        return
    print_info(opened, summary, output_console())
    for problem in opened.problems:
        click.echo(f'Damaged: {problem}', err=True)


@command.command('check')
@click.argument('bag', type=BAG)
@click.option(
    '--require',
    multiple=True,
    metavar='NAME',
    help=f'A topic, or all of {", ".join(GROUPS)}, that must be there. May be given several times.',
)
@NAMESPACE_OPTION
@JSON_OPTION
@click.pass_context
def check(
    context: click.Context, bag: Path, require: tuple[str, ...], namespace: str, as_json: bool
) -> None:
    """Hold a bag against what it says of itself, and against the project's topics.

    Exit codes: 0 sound, 3 something was found, 1 the bag cannot be looked at.

    Findings are: files that are damaged, cut short or have no index; chunks that fail their
    checksum; metadata that disagree with the content; and on the project's topics a wrong type,
    best effort or volatile QoS where more is due, a rate a dozen times off the usual one, pauses
    of more than ten median intervals, stamps that run backward or repeat, stamps more than 5 s
    from the log time (and a sweep, for the sonar's), and what --require names and is not there.
    """
    done = check_bag(bag, namespace=namespace, required=require)
    if as_json:
        click.echo(check_as_json(done))
    else:
        print_check(done, output_console())
    context.exit(0 if done.sound else FINDINGS)


@command.command('export')
@click.argument('bag', type=BAG)
@click.option('--out', required=True, type=BAG, help='Folder to be made; with --as a file.')
@click.option(
    '--topic',
    'topics',
    multiple=True,
    metavar='NAME',
    help='A topic wanted, e.g. winch/joint_states. May be given several times; by default all.',
)
@click.option(
    '--array-limit',
    type=click.IntRange(1, 1000),
    default=ARRAY_LIMIT,
    show_default=True,
    help='Elements up to which an array is spread over columns; longer ones are left out.',
)
@click.option(
    '--as',
    'systems',
    multiple=True,
    metavar='SYSTEM',
    help='Write sentences of this system in place of tables: '
    f'{", ".join(packaged_systems())}, or a YAML file. May be given several times.',
)
@click.option(
    '--water-density',
    type=Number(900, 1100, min_open=True, max_open=True),
    default=1025.0,
    show_default=True,
    help='Density (kg/m3) by which pressures become the depths of sentences.',
)
@click.option(
    '--every-reading',
    is_flag=True,
    help='Write each reading as a sentence, also where the system sends them more seldom.',
)
@NAMESPACE_OPTION
def export(
    bag: Path,
    out: Path,
    topics: tuple[str, ...],
    array_limit: int,
    systems: tuple[str, ...],
    water_density: float,
    every_reading: bool,
    namespace: str,
) -> None:
    """Write a bag as CSV, one file per topic, or as a log of sentences.

    Columns are named by the path of their field; columns.csv says the unit of each. Times stand
    there twice, in seconds and in whole nanoseconds. A cell is empty where there is no reading.
    With --as, a file of the sentences that instruments of other make would have sent.
    """
    if systems:
        if topics:
            raise click.UsageError('--topic and --as: the systems say which topics are wanted')
        _tell_sentences(
            write_sentence_log(
                bag,
                load_tables(systems),
                out,
                water=WaterColumn(density_kg_m3=water_density),
                namespace=namespace,
                every_reading=every_reading,
            )
        )
        return
    with ProgressDisplay(error_console()) as display:
        done = export_bag(
            bag,
            out,
            topics=topics,
            namespace=namespace,
            array_limit=array_limit,
            on_progress=display,
        )
    for topic in done.topics:
        where = topic.file or 'no file'
        click.echo(f'{topic.rows:8d} rows  {where}')
        for path, reason in topic.left_out.items():
            click.echo(f'{topic.topic}: {path} is left out, since it {reason}', err=True)
    click.echo(f'{out / DICTIONARY} says what the columns are')
    for problem in done.problems:
        click.echo(f'Damaged: {problem}', err=True)


def _tell_sentences(done: SentenceLog) -> None:
    for address, count in done.sentences.items():
        click.echo(f'{count:8d}  {address}')
    for topic in done.silent:
        click.echo(f'No reading of {topic} in the bag', err=True)
    for problem in done.problems:
        click.echo(f'Damaged: {problem}', err=True)


@command.command('repair')
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
