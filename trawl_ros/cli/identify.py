"""``trawl identify``."""

from collections.abc import Sequence
from pathlib import Path

import click
from rich.console import Console
from rich.progress import Progress

from trawl_ros.cli.files import BAG, FOLDER, SCENARIO
from trawl_ros.cli.progress import error_console
from trawl_ros.cli.read_tows import read_tows
from trawl_ros.errors import TrawlError
from trawl_ros.files import empty_folder, packaged
from trawl_ros.gear.load import load_gear
from trawl_ros.identification.from_gear import estimator_options, identification_for
from trawl_ros.identification.report import Report, report
from trawl_ros.identification.table import (
    channel_table,
    closing_lines,
    coefficient_table,
    opening_line,
)
from trawl_ros.identification.tows import FoundWindows, estimate_tows
from trawl_ros.identification.writing import write_report
from trawl_ros.messages.topics import NAMESPACE
from trawl_ros.scenario.scenario import true_coefficients

TABLE_WIDTH = 100


@click.command('identify')
@click.argument('bags', nargs=-1, required=True, type=BAG)
@click.option('--out', required=True, type=FOLDER, help='Folder for page, JSON and figures.')
@click.option(
    '--gear', default='kaifuha', show_default=True, help='The gear as the model has it: a file or '
    'the name of one that comes with the package.',
)  # fmt: skip
@click.option(
    '--truth', type=SCENARIO, help='Scenario that made the bags; its coefficients are set beside '
    'the estimates.',
)  # fmt: skip
@click.option('--no-prior', is_flag=True, help='Let the data alone decide, within the bounds.')
@click.option(
    '--net', is_flag=True, help='Estimate drag and weight of the net along; else they are held as '
    'the gear file has them.',
)  # fmt: skip
@click.option('--namespace', default=NAMESPACE, show_default=True, help='Of the topics.')
@click.option(
    '--scheduler', help='Address of a Dask cluster that reads the bags, which it must see under '
    'the same paths; without it, processes of this machine do. It runs code and must be '
    'trusted; tls:// takes '
    "the keys of Dask's configuration.",
)  # fmt: skip
@click.option('--force', is_flag=True, help='Replace the results of an earlier run in --out.')
def command(
    bags: Sequence[Path],
    out: Path,
    gear: str,
    truth: Path | None,
    no_prior: bool,
    net: bool,
    namespace: str,
    scheduler: str | None,
    force: bool,
) -> None:
    """Refit the twelve board coefficients from BAGS, each of them a tow.

    Writes report.html, identification.json and figures. Each tow is left out in turn and
    predicted from the others; with a single one, its steady states are.
    """
    empty_folder(out, force=force)
    true_values = None if truth is None else true_coefficients(packaged(truth, 'scenarios'))
    options = estimator_options(prior=not no_prior, net=net)
    record = load_gear(gear)
    console = error_console()
    found = read_tows(bags, record, namespace, console, scheduler)
    _warn(found, console)
    identification = identification_for(record, estimator_options=options)
    with Progress(console=console, transient=True) as progress:
        fit = progress.add_task('fitting', total=None)
        names = estimate_tows(
            identification, found, lambda done, of: progress.update(fit, completed=done, total=of)
        )
        if reason := identification.why_not():
            raise TrawlError(f'{", ".join(map(str, bags))}: {reason}')
        left = progress.add_task('leaving out, one after another', total=None)
        said = report(
            identification,
            true_values,
            tows=names,
            gear=record,
            begun=lambda number, of: progress.update(left, completed=number - 1, total=of),
        )
    write_report(said, out)
    print_report(said)


def print_report(found: Report) -> None:
    """Print the verdict, tables and closing sentences."""
    console = Console(highlight=False, soft_wrap=True)
    width = None if console.is_terminal else TABLE_WIDTH
    console.print(opening_line(found), style='bold')
    console.print(coefficient_table(found), width=width)
    console.print(channel_table(found), width=width)
    for line in closing_lines(found):
        console.print(line)


def _warn(found: Sequence[FoundWindows], console: Console) -> None:
    """Warn of damage; refuse bags none of which has a window, with the first one's reason."""
    for part in found:
        for problem in part.problems:
            console.print(f'Damaged: {problem}', style='yellow', markup=False)
    empty = [part for part in found if part.why_not is not None]
    if len(empty) == len(found):
        raise TrawlError('; '.join(f'{part.name}: {part.why_not}' for part in found))
    for part in empty:
        console.print(f'Not used: {part.name}: {part.why_not}', style='yellow', markup=False)
