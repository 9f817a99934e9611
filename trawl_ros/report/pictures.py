# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pictures of a report: written to its folder, and embedded in its page."""

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
    """Figure of a report.

    Attributes
    ----------
    name
        Name of its file, without the suffix.
    caption
        A sentence or two.
    figure
        The figure.
    section
        Heading above it; '' for none.
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
        Folder of the page; made if it does not exist.
    drawings
        The figures.
    prefix
        Prefix of the names, such as ``'figures/case_'``.

    Raises
    ------
    TrawlError
        If a figure cannot be written.
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
    """Embed PNG files of a folder as text, for a self-contained page."""
    return tuple(
        replace(picture, file=f'data:image/png;base64,{_base64(folder / picture.file)}')
        for picture in pictures
    )


def _base64(file: Path) -> str:
    return base64.b64encode(file.read_bytes()).decode('ascii')


def by_section(pictures: Iterable[Picture]) -> dict[str, list[Picture]]:
    """Group pictures by heading, in the order of first occurrence."""
    sections: dict[str, list[Picture]] = {}
    for picture in pictures:
        sections.setdefault(picture.section, []).append(picture)
    return sections
