"""``trawl study flume``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FILE,
    FORCE_OPTION,
    REPORT_OPTION,
)
from trawl_ros.core.files import empty_folder, made_folder
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.flume.states import read_states
from trawl_ros.lab.studies.flume.study import REPORT as FLUME_REPORT
from trawl_ros.lab.studies.flume.study import run_flume


@click.command('flume')
@click.option('--table', required=True, type=FILE, help='CSV of states of a net in a flume tank.')
@REPORT_OPTION
@FORCE_OPTION
def command(table: Path, out: Path, force: bool) -> None:
    """Set a net that is held in a flume tank beside the model.

    Writes flume.json, .md, .html and .png.
    """
    states = read_states(table)
    made_folder(empty_folder(out, force=force))
    with stoppable() as (display, _):
        rows = run_flume(states, out, display)
    print_outcome(rows, out / FLUME_REPORT)
