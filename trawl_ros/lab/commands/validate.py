# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl validate``: check the model's claims and write the report."""

from pathlib import Path

import click

from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.options import FORCE_OPTION, REPORT_OPTION
from trawl_ros.lab.commands.outcome import print_missed, print_reached
from trawl_ros.lab.report.page import Section
from trawl_ros.lab.validation.cases import case_of_figure
from trawl_ros.lab.validation.run import validate


@click.command('validate')
@click.argument('cases', nargs=-1, metavar='[CASE]...')
@click.option(
    '--figure', 'figures', multiple=True, type=int, metavar='N', help='Case that remakes figure N '
    'of the founding paper, 4 to 16. May be given several times.',
)  # fmt: skip
@REPORT_OPTION
@FORCE_OPTION
@click.option('--quick', is_flag=True, help='Small version of every case, which takes seconds.')
@click.option(
    '--workers',
    default=2,
    show_default=True,
    type=click.IntRange(1, 64),
    help='Number of processes that run cases.',
)
def command(
    cases: tuple[str, ...],
    figures: tuple[int, ...],
    out: Path,
    force: bool,
    quick: bool,
    workers: int,
) -> None:
    """Check the model against closed forms, the paper and other programs.

    Runs every CASE, or those named, and writes validation.json, report.html, report.md and
    their figures. The report lists checks that do not hold; the exit code is 0 if the
    report is complete.
    """
    console = error_console()
    cases = (*cases, *map(case_of_figure, figures))

    def show(case: Section) -> None:
        held, total = sum(row.ok for row in case.rows), len(case.rows)
        console.print(f'{case.name}: {held} of {total} checks hold, {case.seconds:.0f} s')
        print_missed(case.rows, console)
        if not total:
            console.print(case.text, markup=False)

    with ProgressDisplay(console) as display:
        finished = validate(
            out,
            cases,
            quick=quick,
            workers=workers,
            force=force,
            on_case=show,
            on_progress=display,
        )
    print_reached([row for case in finished for row in case.rows], out / 'report.html')
