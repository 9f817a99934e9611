"""``trawl study instruments``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FILE,
    FOLDER,
    FORCE_OPTION,
    REPORT_OPTION,
)
from trawl_ros.core.files import empty_folder
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.lab.commands.outcome import print_outcome, stoppable
from trawl_ros.lab.studies.instruments.calibrations import read_calibrations
from trawl_ros.lab.studies.instruments.report import REPORT as INSTRUMENTS_REPORT
from trawl_ros.lab.studies.instruments.report import FurtherTables, write_instruments
from trawl_ros.lab.studies.instruments.study import SEED as INSTRUMENTS_SEED
from trawl_ros.lab.studies.instruments.study import run_instruments
from trawl_ros.lab.studies.instruments.wire_steps import read_steps


@click.command('instruments')
@click.option('--table', 'table', type=FILE, required=True,
              help='Readings of a survey, CSV packed by gzip: HAUL, t, CABINET_SENSOR_FLAG, VALUE, '
              'DATUM_CODE.')  # fmt: skip
@click.option('--beside', type=FOLDER,
              help='Folder with further tables: a sea experiment with stepped lengths of wire, '
              'counters beside marks on the wire, and distances on a dock.')  # fmt: skip
@click.option('--instruments', default='default', show_default=True,
              help='File or name of instrument parameters.')  # fmt: skip
@REPORT_OPTION
@click.option('--seed', default=INSTRUMENTS_SEED, show_default=True,
              type=click.IntRange(0, 2**31), help='Of the simulated readings.')  # fmt: skip
@FORCE_OPTION
def command(
    table: Path, beside: Path | None, instruments: str, out: Path, seed: int, force: bool
) -> None:
    """Set simulated range sensors beside those of a survey, haul by haul.

    Writes instruments.json, .md, .html and figures; a target that is missed is part of the report.
    """
    ship = load_instruments(instruments)
    further = (
        None if beside is None else FurtherTables(read_steps(beside), read_calibrations(beside))
    )
    empty_folder(out, force=force)
    with stoppable() as (display, _):
        found = run_instruments(table, ship, display, seed)
    rows = write_instruments(out, found, instruments, seed, further)
    print_outcome(rows, out / INSTRUMENTS_REPORT)
