"""HTML page of all figures of a tow."""

from collections.abc import Sequence
from pathlib import Path

from trawl_ros.core.files import write_text
from trawl_ros.core.version import __version__
from trawl_ros.plots.records import TowHistory
from trawl_ros.report import style
from trawl_ros.report.pictures import Picture, by_section
from trawl_ros.report.rendering import page

PAGE = 'index.html'


def write_page(
    folder: Path, tow: TowHistory, pictures: Sequence[Picture], notes: Sequence[str]
) -> None:
    """Write ``index.html`` into a folder that has the pictures."""
    text = page(
        'trawl_ros.plots',
        PAGE,
        name=tow.name,
        duration=style.clock(tow.duration_s),
        sections=by_section(pictures),
        notes=notes,
        version=__version__,
    )
    write_text(folder / PAGE, text)
