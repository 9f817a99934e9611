"""``trawl study sailing``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FORCE_OPTION,
    GEAR_OPTION,
    REPORT_OPTION,
)
from trawl_ros.core.files import empty_folder
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.sailing.report import REPORT as SAILING_REPORT
from trawl_ros.lab.studies.sailing.report import write_sailing
from trawl_ros.lab.studies.sailing.study import SailingPlan, run_sailing


@click.command('sailing')
@REPORT_OPTION
@FORCE_OPTION
@GEAR_OPTION
@click.option('--around', default=SailingPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the net.')  # fmt: skip
@click.option('--hours', default=SailingPlan.hours, show_default=True,
              type=click.FloatRange(0.5, 48.0), help='Time at sea of each course.')  # fmt: skip
@click.option('--boards', default=SailingPlan.boards, show_default=True,
              type=click.IntRange(1, 1000), help='Random boards.')  # fmt: skip
@click.option('--seed', default=SailingPlan.seed, show_default=True, type=click.IntRange(0))
def command(
    out: Path, force: bool, gear: str, around: int, hours: float, boards: int, seed: int
) -> None:
    """Sail trials that run themselves, beside a planned trial and the paper's sweep.

    Writes sailing.json, .md and .html.
    """
    empty_folder(out, force=force)
    plan = SailingPlan(gear, around, hours, boards, seed)
    with stoppable() as (display, _):
        towed = run_sailing(plan, display)
    print_outcome(write_sailing(out, plan, towed), out / SAILING_REPORT)
