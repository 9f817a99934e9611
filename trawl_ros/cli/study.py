"""``trawl study``: long runs of the whole chain."""

from pathlib import Path

import click

from trawl_ros.cli.files import FOLDER
from trawl_ros.cli.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.progress import TimeProgress, error_console
from trawl_ros.files import empty_folder
from trawl_ros.gear.load import load_gear
from trawl_ros.reporting import number
from trawl_ros.studies.soak import Plan, run_soak
from trawl_ros.studies.soak_report import REPORT, write_soak


@click.group('study')
def command() -> None:
    """Run the whole chain for long, and report what that shows."""


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
def soak(out: Path, force: bool, hours: float, gear: str, real_time_s: float) -> None:
    """Tow for a day through the ROS graph, and watch memory, delay and processor time.

    Every node is a process of its own. Writes soak.json, soak.md and soak.png; a target that
    is missed is part of the report. Ctrl-C ends the tow early, and the report says so.
    """
    load_gear(gear)
    empty_folder(out, force=force)
    console = error_console()
    with Interruption() as interruption:
        seen = run_soak(
            Plan(hours, gear, real_time_s),
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
