"""``trawl study soak``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FORCE_OPTION,
    GEAR_OPTION,
    REPORT_OPTION,
)
from trawl_ros.cli.progress import ProgressDisplay, error_console
from trawl_ros.core.files import empty_folder
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.commands.outcome import print_outcome, until_stopped
from trawl_ros.lab.studies.soak.report import REPORT, write_soak
from trawl_ros.lab.studies.soak.study import SoakPlan, run_soak


@click.command('soak')
@REPORT_OPTION
@FORCE_OPTION
@click.option(
    '--hours',
    default=24.0,
    show_default=True,
    type=click.FloatRange(0.005, 48.0),
    help='Time at sea, towed as fast as it goes.',
)
@GEAR_OPTION
@click.option('--real-time-s', default=60.0, show_default=True, type=click.FloatRange(0.0, 3600.0),
              help='Wall time in real time, for the share of a core; 0 leaves it out.')  # fmt: skip
@click.option('--coarse', is_flag=True, help='Tow at sea with a coarse net, which is quicker.')
def command(
    out: Path, force: bool, hours: float, gear: str, real_time_s: float, coarse: bool
) -> None:
    """Tow for a day through the ROS graph, and watch memory, delay and processor time.

    Every node is a process of its own. Writes soak.json, .md, .html and .png; a target that
    is missed is part of the report. Ctrl-C ends the tow early, and the report says so.
    """
    load_gear(gear)
    plan = SoakPlan(hours, gear, real_time_s, coarse=coarse)
    empty_folder(out, force=force)
    with until_stopped() as stopped:
        with ProgressDisplay(error_console()) as display:
            rows = write_soak(out, run_soak(plan, out, display, stopped))
        print_outcome(rows, out / REPORT)
