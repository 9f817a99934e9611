# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl bag``."""

from pathlib import Path
from typing import Literal

import click

from trawl_ros.bags.check import GROUPS, check_bag
from trawl_ros.bags.export import ARRAY_LIMIT, DICTIONARY, export_bag
from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import SUFFIX, repair_bag
from trawl_ros.bags.sentence_log import SentenceLog, write_sentence_log
from trawl_ros.cli.compare import OUT_OPTION, print_comparison
from trawl_ros.cli.console.bag_tables import check_as_json, info_as_json, print_check, print_info
from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.console.tables import output_console
from trawl_ros.cli.options import (
    BAG,
    FOLDER,
    FORCE_OPTION,
    GEAR_OPTION,
    NAMESPACE_OPTION,
    NEW_BAG,
    UNITS_OPTION,
    Number,
)
from trawl_ros.core.display_units import DisplayUnits
from trawl_ros.core.errors import BagError
from trawl_ros.records.fields import WaterColumn
from trawl_ros.sentences.table import load_tables, packaged_systems

EXIT_FINDINGS = 3
"""Exit code of ``trawl bag check`` with findings; 1 is an error, 2 wrong usage."""

EXIT_LOST = 3
"""Exit code of ``trawl bag repair`` with lost messages; 1 is an error, 2 wrong usage."""

JSON_OPTION = click.option('--json', 'as_json', is_flag=True, help='Print JSON for scripts.')


@click.group('bag')
def command() -> None:
    """Inspect, check, repair, compare and export bags."""


@command.command('info')
@click.argument('bag', type=BAG)
@JSON_OPTION
def info(bag: Path, as_json: bool) -> None:
    """Count the messages of BAG, and list its damage.

    BAG is the folder of a bag or one file of it, MCAP or SQLite, of any ROS 2 distribution. It may
    be damaged.
    """
    opened = Bag(bag, lenient=True)
    summary = opened.summary()
    if not summary.count:
        raise BagError(f'{"; ".join(summary.problems)}, expected at least one; record it again')
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
    help=f'Topic that the bag must contain, or a group: {", ".join(GROUPS)}. May be given several '
    'times.',
)
@NAMESPACE_OPTION
@JSON_OPTION
@click.pass_context
def check(
    context: click.Context, bag: Path, require: tuple[str, ...], namespace: str, as_json: bool
) -> None:
    """Check BAG against its metadata and the topics of the project.

    Exit codes: 0 without findings, 3 with findings, 1 if the bag cannot be read.

    Findings are files that are damaged, cut short or without an index, chunks with a wrong
    checksum, and metadata that contradict the content. On the topics of the project, findings are a
    wrong type, best-effort or volatile QoS where the project requires more, a rate that differs by
    a factor of 12 from the usual one, gaps of more than ten median intervals, stamps that run
    backward or repeat, and stamps more than 5 s from the log time (plus a sweep for sonars). Topics
    of --require that the bag does not contain are findings too.
    """
    done = check_bag(bag, namespace=namespace, required=require)
    if as_json:
        click.echo(check_as_json(done))
    else:
        print_check(done, output_console())
    context.exit(0 if done.sound else EXIT_FINDINGS)


@command.command('compare')
@click.argument('first', metavar='A', type=BAG)
@click.argument('second', metavar='B', type=BAG)
@click.option(
    '--by',
    type=click.Choice(('state', 'time')),
    default='state',
    show_default=True,
    help='Pair steady states of equal warp and speed, or compare stretches of five minutes.',
)
@click.option(
    '--shift',
    type=Number(-1e9, 1e9),
    help='Time that is added to B, s. By default none if the times of both overlap; otherwise '
    'both start together.',
)
@GEAR_OPTION
@OUT_OPTION
@UNITS_OPTION
@NAMESPACE_OPTION
@FORCE_OPTION
def compare(
    first: Path,
    second: Path,
    by: Literal['state', 'time'],
    shift: float | None,
    gear: str,
    out: Path | None,
    units: DisplayUnits,
    namespace: str,
    force: bool,
) -> None:
    """Compare the bags A and B sensor by sensor.

    Only the water of --gear is used, which converts pressures to depths. Differences are A minus B.
    """
    from trawl_ros.api.comparing import compare_bags
    from trawl_ros.comparison.between_bags import Alignment

    console = error_console()
    with ProgressDisplay(console) as display:
        found = compare_bags(
            first,
            second,
            by=by,
            alignment=Alignment(shift_s=shift),
            gear=gear,
            out=out,
            namespace=namespace,
            units=units,
            force=force,
            on_note=lambda note: console.print(note, style='yellow', markup=False),
            on_progress=display,
        )
    print_comparison(found, units, out)


@command.command('export')
@click.argument('bag', type=BAG)
@click.option('--out', required=True, type=NEW_BAG, help='New folder; with --as, new file.')
@click.option(
    '--topic',
    'topics',
    multiple=True,
    metavar='NAME',
    help='Topic to export, such as winch/joint_states. May be given several times; by default all.',
)
@click.option(
    '--array-limit',
    type=click.IntRange(1, 1000),
    default=ARRAY_LIMIT,
    show_default=True,
    help='Longest array that is written to columns; longer ones are left out.',
)
@click.option(
    '--as',
    'systems',
    multiple=True,
    metavar='SYSTEM',
    help='Write sentences of this system instead of tables: '
    f'{", ".join(packaged_systems())}, or a YAML file. May be given several times.',
)
@click.option(
    '--water-density',
    type=Number(900, 1100, min_open=True, max_open=True),
    default=1025.0,
    show_default=True,
    help='Density of the water (kg/m3) that converts pressure to depth in sentences.',
)
@click.option(
    '--every-reading',
    is_flag=True,
    help='Write each reading as a sentence, even if the real system sends fewer.',
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
    """Export BAG to CSV files or to a log of sentences.

    The name of a column is the path of its field; columns.csv lists the units. Times are given in
    seconds and in whole nanoseconds. A cell without a reading is empty. With --as, the command
    writes a file of the sentences that instruments of other makers would have sent.
    """
    if systems:
        if topics:
            raise click.UsageError(
                '--topic and --as: found both, expected one; the system determines the topics'
            )
        _print_sentences(
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
            click.echo(f'{topic.topic}: {path} is left out because it {reason}', err=True)
    click.echo(f'{out / DICTIONARY} describes the columns')
    for problem in done.problems:
        click.echo(f'Damaged: {problem}', err=True)


def _print_sentences(done: SentenceLog) -> None:
    for address, count in done.sentences.items():
        click.echo(f'{count:8d}  {address}')
    for topic in done.silent:
        click.echo(f'The bag has no reading of {topic}', err=True)
    for problem in done.problems:
        click.echo(f'Damaged: {problem}', err=True)


@command.command('repair')
@click.argument('bag', type=BAG)
@click.option(
    '--out',
    type=FOLDER,
    help=f'New folder; by default that of the bag with {SUFFIX} appended.',
)
@click.pass_context
def repair(context: click.Context, bag: Path, out: Path | None) -> None:
    """Make a sound bag of what is left of a damaged one.

    BAG is the folder of a bag or one MCAP file of it, and is not changed. All data with a correct
    checksum go into a new bag, with indexes and metadata.

    Exit codes: 0 if nothing was lost or there was nothing to repair, 3 if messages were lost or
    may have been in unreadable parts, 1 if nothing could be saved.
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
        click.echo('Lost: unknown; the bag did not count the messages in its damaged parts')
    context.exit(0 if done.whole else EXIT_LOST)
