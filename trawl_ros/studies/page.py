"""The page of a study: JSON, Markdown, a self-contained HTML page and a figure."""

import base64
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from trawl_ros.plots.style import DPI
from trawl_ros.reporting import number, templates
from trawl_ros.studies.row import Row

Section = tuple[str, Sequence[Row]]


@dataclass(frozen=True)
class Page:
    """What a page says beside its rows.

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
    text = json.dumps({'rows': records}, indent=1, ensure_ascii=False)
    (folder / f'{page.name}.json').write_text(text + '\n', encoding='utf-8')
    picture = BytesIO()
    figure.savefig(picture, format='png', dpi=DPI)
    (folder / f'{page.name}.png').write_bytes(picture.getvalue())
    content: dict[str, Any] = {
        **asdict(page),
        'sections': [section for section in sections if section[1]],
        'asked': [row for _, rows in sections for row in rows if row.asked],
        'figure': f'{page.name}.png',
        'data': base64.b64encode(picture.getvalue()).decode('ascii'),
    }
    environment = templates('trawl_ros.studies')
    environment.filters['wanted'] = wanted
    for kind in ('md', 'html'):
        text = environment.get_template(f'study.{kind}.j2').render(content)
        (folder / f'{page.name}.{kind}').write_text(text.rstrip() + '\n', encoding='utf-8')


def wanted(row: Row) -> str:
    """What a row was asked for, in words."""
    if row.least is not None and row.target is not None:
        return f'{number(row.least)} to {number(row.target)}'
    if row.least is not None:
        return f'at least {number(row.least)}'
    return '' if row.target is None else f'at most {number(row.target)}'
