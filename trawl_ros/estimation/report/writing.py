"""Files of a report."""

from collections.abc import Sequence
from pathlib import Path

from trawl_ros.core.files import made_folder, write_json, write_text
from trawl_ros.estimation.report.figures import drawings
from trawl_ros.estimation.report.page import PAGE, page
from trawl_ros.estimation.report.report import Report
from trawl_ros.estimation.report.result import result
from trawl_ros.report.pictures import draw, embedded


def write_report(found: Report, folder: Path, advice: Sequence[str] = ()) -> None:
    """Write ``identification.json``, the figures and ``report.html``.

    Parameters
    ----------
    found
        Report of the identification.
    folder
        Made if it does not exist.
    advice
        Sentences on what to tow next, where there are any.

    Raises
    ------
    TrawlError
        If the folder cannot be written to.
    """
    made_folder(folder)
    write_json(folder / 'identification.json', result(found), indent=2)
    pictures = embedded(folder, draw(folder, drawings(found)))
    write_text(folder / PAGE, page(found, pictures, advice))
