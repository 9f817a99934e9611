"""``trawl validate``: check the model's claims and write the report."""

from pathlib import Path

import click
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from trawl_ros.cli.files import FOLDER
from trawl_ros.cli.progress import error_console
from trawl_ros.core.files import empty_folder
from trawl_ros.lab.validation.cases import NAMES
from trawl_ros.lab.validation.run import Finished, run_cases
from trawl_ros.lab.validation.writing import write_report
from trawl_ros.report.rendering import number


@click.command('validate')
@click.argument('cases', nargs=-1, metavar='[CASE]...')
@click.option('--out', required=True, type=FOLDER, help='Folder of the report.')
@click.option('--force', is_flag=True, help='Write over the files of an earlier report.')
@click.option('--small', is_flag=True, help='Each case on less, in seconds.')
@click.option(
    '--workers', default=2, show_default=True, type=click.IntRange(1, 64), help='Processes.'
)
def command(cases: tuple[str, ...], out: Path, force: bool, small: bool, workers: int) -> None:
    """Check the model against closed forms, the paper and other programs.

    Runs every CASE, or those named, and writes validation.json, report.html, report.md and
    their figures. A check that does not hold is part of the report; the exit code is 0
    whenever the report is complete.
    """
    names = tuple(dict.fromkeys(cases)) or NAMES
    empty_folder(out, force=force)
    console = error_console()
    finished: list[Finished] = []
    columns = (
        TextColumn('validating'), BarColumn(), MofNCompleteColumn(), TextColumn('cases'),
        TimeElapsedColumn(),
    )  # fmt: skip
    with Progress(*columns, console=console) as progress:
        task = progress.add_task('', total=len(names))
        for case in run_cases(names, out, small=small, workers=workers):
            finished.append(case)
            progress.advance(task)
            held = sum(check.ok for check in case.checks)
            console.print(
                f'{case.name}: {held} of {len(case.checks)} checks hold, {case.seconds:.0f} s'
            )
            for check in case.checks:
                if not check.ok:
                    measured = f'{number(check.measured)} {check.unit}'.strip()
                    console.print(f'  {check.what}: {measured}. {check.note}')
    write_report(out, finished, small=small)
    held = sum(check.ok for case in finished for check in case.checks)
    total = sum(len(case.checks) for case in finished)
    click.echo(f'{held} of {total} checks hold: {out / "report.html"}')
