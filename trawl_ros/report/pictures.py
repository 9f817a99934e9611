"""Pictures of a report: drawn into its folder, and embedded into its page."""

import base64
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from trawl_ros.core.files import made_folder, write_figure
from trawl_ros.report.style import DPI

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Drawing:
    """Figure to be drawn.

    Attributes
    ----------
    name
        Of its file, without the ending.
    caption
        A sentence or two.
    figure
        The figure.
    section
        Heading it stands under; '' for none.
    """

    name: str
    caption: str
    figure: 'Figure'
    section: str = ''


@dataclass(frozen=True)
class Picture:
    """Picture on a page: a file, relative to the page, its caption, and its heading."""

    file: str
    caption: str
    section: str = ''


def draw(folder: Path, drawings: Iterable[Drawing], prefix: str = '') -> tuple[Picture, ...]:
    """Draw figures as PNG files.

    Parameters
    ----------
    folder
        Of the page; made if it does not exist.
    drawings
        The figures.
    prefix
        Stands before the names, such as ``'figures/case_'``.

    Raises
    ------
    TrawlError
        If one cannot be written.
    """
    pictures = []
    for drawing in drawings:
        picture = Picture(f'{prefix}{drawing.name}.png', drawing.caption, drawing.section)
        file = folder / picture.file
        made_folder(file.parent)
        write_figure(file, drawing.figure, DPI)
        pictures.append(picture)
    return tuple(pictures)


def embedded(folder: Path, pictures: Iterable[Picture]) -> tuple[Picture, ...]:
    """Embed PNG files of a folder as text, for a page that needs nothing beside it."""
    return tuple(
        replace(picture, file=f'data:image/png;base64,{_base64(folder / picture.file)}')
        for picture in pictures
    )


def _base64(file: Path) -> str:
    return base64.b64encode(file.read_bytes()).decode('ascii')


def by_section(pictures: Iterable[Picture]) -> dict[str, list[Picture]]:
    """Group pictures by their heading, in the order in which these first come."""
    sections: dict[str, list[Picture]] = {}
    for picture in pictures:
        sections.setdefault(picture.section, []).append(picture)
    return sections
