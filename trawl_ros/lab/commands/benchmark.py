"""``trawl benchmark``: measure how fast things are, beside other tools."""

import time
from pathlib import Path

import click

from trawl_ros.cli.options import FORCE_OPTION, REPORT_OPTION
from trawl_ros.core.files import empty_folder
from trawl_ros.core.progress import WorkProgress
from trawl_ros.lab.benchmark.modules import NAMES, TITLES, check_names, measure
from trawl_ros.lab.benchmark.writing import NAME, MeasuredModule, write_benchmark
from trawl_ros.lab.commands.outcome import print_missed, print_reached, stoppable


@click.command('benchmark')
@click.argument('names', nargs=-1, metavar='[NAME]...')
@REPORT_OPTION
@FORCE_OPTION
@click.option('--small', is_flag=True, help='Everything on less, in seconds.')
def command(names: tuple[str, ...], out: Path, force: bool, small: bool) -> None:
    """Measure speed and growth, and set them beside other tools.

    Runs every benchmark, or those named, one after another, and writes benchmark.json,
    .md, .html and their figures. A target that is missed is part of the report; the exit code
    is 0 whenever the report is complete. Ctrl-C ends it without a report.
    """
    chosen = tuple(dict.fromkeys(names)) or NAMES
    check_names(chosen)
    empty_folder(out, force=force)
    measured: list[MeasuredModule] = []
    with stoppable() as (display, console):
        for number, name in enumerate(chosen):
            display(WorkProgress('measuring', number, len(chosen), 'modules', TITLES[name]))
            began = time.perf_counter()
            findings = measure(name, small=small)
            measured.append(MeasuredModule(name, findings, time.perf_counter() - began))
            for row in findings.rows:
                wanted = f', asked for {row.wanted}' if row.target is not None else ''
                console.print(f'{name}: {row.what}: {row.figure}{wanted}', markup=False)
            print_missed(findings.rows, console)
    print_reached(write_benchmark(out, measured, small=small), out / f'{NAME}.md')
