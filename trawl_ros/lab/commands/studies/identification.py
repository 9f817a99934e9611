"""``trawl study identification``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FOLDER,
    GEAR_OPTION,
    SCHEDULER_OPTION,
)
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.identification.report import REPORT as IDENTIFICATION_REPORT
from trawl_ros.lab.studies.identification.report import write_identification
from trawl_ros.lab.studies.identification.study import EstimationStudyPlan as IdentificationPlan
from trawl_ros.lab.studies.identification.study import run_study


@click.command('identification')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report and of the trials.')
@click.option('--force', is_flag=True, help='Begin anew, whatever is there.')
@GEAR_OPTION
@click.option('--seed', default=IdentificationPlan.seed, show_default=True,
              type=click.IntRange(0, 2**31), help='Of all trials.')  # fmt: skip
@click.option('--coverage', default=IdentificationPlan.coverage, show_default=True,
              type=click.IntRange(1, 10_000), help='Trials with a finer plant.')  # fmt: skip
@click.option('--bound', default=IdentificationPlan.bound, show_default=True,
              type=click.IntRange(0, 10_000), help='Trials with the model as plant.')  # fmt: skip
@click.option('--mouth', default=IdentificationPlan.mouth, show_default=True,
              type=click.IntRange(0, 10_000), help='Trials with a finer mouth.')  # fmt: skip
@click.option('--around', default=IdentificationPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the model net.')  # fmt: skip
@click.option('--tows', default=IdentificationPlan.tows, show_default=True,
              type=click.IntRange(1, IdentificationPlan.tows), help='In a trial.')  # fmt: skip
@SCHEDULER_OPTION
@click.option('--small', is_flag=True, help='Trials only: neither a planned trial, nor a replay, '
              'nor the node in real time.')  # fmt: skip
@click.option('--live-s', default=IdentificationPlan.live_s, show_default=True,
              type=click.FloatRange(0.0, 3600.0),
              help='Wall time of the node in real time; 0 leaves it out.')  # fmt: skip
def command(
    out: Path,
    force: bool,
    gear: str,
    seed: int,
    coverage: int,
    bound: int,
    mouth: int,
    around: int,
    tows: int,
    scheduler: str | None,
    small: bool,
    live_s: float,
) -> None:
    """Ask of many trials what the intervals and predictions of identification are worth.

    Writes identification.json, .md, .html and .png; a target that is missed is part of the
    report. Trials that are in the folder already are not made again: after
    Ctrl-C the same command goes on where it was.
    """
    plan = IdentificationPlan(gear, seed, coverage, bound, mouth, around, tows, live_s)
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        found = run_study(plan, out, display, scheduler=scheduler, force=force, small=small)
    rows = write_identification(out, plan, found.sections, found.figure)
    print_outcome(rows, out / IDENTIFICATION_REPORT)
