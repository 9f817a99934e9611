"""The report of a soak: JSON, Markdown and a figure."""

import json
import os
from pathlib import Path

from trawl_ros.benchmark.machine import cpu_model, software
from trawl_ros.reporting import DPI, templates
from trawl_ros.studies.row import Row
from trawl_ros.studies.soak import SETTLE_S, Soak
from trawl_ros.studies.soak_figure import soak_figure
from trawl_ros.studies.soak_rows import WARM_SHARE, soak_rows

JSON, REPORT, FIGURE = 'soak.json', 'soak.md', 'soak.png'


def write_soak(folder: Path, soak: Soak) -> list[Row]:
    """Write ``soak.json``, ``soak.md`` and ``soak.png`` into a folder; give the rows."""
    rows = soak_rows(soak)
    records = [row.record() for row in rows]
    text = json.dumps({'rows': records}, indent=1, ensure_ascii=False)
    (folder / JSON).write_text(text + '\n')
    soak_figure(soak.fast, soak.plan.hours).savefig(folder / FIGURE, dpi=DPI)
    page = templates('trawl_ros.studies').get_template(f'{REPORT}.j2').render(
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
    (folder / REPORT).write_text(page.rstrip() + '\n')
    return rows
