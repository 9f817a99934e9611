"""Files of a report."""

import json
from collections.abc import Sequence
from pathlib import Path

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import write_text
from trawl_ros.estimation.report.figures import draw_figures
from trawl_ros.estimation.report.page import PAGE, page
from trawl_ros.estimation.report.report import Report
from trawl_ros.estimation.report.result import result


def write_report(found: Report, folder: Path, advice: Sequence[str] = ()) -> None:
    """Write ``identification.json``, the figures and ``report.html``.

    Parameters
    ----------
    found
        What to write.
    folder
        Made if it does not exist.
    advice
        Sentences on what to tow next, where there are any.

    Raises
    ------
    TrawlError
        If the folder cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps(result(found), indent=2)
        write_text(folder / 'identification.json', text)
        drawings = draw_figures(found, folder)
        write_text(folder / PAGE, page(found, folder, drawings, advice))
    except OSError as reason:
        raise TrawlError(f'{folder}: cannot be written ({reason.strerror})') from reason
