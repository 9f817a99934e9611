# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl benchmark``: measure the speed, compare it with other codes, and write the report."""

import time
from collections.abc import Mapping
from pathlib import Path

import click

from trawl_ros.cli.options import FORCE_OPTION, REPORT_OPTION
from trawl_ros.core.files import empty_folder
from trawl_ros.core.progress import WorkProgress
from trawl_ros.lab.benchmark.modules import NAMES, TITLES, check_names, measure
from trawl_ros.lab.commands.outcome import print_missed, print_reached, stoppable
from trawl_ros.lab.report.machine import blas_threads, cpu_model, software
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Page, Section, write_page
from trawl_ros.report.pictures import draw

NAME, COMMAND = 'benchmark', 'trawl benchmark'
SMALL = 'It ran in its small version, which shows that it runs and says nothing about speed. '


def measured_section(name: str, folder: Path, *, quick: bool) -> Section:
    """Run one module and draw its figures into a folder."""
    began = time.perf_counter()
    findings = measure(name, quick=quick)
    seconds = time.perf_counter() - began
    return Section(
        TITLES[name],
        findings.rows,
        draw(folder, findings.drawings, f'{NAME}/{name}_'),
        text=findings.text,
        command=f'{COMMAND} {name}',
        seconds=seconds,
    )


def write_benchmark(
    folder: Path, sections: Mapping[str, Section], *, quick: bool
) -> list[MeasuredValue]:
    """Write ``benchmark.json``, ``.md`` and ``.html`` into a folder; return the rows."""
    versions = ', '.join(f'{name} {version}' for name, version in software().items())
    page = Page(
        name=NAME,
        title='Benchmark',
        command=COMMAND,
        method=(SMALL if quick else '')
        + f'Everything ran one after another in one process, on {cpu_model()}, with {versions}; '
        f'threads of BLAS: {blas_threads()}. Times are CPU times of the process, all threads '
        'together, and medians over repeats unless it says that something ran once; where it says '
        'wall, they are wall-clock times, which other work on the machine lengthens.',
    )
    return write_page(folder, page, [sections[name] for name in NAMES if name in sections])


@click.command('benchmark')
@click.argument('names', nargs=-1, metavar='[NAME]...')
@REPORT_OPTION
@FORCE_OPTION
@click.option(
    '--quick', is_flag=True, help='Small version of every benchmark, which takes seconds.'
)
def command(names: tuple[str, ...], out: Path, force: bool, quick: bool) -> None:
    """Measure speed and its growth with the net, and compare it with other codes.

    Runs every benchmark, or those named, one after another, and writes benchmark.json,
    .md, .html and their figures. The report lists missed targets; the exit code is 0 if the
    report is complete. Ctrl-C ends the command without a report.
    """
    chosen = tuple(dict.fromkeys(names)) or NAMES
    check_names(chosen)
    empty_folder(out, force=force)
    sections: dict[str, Section] = {}
    with stoppable() as (display, console):
        for number, name in enumerate(chosen):
            display(WorkProgress('measuring', number, len(chosen), 'modules', TITLES[name]))
            sections[name] = measured_section(name, out, quick=quick)
            for row in sections[name].rows:
                wanted = f', asked for {row.wanted}' if row.target is not None else ''
                console.print(f'{name}: {row.what}: {row.figure}{wanted}', markup=False)
            print_missed(sections[name].rows, console)
    print_reached(write_benchmark(out, sections, quick=quick), out / f'{NAME}.md')
