# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Report of measured values: JSON, Markdown and HTML, with tables and pictures."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from trawl_ros.core.files import made_folder, write_json, write_text
from trawl_ros.core.version import __version__
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.report.pictures import Drawing, Picture, draw, embedded
from trawl_ros.report.rendering import number
from trawl_ros.report.rendering import page as filled


@dataclass(frozen=True)
class TextTable:
    """Table of text; every row is as long as ``head``."""

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Findings:
    """Findings of a case or benchmark; ``text`` is a paragraph for the report."""

    rows: tuple[MeasuredValue, ...]
    drawings: tuple[Drawing, ...] = ()
    tables: tuple[TextTable, ...] = ()
    text: str = ''


@dataclass(frozen=True)
class Section:
    """Section of a report.

    Attributes
    ----------
    title
        Its heading.
    rows, pictures, tables, text
        Content of the section; ``text`` is a paragraph.
    group
        Heading that it shares with its neighbours; '' for none.
    name, command, seconds
        Of what was run for it: its name, the command for it alone, and s of wall clock.
    """

    title: str
    rows: Sequence[MeasuredValue] = ()
    pictures: Sequence[Picture] = ()
    tables: Sequence[TextTable] = ()
    text: str = ''
    group: str = ''
    name: str = ''
    command: str = ''
    seconds: float = 0.0

    @property
    def missed(self) -> list[MeasuredValue]:
        """Rows whose target is not reached."""
        return [row for row in self.rows if not row.ok]

    @property
    def outcome(self) -> str:
        """How many of its targets are reached, in words."""
        return reached_in_words(self.rows) or f'{len(self.rows)} values'


@dataclass(frozen=True)
class Page:
    """Texts of a report, apart from its sections.

    Attributes
    ----------
    name
        Name of the files, without their endings.
    title, command, method
        Subject, command that makes the report again, and method of the values.
    data
        Name of the JSON file, without its ending; by default as the others.
    answer
        First sentence of the report, before how many targets are reached; by default the first
        value that has a target.
    lead
        Name of the section that answers the question of the report. It comes before the targets
        that are not reached, and its first picture is at the top. '' for a page without one, which
        has the first picture of all there.
    """

    name: str
    title: str
    command: str
    method: str
    data: str = ''
    answer: str = ''
    lead: str = ''


def write_page(
    folder: Path,
    page: Page,
    sections: Sequence[Section],
    drawings: Iterable[Drawing] = (),
    record: Mapping[str, object] | None = None,
) -> list[MeasuredValue]:
    """Write ``<name>.json``, ``.md``, ``.html`` and the pictures into a folder; return all rows.

    Parameters
    ----------
    folder
        Made if it does not exist.
    page
        Its texts.
    sections
        Content of the page. Pictures are in the folder already, and the page refers to them.
    drawings
        To be drawn, for the end of the page; the HTML page has them in it.
    record
        Content of the JSON file; by default all rows.

    Raises
    ------
    TrawlError
        If something cannot be written.
    """
    rows = [row for section in sections for row in section.rows]
    content = {'rows': [row.record() for row in rows]} if record is None else record
    made_folder(folder)
    write_json(folder / f'{page.data or page.name}.json', content, indent=1, ensure_ascii=False)
    pictures = draw(folder, drawings)
    verdict = ' '.join(filter(None, (page.answer or _first(rows), reached_in_words(rows))))
    filled_in = [section for section in sections if section.rows or section.tables]
    lead, filled_in = _led(filled_in, page.lead)
    for kind, shown in (('md', pictures), ('html', embedded(folder, pictures))):
        text = filled(
            'trawl_ros.lab.report',
            f'report.{kind}',
            page=page,
            version=__version__,
            answering=[one for one in filled_in if page.lead and one.name == page.lead],
            sections=[one for one in filled_in if not page.lead or one.name != page.lead],
            verdict=verdict,
            lead=lead or shown[:1],
            missed=_missed_table(sections),
            values_table=values_table,
            pictures=shown if lead else shown[1:],
        )
        write_text(folder / f'{page.name}.{kind}', text)
    return rows


def reached_in_words(rows: Sequence[MeasuredValue]) -> str:
    """Return how many targets are reached, as a sentence; '' where there are none."""
    asked = [row for row in rows if row.target is not None]
    return f'{sum(row.ok for row in asked)} of {len(asked)} targets are reached.' if asked else ''


def _first(rows: Sequence[MeasuredValue]) -> str:
    """Return the first value that has a target, as a sentence; '' without one."""
    first = next((row for row in rows if row.target is not None), None)
    return '' if first is None else f'{first.what[:1].upper()}{first.what[1:]}: {first.figure}.'


def _led(sections: Sequence[Section], name: str) -> tuple[tuple[Picture, ...], list[Section]]:
    """Take the picture for the top of the page out of the section of that name, or the first."""
    with_pictures = [section for section in sections if section.pictures]
    named = [section for section in with_pictures if section.name == name]
    for leading in (named or with_pictures)[:1]:
        return tuple(leading.pictures[:1]), [
            replace(section, pictures=section.pictures[1:]) if section is leading else section
            for section in sections
        ]
    return (), list(sections)


def values_table(rows: Sequence[MeasuredValue]) -> TextTable:
    """Table of values without empty columns."""
    head = ('what', 'value', 'low', 'high', 'asked for', 'reached', 'note')
    cells = [
        (
            row.what,
            row.figure,
            *('' if math.isnan(end) else number(end) for end in (row.low, row.high)),
            row.wanted,
            '' if row.target is None else 'yes' if row.ok else 'no',
            row.note,
        )
        for row in rows
    ]
    kept = [column for column in range(len(head)) if any(row[column] for row in cells)]
    return TextTable(
        '',
        tuple(head[column] for column in kept),
        tuple(tuple(row[column] for column in kept) for row in cells),
    )


def _missed_table(sections: Sequence[Section]) -> TextTable:
    return TextTable(
        '',
        ('where', 'what', 'value', 'asked for', 'why'),
        tuple(
            (section.title, row.what, row.figure, row.wanted, row.note)
            for section in sections
            for row in section.missed
        ),
    )
