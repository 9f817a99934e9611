# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl diagnose``."""

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
    SCHEDULER_OPTION,
)
from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.report.sentences import headline, sentences
from trawl_ros.diagnosis.report.what_to_do import what_to_do

EXIT = {'NO_DISCREPANCY': 0, 'NAMED': 10, 'AMBIGUOUS': 10, 'UNKNOWN': 10, 'NOT_TESTABLE': 11}
"""Exit codes by verdict; 1 is an input error, 2 wrong usage."""


@click.command('diagnose')
@click.argument('bags', nargs=-1, required=True, type=BAG)
@click.option(
    '--baseline', multiple=True, type=BAG, help='Bag of a tow with the gear in order. May be '
    'given several times.',
)  # fmt: skip
@click.option('--out', required=True, type=FOLDER, help='Folder for the reports and the model.')
@GEAR_OPTION
@NAMESPACE_OPTION
@SCHEDULER_OPTION
@FORCE_OPTION
@click.option(
    '--onset', is_flag=True, help='Look in each bag for effects that begin during the tow. Takes a '
    'minute or more per hour of tow.',
)  # fmt: skip
@click.pass_context
def command(
    context: click.Context,
    bags: Sequence[Path],
    baseline: Sequence[Path],
    out: Path,
    gear: str,
    namespace: str,
    scheduler: str | None,
    force: bool,
    onset: bool,
) -> None:
    """Find where the model and BAGS disagree, and name the effect that the model lacks.

    The command writes report.html, report.md, diagnosis.json and figures. If an effect is named, it
    also writes model.yaml, the gear with this effect. The exit code is 0 if no discrepancy is
    shown, 10 if one is, and 11 if these bags do not decide.
    """
    console = error_console()
    with ProgressDisplay(console) as display:
        diagnosis = trials.diagnose(
            bags,
            baseline=baseline,
            gear=gear,
            out=out,
            namespace=namespace,
            scheduler=scheduler,
            force=force,
            onset=onset,
            on_note=lambda note: console.print(note, style='yellow', markup=False),
            on_progress=display,
        )
    _print(diagnosis, out)
    context.exit(EXIT[diagnosis.verdict])


def _print(diagnosis: Diagnosis, out: Path) -> None:
    # Imported here: figures load slowly, and a refused command does not need them.
    from trawl_ros.diagnosis.report.writing import MODEL_FILE

    console = Console(highlight=False, soft_wrap=True)
    console.print(f'{diagnosis.verdict}. {headline(diagnosis)}', style='bold', markup=False)
    for sentence in sentences(diagnosis):
        console.print(sentence, markup=False)
    console.print(f'What to do now: {what_to_do(diagnosis)}', markup=False)
    console.print(f'Report: {out / "report.html"}', markup=False)
    if diagnosis.repair is not None:
        console.print(f'Gear with this effect: {out / MODEL_FILE}', markup=False)
