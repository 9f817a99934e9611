"""``trawl study chaos``."""

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
from trawl_ros.lab.studies.chaos.plan import Plan as ChaosPlan
from trawl_ros.lab.studies.chaos.report import REPORT as CHAOS_REPORT
from trawl_ros.lab.studies.chaos.report import write_chaos
from trawl_ros.lab.studies.chaos.study import run_chaos


@click.command('chaos')
@REPORT_OPTION
@FORCE_OPTION
@click.option('--hours', default=ChaosPlan.hours, show_default=True,
              type=click.FloatRange(0.02, 24.0), help='Time at sea, towed twice.')  # fmt: skip
@click.option('--kills', default=ChaosPlan.kills, show_default=True,
              type=click.IntRange(0, 1000), help='Of the recorder at full load.')  # fmt: skip
@click.option('--seed', default=ChaosPlan.seed, show_default=True,
              type=click.IntRange(0, 2**31), help='Of what happens when.')  # fmt: skip
@GEAR_OPTION
def command(out: Path, force: bool, hours: float, kills: int, seed: int, gear: str) -> None:
    """Stop and kill nodes, crowd their topics, fill the disk, and see what is left of a tow.

    Every node is a process of its own. Writes chaos.json, .md, .html and .png; a target that is
    missed is part of the report. Ctrl-C ends it early, and the report says so.
    """
    load_gear(gear)
    plan = ChaosPlan(hours, kills, seed, gear)
    empty_folder(out, force=force)
    with until_stopped() as stopped:
        with ProgressDisplay(error_console()) as display:
            rows = write_chaos(out, run_chaos(plan, out, display, stopped))
        print_outcome(rows, out / CHAOS_REPORT)
