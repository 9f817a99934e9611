"""Benchmark report as JSON and Markdown, with its figures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.core.files import write_figure, write_json, write_text
from trawl_ros.lab.benchmark.findings import Findings
from trawl_ros.lab.benchmark.modules import NAMES, TITLES
from trawl_ros.lab.benchmark.row import BenchmarkRow
from trawl_ros.lab.report.machine import blas_threads, cpu_model, software
from trawl_ros.report.rendering import DPI, number, page

JSON, REPORT = 'benchmark.json', 'benchmark.md'

FIGURES = 'benchmark'
"""Folder of the figures, beside the report."""


@dataclass(frozen=True)
class MeasuredModule:
    """Module that was run, with its ``seconds`` of wall clock."""

    name: str
    findings: Findings
    seconds: float


def write_report(folder: Path, measured: Sequence[MeasuredModule], *, small: bool) -> None:
    """Write ``benchmark.json``, ``benchmark.md`` and the figures into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    ordered = sorted(measured, key=lambda module: NAMES.index(module.name))
    rows = [row for module in ordered for row in module.findings.rows]
    records = [row_record(row) for row in rows]
    write_json(folder / JSON, {'rows': records}, indent=1, ensure_ascii=False)
    text = page(
        'trawl_ros.lab.benchmark',
        REPORT,
        target=target,
        modules=[(TITLES[module.name], module, _draw(folder, module)) for module in ordered],
        asked=sum(row.target is not None for row in rows),
        reached=sum(row.target is not None and row.ok for row in rows),
        missed=[row for row in rows if not row.ok],
        cpu=cpu_model(),
        software=software(),
        blas_threads=blas_threads(),
        small=small,
    )
    write_text(folder / REPORT, text)


def _draw(folder: Path, module: MeasuredModule) -> list[tuple[str, str]]:
    """File, relative to the report, and caption of each figure."""
    pictures = []
    for drawing in module.findings.drawings:
        file = f'{FIGURES}/{module.name}_{drawing.name}.png'
        (folder / FIGURES).mkdir(exist_ok=True)
        write_figure(folder / file, drawing.figure, DPI)
        pictures.append((file, drawing.caption))
    return pictures


def row_record(row: BenchmarkRow) -> dict[str, object]:
    """Row as plain values; what could not be measured is null."""
    return {
        'what': row.what,
        'value': row.value if math.isfinite(row.value) else None,
        'unit': row.unit,
        'target': row.target,
        'ok': bool(row.ok),
        'note': row.note,
    }


def target(row: BenchmarkRow) -> str:
    """Target of a row in symbols."""
    if row.target is None:
        return ''
    sign = '≥' if row.rule == 'at_least' else '≤'
    return f'{sign} {number(row.target)} {row.unit}'.rstrip()
