"""Report of a study: JSON, Markdown, a self-contained HTML page and a figure."""

import base64
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from trawl_ros.core.files import write_figure, write_json, write_text
from trawl_ros.lab.report.row import StudyRow
from trawl_ros.report.rendering import number
from trawl_ros.report.rendering import page as filled
from trawl_ros.report.style import DPI

Section = tuple[str, Sequence[StudyRow]]


@dataclass(frozen=True)
class Page:
    """Texts of a page beside its rows.

    Attributes
    ----------
    name
        Of the files, without their endings.
    title, command, method
        What was asked, how the page is made anew, and how figures were found.
    alternative, caption
        What the figure shows, in short and in full.
    """

    name: str
    title: str
    command: str
    method: str
    alternative: str
    caption: str


def write_page(folder: Path, page: Page, sections: Sequence[Section], figure: Figure) -> None:
    """Write ``<name>.json`` with all rows, ``.md``, ``.html`` and ``.png`` into a folder."""
    records = [row.record() for _, rows in sections for row in rows]
    write_json(folder / f'{page.name}.json', {'rows': records}, indent=1, ensure_ascii=False)
    picture = folder / f'{page.name}.png'
    write_figure(picture, figure, DPI)
    content: dict[str, Any] = {
        **asdict(page),
        'sections': [section for section in sections if section[1]],
        'asked': [row for _, rows in sections for row in rows if row.asked],
        'figure': picture.name,
        'data': base64.b64encode(picture.read_bytes()).decode('ascii'),
        'wanted': wanted,
    }
    for kind in ('md', 'html'):
        text = filled('trawl_ros.lab.report', f'study.{kind}', **content)
        write_text(folder / f'{page.name}.{kind}', text)


def wanted(row: StudyRow) -> str:
    """Target of a row, in words."""
    if row.least is not None and row.target is not None:
        return f'{number(row.least)} to {number(row.target)}'
    if row.least is not None:
        return f'at least {number(row.least)}'
    return '' if row.target is None else f'at most {number(row.target)}'
