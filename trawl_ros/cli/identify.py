# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl identify``."""

from collections.abc import Sequence
from pathlib import Path

import click
from rich.console import Console

from trawl_ros.api import trials
from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.options import (
    BAG,
    FOLDER,
    FORCE_OPTION,
    GEAR_OPTION,
    NAMESPACE_OPTION,
    SCENARIO,
    SCHEDULER_OPTION,
    UNITS_OPTION,
)
from trawl_ros.core.display_units import METRIC, DisplayUnits
from trawl_ros.estimation.report.report import Report
from trawl_ros.estimation.report.table import (
    channel_table,
    closing_lines,
    coefficient_table,
    opening_line,
    sensor_table,
)

TABLE_COLUMNS = 100


@click.command('identify')
@click.argument('bags', nargs=-1, required=True, type=BAG)
@click.option('--out', required=True, type=FOLDER, help='Folder for report, JSON and figures.')
@GEAR_OPTION
@click.option(
    '--truth', type=SCENARIO, help='Scenario that made the bags; its coefficients are compared '
    'with the estimates.',
)  # fmt: skip
@click.option(
    '--no-prior',
    is_flag=True,
    help='Fit the steady windows alone, without the prior of the gear file, within its bounds.',
)
@click.option(
    '--net', is_flag=True, help='Also estimate drag and weight of the net; otherwise those of the '
    'gear file are kept.',
)  # fmt: skip
@click.option(
    '--motion/--steady', default=True, show_default=True, help='Fit the whole tow, hauling and '
    'veering included, which takes a minute per hour of tow; or only its steady parts, in a '
    'quarter of that.',
)  # fmt: skip
@UNITS_OPTION
@NAMESPACE_OPTION
@SCHEDULER_OPTION
@FORCE_OPTION
def command(
    bags: Sequence[Path],
    out: Path,
    gear: str,
    truth: Path | None,
    no_prior: bool,
    net: bool,
    motion: bool,
    units: DisplayUnits,
    namespace: str,
    scheduler: str | None,
    force: bool,
) -> None:
    """Estimate the hydrodynamic coefficients of the doors from BAGS, one bag per tow.

    The command writes report.html, identification.json and figures. For cross-validation each tow
    is left out in turn and predicted from the others; with a single tow, its steady states are left
    out. If you stop the command during the fit of the whole tow, the results of the steady windows
    remain in the folder.
    """
    console = error_console()
    with ProgressDisplay(console) as display:
        report = trials.identify(
            bags,
            gear=gear,
            out=out,
            truth=truth,
            prior=not no_prior,
            net=net,
            motion=motion,
            namespace=namespace,
            scheduler=scheduler,
            force=force,
            on_note=lambda note: console.print(note, style='yellow', markup=False),
            on_progress=display,
        )
    print_report(report, units)


def print_report(report: Report, units: DisplayUnits = METRIC) -> None:
    """Print the verdict, tables and closing sentences."""
    console = Console(highlight=False, soft_wrap=True)
    width = None if console.is_terminal else TABLE_COLUMNS
    console.print(opening_line(report), style='bold')
    if report.sensors:
        console.print(sensor_table(report.sensors), width=width)
    if not report.paired:
        console.print(coefficient_table(report), width=width)
    if report.windows:
        console.print(channel_table(report, units), width=width)
    for line in closing_lines(report):
        console.print(line, markup=False)
