"""Writes a report into a folder."""

import json
from pathlib import Path

from trawl_ros.errors import TrawlError
from trawl_ros.identification.figures import draw_figures
from trawl_ros.identification.report import Report
from trawl_ros.identification.result import result


def write_report(found: Report, folder: Path) -> None:
    """Write ``identification.json`` and the figures.

    Raises
    ------
    TrawlError
        If the folder cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps(result(found), indent=2)
        (folder / 'identification.json').write_text(f'{text}\n', encoding='utf-8')
        draw_figures(found, folder)
    except OSError as reason:
        raise TrawlError(f'{folder}: cannot be written ({reason.strerror})') from reason
