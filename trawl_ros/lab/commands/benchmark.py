"""``trawl benchmark``: measure how fast things are, beside other tools."""

import time
from pathlib import Path

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from trawl_ros.cli.files import FOLDER
from trawl_ros.cli.interruption import INTERRUPTED
from trawl_ros.cli.progress import error_console
from trawl_ros.core.files import empty_folder
from trawl_ros.lab.benchmark.modules import NAMES, TITLES, check_names, measure
from trawl_ros.lab.benchmark.row import BenchmarkRow
from trawl_ros.lab.benchmark.writing import REPORT, MeasuredModule, target, write_report
from trawl_ros.report.rendering import number


@click.command('benchmark')
@click.argument('names', nargs=-1, metavar='[NAME]...')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report.')
@click.option('--force', is_flag=True, help='Write over the files of an earlier report.')
@click.option('--small', is_flag=True, help='Everything on less, in seconds.')
def command(names: tuple[str, ...], out: Path, force: bool, small: bool) -> None:
    """Measure speed and growth, and set them beside other tools.

    Runs every benchmark, or those named, one after another, and writes benchmark.json,
    benchmark.md and their figures. A target that is missed is part of the report; the exit
    code is 0 whenever the report is complete. Ctrl-C ends it without a report.
    """
    chosen = tuple(dict.fromkeys(names)) or NAMES
    check_names(chosen)
    empty_folder(out, force=force)
    console = error_console()
    measured: list[MeasuredModule] = []
    columns = (
        TextColumn('{task.description}'), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(),
    )  # fmt: skip
    try:
        with Progress(*columns, console=console) as progress:
            task = progress.add_task('', total=len(chosen))
            for name in chosen:
                progress.update(task, description=TITLES[name])
                began = time.perf_counter()
                findings = measure(name, small=small)
                measured.append(MeasuredModule(name, findings, time.perf_counter() - began))
                progress.advance(task)
                _say(console, name, findings.rows)
    except KeyboardInterrupt:
        console.print('stopped; no report is written')
        raise SystemExit(INTERRUPTED) from None
    write_report(out, measured, small=small)
    asked = [row for module in measured for row in module.findings.rows if row.target is not None]
    reached = sum(row.ok for row in asked)
    click.echo(f'{reached} of {len(asked)} targets are reached: {out / REPORT}')


def _say(console: Console, name: str, rows: tuple[BenchmarkRow, ...]) -> None:
    for row in rows:
        wanted = f', to reach {target(row)}' if row.target is not None else ''
        missed = '' if row.ok else f' MISSED: {row.note}'
        console.print(
            f'{name}: {row.what}: {number(row.value)} {row.unit}'.rstrip() + wanted + missed,
            markup=False,
        )
