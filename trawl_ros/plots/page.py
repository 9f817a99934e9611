"""HTML page of all figures of a tow."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.core.files import write_text
from trawl_ros.core.version import __version__
from trawl_ros.plots.records import TowHistory
from trawl_ros.report import style
from trawl_ros.report.rendering import page

PAGE = 'index.html'


@dataclass(frozen=True)
class Picture:
    """Picture: a file beside the page, its caption, and the heading it stands under."""

    file: str
    caption: str
    section: str


def write_page(
    folder: Path, tow: TowHistory, pictures: Sequence[Picture], notes: Sequence[str]
) -> None:
    """Write ``index.html`` into a folder that has the pictures."""
    sections: dict[str, list[Picture]] = {}
    for picture in pictures:
        sections.setdefault(picture.section, []).append(picture)
    text = page(
        'trawl_ros.plots',
        PAGE,
        name=tow.name,
        duration=style.clock(tow.duration_s),
        sections=sections,
        notes=notes,
        version=__version__,
    )
    write_text(folder / PAGE, text)
