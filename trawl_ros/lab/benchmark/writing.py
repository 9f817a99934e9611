"""Benchmark report as JSON, Markdown and HTML, with its figures."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.core.files import finite
from trawl_ros.lab.benchmark.modules import NAMES, TITLES
from trawl_ros.lab.report.machine import blas_threads, cpu_model, software
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Findings, Page, Section, write_page
from trawl_ros.report.pictures import draw

NAME, COMMAND = 'benchmark', 'trawl benchmark'
SMALL = 'It ran in its small version, which shows that it runs and says nothing about speed. '


@dataclass(frozen=True)
class MeasuredModule:
    """Module that was run, with its ``seconds`` of wall clock."""

    name: str
    findings: Findings
    seconds: float


def write_benchmark(
    folder: Path, measured: Sequence[MeasuredModule], *, small: bool
) -> list[MeasuredValue]:
    """Write ``benchmark.json``, ``.md``, ``.html`` and figures into a folder; return the rows."""
    ordered = sorted(measured, key=lambda module: NAMES.index(module.name))
    versions = ', '.join(f'{name} {version}' for name, version in software().items())
    page = Page(
        name=NAME,
        title='Benchmark',
        command=COMMAND,
        method=(SMALL if small else '')
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
    """Row as plain values; what could not be measured is null."""
    return {
        'what': row.what,
        'value': finite(row.value),
        'unit': row.unit,
        'target': None if row.target is None else row.target.expected,
        'ok': row.ok,
        'note': row.note,
    }
