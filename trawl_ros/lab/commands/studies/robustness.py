"""``trawl study robustness``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FOLDER,
    GEAR_OPTION,
)
from trawl_ros.core.files import empty_folder
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.robustness.report import REPORT as ROBUSTNESS_REPORT
from trawl_ros.lab.studies.robustness.report import write_robustness
from trawl_ros.lab.studies.robustness.study import LENGTHS, RobustnessPlan, run_robustness


@click.command('robustness')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report and of the trials.')
@GEAR_OPTION
@click.option('--around', default=RobustnessPlan.around, show_default=True,
              type=click.IntRange(12, 96), help='Meshes around the net.')  # fmt: skip
@click.option('--hours', default=RobustnessPlan.hours, show_default=True,
              type=click.IntRange(0, 100_000), help='Hours of random commands.')  # fmt: skip
@click.option('--length-m', 'lengths', multiple=True, type=click.FloatRange(100.0, 2000.0),
              default=LENGTHS, show_default=True,
              help='Warp of the changed gears; repeatable.')  # fmt: skip
@click.option('--values/--no-values', default=True, help='Tow the changed gears too.')
@click.option('--shard', nargs=2, default=(1, 1), show_default=True, type=click.IntRange(1, 1000),
              help='Part of the trials to make here, and of how many.')  # fmt: skip
@click.option('--minutes', default=60.0, show_default=True, type=click.FloatRange(0.0, 6000.0),
              help='Wall time after which no trial is begun.')  # fmt: skip
def command(
    out: Path,
    gear: str,
    around: int,
    hours: int,
    lengths: tuple[float, ...],
    values: bool,
    shard: tuple[int, int],
    minutes: float,
) -> None:
    """Change each number of a gear file by a fifth, and tow hours of random commands.

    Writes robustness.json, .md and .html. Trials that are in the folder already are not made
    again; shards may run side by side into one folder.
    """
    empty_folder(out, force=True)
    lengths = lengths if values else ()
    plan = RobustnessPlan(gear, around, hours, lengths, *shard, 60.0 * minutes)
    with stoppable(f'the trials made so far are kept in {out}') as (display, _):
        trials = run_robustness(plan, out, display)
    print_outcome(write_robustness(out, trials), out / ROBUSTNESS_REPORT)
