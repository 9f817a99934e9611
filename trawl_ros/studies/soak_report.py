"""Report of a soak: JSON, Markdown and a figure."""

import os
from pathlib import Path

from trawl_ros.benchmark.machine import cpu_model, software
from trawl_ros.files import write_figure, write_json, write_text
from trawl_ros.reporting import DPI, page
from trawl_ros.studies.row import Row
from trawl_ros.studies.soak import SETTLE_S, Soak
from trawl_ros.studies.soak_figure import soak_figure
from trawl_ros.studies.soak_rows import WARM_SHARE, soak_rows

JSON, REPORT, FIGURE = 'soak.json', 'soak.md', 'soak.png'


def write_soak(folder: Path, soak: Soak) -> list[Row]:
    """Write ``soak.json``, ``soak.md`` and ``soak.png`` into a folder; return the rows."""
    rows = soak_rows(soak)
    records = [row.record() for row in rows]
    write_json(folder / JSON, {'rows': records}, indent=1, ensure_ascii=False)
    write_figure(folder / FIGURE, soak_figure(soak.fast, soak.plan.hours), DPI)
    text = page(
        'trawl_ros.studies',
        REPORT,
        rows=rows,
        asked=[row for row in rows if row.target is not None],
        plan=soak.plan,
        warm_share=WARM_SHARE,
        settle_s=SETTLE_S,
        cpu=cpu_model(),
        cores=os.cpu_count(),
        software=software(),
        figure=FIGURE,
    )  # fmt: skip
    write_text(folder / REPORT, text)
    return rows
