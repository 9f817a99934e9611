# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl benchmark``: measure the speed, compare it with other codes, and write the report."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from trawl_ros.cli.options import FORCE_OPTION, REPORT_OPTION
from trawl_ros.core.files import empty_folder, finite
from trawl_ros.core.progress import WorkProgress
from trawl_ros.lab.benchmark.modules import NAMES, TITLES, check_names, measure
from trawl_ros.lab.commands.outcome import print_missed, print_reached, stoppable
from trawl_ros.lab.report.machine import blas_threads, cpu_model, software
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Findings, Page, Section, write_page
from trawl_ros.report.pictures import draw

NAME, COMMAND = 'benchmark', 'trawl benchmark'
SMALL = 'It ran in its small version, which shows that it runs and says nothing about speed. '


@dataclass(frozen=True)
class MeasuredModule:
    """Findings of one module, with its wall-clock time, s."""

    name: str
    findings: Findings
    seconds: float


def write_benchmark(
    folder: Path, measured: Sequence[MeasuredModule], *, quick: bool
) -> list[MeasuredValue]:
    """Write ``benchmark.json``, ``.md``, ``.html`` and figures into a folder; return the rows."""
    ordered = sorted(measured, key=lambda module: NAMES.index(module.name))
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
    sections = [
        Section(
            TITLES[module.name],
            module.findings.rows,
            draw(folder, module.findings.drawings, f'{NAME}/{module.name}_'),
            text=module.findings.text,
            command=f'{COMMAND} {module.name}',
            seconds=module.seconds,
        )
        for module in ordered
    ]
    rows = [row_record(row) for section in sections for row in section.rows]
    return write_page(folder, page, sections, record={'rows': rows})


def row_record(row: MeasuredValue) -> dict[str, object]:
    """Return a row as plain values; unmeasured values are null."""
    return {
        'what': row.what,
        'value': finite(row.value),
        'unit': row.unit,
        'target': None if row.target is None else row.target.expected,
        'ok': row.ok,
        'note': row.note,
    }


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
    measured: list[MeasuredModule] = []
    with stoppable() as (display, console):
        for number, name in enumerate(chosen):
            display(WorkProgress('measuring', number, len(chosen), 'modules', TITLES[name]))
            began = time.perf_counter()
            findings = measure(name, quick=quick)
            measured.append(MeasuredModule(name, findings, time.perf_counter() - began))
            for row in findings.rows:
                wanted = f', asked for {row.wanted}' if row.target is not None else ''
                console.print(f'{name}: {row.what}: {row.figure}{wanted}', markup=False)
            print_missed(findings.rows, console)
    print_reached(write_benchmark(out, measured, quick=quick), out / f'{NAME}.md')
