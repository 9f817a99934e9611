"""``trawl study sonar``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FORCE_OPTION,
    GEAR_OPTION,
    REPORT_OPTION,
)
from trawl_ros.core.files import empty_folder
from trawl_ros.core.progress import WorkProgress
from trawl_ros.lab.commands.outcome import stoppable
from trawl_ros.lab.studies.sonar.report import REPORT as SONAR_REPORT
from trawl_ros.lab.studies.sonar.report import write_sonar
from trawl_ros.lab.studies.sonar.study import CASES, SonarStudy


@click.command('sonar')
@REPORT_OPTION
@FORCE_OPTION
@click.option('--sweeps', default=130, show_default=True, type=click.IntRange(2, 10_000),
              help='Sweeps of each case.')  # fmt: skip
@GEAR_OPTION
@click.option('--instruments', default='default', show_default=True,
              help='File or name of instrument parameters.')  # fmt: skip
def command(out: Path, force: bool, sweeps: int, gear: str, instruments: str) -> None:
    """Set the openings that are read off the trawl sonar's image beside the truth.

    Over several states of the gear, and with fish and the seabed in view. Writes sonar.json,
    .md, .html and .png.
    """
    study = SonarStudy(sweeps, gear=gear, instruments=instruments)
    empty_folder(out, force=force)
    measured = []
    with stoppable() as (display, _):
        for done, case in enumerate(CASES):
            display(WorkProgress('measuring', done, len(CASES), 'cases', case.name))
            measured.append(study.measure(case))
    write_sonar(out, measured, sweeps)
    click.echo(f'{sweeps} sweeps of each of {len(CASES)} cases: {out / SONAR_REPORT}')
