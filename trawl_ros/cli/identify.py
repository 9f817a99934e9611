"""``trawl identify``."""

from collections.abc import Sequence
from pathlib import Path

import click
from rich.console import Console

from trawl_ros.bags.samples import SampleStream
from trawl_ros.cli.files import BAG, FOLDER, SCENARIO
from trawl_ros.cli.progress import TimeProgress, error_console
from trawl_ros.errors import TrawlError
from trawl_ros.files import empty_folder, packaged
from trawl_ros.gear.load import load_gear
from trawl_ros.identification.estimator_options import EstimatorOptions
from trawl_ros.identification.from_gear import identification_for
from trawl_ros.identification.pipeline import Identification, WindowUsed
from trawl_ros.identification.report import Report, report
from trawl_ros.identification.table import channel_table, closing_lines, coefficient_table
from trawl_ros.identification.writing import write_report
from trawl_ros.messages.stamps import SECOND
from trawl_ros.messages.topics import NAMESPACE
from trawl_ros.scenario.scenario import true_coefficients

TABLE_WIDTH = 100


@click.command('identify')
@click.argument('bags', nargs=-1, required=True, type=BAG)
@click.option('--out', required=True, type=FOLDER, help='Folder for JSON and figures.')
@click.option(
    '--gear', default='kaifuha', show_default=True, help='The gear as the model has it: a file or '
    'the name of one that comes with the package.',
)  # fmt: skip
@click.option(
    '--truth', type=SCENARIO, help='Scenario that made the bags; its coefficients are set beside '
    'the estimates.',
)  # fmt: skip
@click.option('--no-prior', is_flag=True, help='Let the data alone decide, within the bounds.')
@click.option('--namespace', default=NAMESPACE, show_default=True, help='Of the topics.')
@click.option('--force', is_flag=True, help='Replace the results of an earlier run in --out.')
def command(
    bags: Sequence[Path],
    out: Path,
    gear: str,
    truth: Path | None,
    no_prior: bool,
    namespace: str,
    force: bool,
) -> None:
    """Refit the twelve board coefficients from BAGS, several tows as one data set.

    Writes identification.json and figures.
    """
    empty_folder(out, force=force)
    true_values = None if truth is None else true_coefficients(packaged(truth, 'scenarios'))
    options = EstimatorOptions(prior_weight=0.0) if no_prior else None
    identification = identification_for(load_gear(gear), estimator_options=options)
    console = error_console()
    stream = SampleStream(bags, namespace)
    _feed(identification, stream, console)
    for problem in stream.problems:
        console.print(f'Damaged: {problem}', style='yellow', markup=False)
    if reason := identification.why_not():
        raise TrawlError(f'{", ".join(map(str, bags))}: {reason}')
    with console.status('predicting steady states that are left out of the fit'):
        found = report(identification, true_values)
    write_report(found, out)
    print_report(found)


def print_report(found: Report) -> None:
    """Print tables and closing sentences."""
    console = Console(highlight=False, soft_wrap=True)
    width = None if console.is_terminal else TABLE_WIDTH
    console.print(coefficient_table(found), width=width)
    console.print(channel_table(found), width=width)
    for line in closing_lines(found):
        console.print(line)


def _feed(identification: Identification, stream: SampleStream, console: Console) -> None:
    windows = 0
    done = 0.0
    with TimeProgress('reading', None, console) as progress:
        last: tuple[Path, int] | None = None
        for path, sample in stream:
            if last is not None and last[0] == path:
                done += max(0, sample.stamp - last[1]) / SECOND
            last = path, max(sample.stamp, last[1] if last else 0)
            events = identification.feed(sample)
            windows += sum(isinstance(event, WindowUsed) for event in events)
            progress.update(done, f'{windows} steady windows')
        windows += sum(isinstance(event, WindowUsed) for event in identification.finish())
        progress.update(done, f'{windows} steady windows')
