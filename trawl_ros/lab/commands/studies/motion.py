"""``trawl study motion``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FOLDER,
    GEAR_OPTION,
    SCHEDULER_OPTION,
)
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.motion.study import REPORT as MOTION_REPORT
from trawl_ros.lab.studies.motion.study import MotionStudyPlan, run_motion_study


@click.command('motion')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report and of the trials.')
@click.option('--force', is_flag=True, help='Begin anew, whatever is there.')
@GEAR_OPTION
@click.option('--seed', default=MotionStudyPlan.seed, show_default=True,
              type=click.IntRange(0, 2**31), help='Of all trials.')  # fmt: skip
@click.option('--trials', default=MotionStudyPlan.trials, show_default=True,
              type=click.IntRange(0, 10_000), help='Trials with a finer plant.')  # fmt: skip
@click.option('--alike', default=MotionStudyPlan.alike, show_default=True,
              type=click.IntRange(0, 10_000), help='Trials with the model as plant.')  # fmt: skip
@click.option('--autotrawled', default=MotionStudyPlan.autotrawled, show_default=True,
              type=click.IntRange(0, 10_000),
              help='Trials with a finer plant under autotrawl.')  # fmt: skip
@click.option('--around', default=MotionStudyPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the model net.')  # fmt: skip
@click.option('--detectable', is_flag=True,
              help='Smallest effects that four tows show, too: a quarter of an hour.')  # fmt: skip
@click.option('--live-s', default=MotionStudyPlan.live_s, show_default=True,
              type=click.FloatRange(0.0, 7200.0),
              help='So much of the sample trial is played to both nodes in real time.')  # fmt: skip
@SCHEDULER_OPTION
def command(
    out: Path,
    force: bool,
    gear: str,
    seed: int,
    trials: int,
    alike: int,
    autotrawled: int,
    around: int,
    detectable: bool,
    live_s: float,
    scheduler: str | None,
) -> None:
    """Ask of tows in time what a fit of all of each is worth, beside that of its windows.

    Writes motion.json, .md and .html; a target that is missed is part of the report. Trials that
    are in the folder already are not made again: after Ctrl-C the same command goes on where it
    was.
    """
    plan = MotionStudyPlan(gear, seed, trials, alike, autotrawled, around, detectable, live_s)
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        rows = run_motion_study(plan, out, display, scheduler=scheduler, force=force)
    print_outcome(rows, out / MOTION_REPORT)
