"""``trawl study counters``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FILE,
    FORCE_OPTION,
    REPORT_OPTION,
)
from trawl_ros.core.files import empty_folder, made_folder
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.counters.study import REPORT as COUNTERS_REPORT
from trawl_ros.lab.studies.counters.study import SEED as COUNTERS_SEED
from trawl_ros.lab.studies.counters.study import read_table, run_counters


@click.command('counters')
@click.option('--table', required=True, type=FILE, help='CSV of true wire and what both counters '
              'showed, in fathoms: wire_out_fm, winch_stbd_fm, winch_port_fm.')  # fmt: skip
@REPORT_OPTION
@click.option('--seed', default=COUNTERS_SEED, show_default=True, type=click.IntRange(0, 2**31),
              help='Of plant, noise and biases.')  # fmt: skip
@FORCE_OPTION
def command(table: Path, out: Path, seed: int, force: bool) -> None:
    """Diagnose a simulated trial whose winch counters err as measured ones did.

    With tows of a baseline and without. Writes counters.json, .md, .html and .png.
    """
    known = read_table(table)
    made_folder(empty_folder(out, force=force))
    with stoppable() as (display, _):
        rows = run_counters(known, out, display, seed)
    print_outcome(rows, out / COUNTERS_REPORT)
