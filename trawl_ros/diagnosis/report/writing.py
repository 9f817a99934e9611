"""Files of a diagnosis."""

import base64
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import write_json, write_text
from trawl_ros.diagnosis.diagnosis import Diagnosis
from trawl_ros.diagnosis.repair import SourceBag, gear_text, repaired
from trawl_ros.diagnosis.report.figures import draw_figures
from trawl_ros.diagnosis.report.result import result
from trawl_ros.diagnosis.report.sentences import headline, sentences
from trawl_ros.estimation.report.figures import ReportFigure
from trawl_ros.estimation.report.page import Embedded
from trawl_ros.report.rendering import page

MODEL = 'model.yaml'


def write_diagnosis(found: Diagnosis, sources: Sequence[SourceBag], folder: Path) -> None:
    """Write ``diagnosis.json``, both reports, the figures, and ``model.yaml`` where there is one.

    Parameters
    ----------
    found
        What to write.
    sources
        The bags.
    folder
        Made if it does not exist.

    Raises
    ------
    TrawlError
        If the folder cannot be written to.
    """
    numbers = result(found, sources)
    gear = repaired(found, sources)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_json(folder / 'diagnosis.json', numbers, indent=2)
        if gear is not None:
            write_text(folder / MODEL, gear_text(gear))
        drawn = draw_figures(found, folder)
        for name in ('report.html', 'report.md'):
            write_text(folder / name, _page(name, found, numbers, folder, drawn, gear is not None))
    except OSError as reason:
        raise TrawlError(f'{folder}: cannot be written ({reason.strerror})') from reason


def _page(
    name: str,
    found: Diagnosis,
    numbers: dict[str, Any],
    folder: Path,
    drawn: Sequence[ReportFigure],
    repaired: bool,
) -> str:
    figures: dict[str, list[Embedded]] = {}
    for drawing in drawn:
        data = base64.b64encode((folder / drawing.file).read_bytes()).decode('ascii')
        figures.setdefault(drawing.section, []).append(Embedded(drawing.caption, data))
    return page(
        'trawl_ros.diagnosis.report',
        name,
        result={**numbers, 'gear': found.gear.name},
        headline=headline(found),
        sentences=sentences(found),
        figures=list(figures.items()),
        repaired=repaired,
        added_as=found.added_as,
    )
