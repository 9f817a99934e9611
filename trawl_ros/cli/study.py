"""``trawl study``: what takes long to find out, measured and reported."""

from pathlib import Path

import click
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from trawl_ros.cli.files import FOLDER
from trawl_ros.cli.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.progress import TimeProgress, error_console
from trawl_ros.files import empty_folder
from trawl_ros.gear.load import load_gear
from trawl_ros.reporting import number
from trawl_ros.studies.soak import Plan, run_soak
from trawl_ros.studies.soak_report import REPORT, write_soak
from trawl_ros.studies.sonar import CASES, SonarStudy
from trawl_ros.studies.sonar_report import REPORT as SONAR_REPORT
from trawl_ros.studies.sonar_report import write_sonar


@click.group('study')
def command() -> None:
    """Measure what takes long to find out, and report it."""


@command.command('soak')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report.')
@click.option('--force', is_flag=True, help='Write over the files of an earlier report.')
@click.option(
    '--hours',
    default=24.0,
    show_default=True,
    type=click.FloatRange(0.005, 48.0),
    help='Time at sea, towed as fast as it goes.',
)
@click.option('--gear', default='kaifuha', show_default=True, help='Gear file or name.')
@click.option('--real-time-s', default=60.0, show_default=True, type=click.FloatRange(0.0, 3600.0),
              help='Wall time in real time, for the share of a core; 0 leaves it out.')  # fmt: skip
@click.option('--coarse', is_flag=True, help='Tow at sea with a coarse net, which is quicker.')
def soak(out: Path, force: bool, hours: float, gear: str, real_time_s: float, coarse: bool) -> None:
    """Tow for a day through the ROS graph, and watch memory, delay and processor time.

    Every node is a process of its own. Writes soak.json, soak.md and soak.png; a target that
    is missed is part of the report. Ctrl-C ends the tow early, and the report says so.
    """
    load_gear(gear)
    empty_folder(out, force=force)
    console = error_console()
    with Interruption() as interruption:
        seen = run_soak(
            Plan(hours, gear, real_time_s, coarse=coarse),
            out,
            lambda title, total_s: TimeProgress(title, total_s, console),
            lambda: interruption.requested,
        )
        rows = write_soak(out, seen)
    asked = [row for row in rows if row.target is not None]
    for row in asked:
        if not row.ok:
            console.print(f'missed: {row.what}: {number(row.value)} {row.unit}', markup=False)
    reached = sum(row.ok for row in asked)
    click.echo(f'{reached} of {len(asked)} targets are reached: {out / REPORT}')
    if interruption.requested:
        raise SystemExit(INTERRUPTED)


@command.command('sonar')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report.')
@click.option('--force', is_flag=True, help='Write over the files of an earlier report.')
@click.option('--sweeps', default=130, show_default=True, type=click.IntRange(2, 10_000),
              help='Sweeps of each case.')  # fmt: skip
@click.option('--gear', default='kaifuha', show_default=True, help='Gear file or name.')
@click.option('--instruments', default='default', show_default=True,
              help='File or name of instrument parameters.')  # fmt: skip
def sonar(out: Path, force: bool, sweeps: int, gear: str, instruments: str) -> None:
    """Set the openings that are read off the trawl sonar's image beside the truth.

    Over several states of the gear, and with fish and the seabed in view. Writes sonar.json,
    sonar.md and sonar.png.
    """
    study = SonarStudy(sweeps, gear=gear, instruments=instruments)
    empty_folder(out, force=force)
    console = error_console()
    columns = TextColumn('{task.description}'), BarColumn(), MofNCompleteColumn()
    measured = []
    try:
        with Progress(*columns, console=console) as progress:
            task = progress.add_task('', total=len(CASES))
            for case in CASES:
                progress.update(task, description=case.name)
                measured.append(study.measure(case))
                progress.advance(task)
    except KeyboardInterrupt:
        console.print('stopped; no report is written')
        raise SystemExit(INTERRUPTED) from None
    write_sonar(out, measured, sweeps)
    click.echo(f'{sweeps} sweeps of each of {len(CASES)} cases: {out / SONAR_REPORT}')
