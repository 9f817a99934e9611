# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files of an identification: JSON, figures, and a self-contained HTML page."""

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from trawl_ros.core.files import made_folder, write_json, write_text
from trawl_ros.core.version import __version__
from trawl_ros.estimation.fit.laws import LAWS
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.report.chain import chain_lines
from trawl_ros.estimation.report.figures import drawings
from trawl_ros.estimation.report.report import Report, coefficient_rows
from trawl_ros.estimation.report.result import result
from trawl_ros.estimation.report.sensors import sensor_cells, sensor_headings
from trawl_ros.estimation.report.verdict import LARGEST_TEST_RATIO, verdict
from trawl_ros.estimation.windows.records import REASONS
from trawl_ros.report.pictures import Picture, by_section, draw, embedded
from trawl_ros.report.rendering import page as filled

PAGE = 'report.html'

SCALES = {'N': (1e-3, 'kN'), 'rad': (180.0 / math.pi, '°')}
"""Factor to the unit in which residuals are shown, and this unit."""


def write_report(report: Report, folder: Path, advice: Sequence[str] = ()) -> None:
    """Write ``identification.json``, the figures and ``report.html``.

    Parameters
    ----------
    report
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
    write_json(folder / 'identification.json', result(report), indent=2)
    pictures = embedded(folder, draw(folder, drawings(report)))
    write_text(folder / PAGE, report_page(report, pictures, advice))


def report_page(report: Report, pictures: Iterable[Picture], advice: Sequence[str] = ()) -> str:
    """Render the page as HTML.

    Parameters
    ----------
    report
        Report of the identification.
    pictures
        Its figures, embedded.
    advice
        Sentences on what to tow next; without any the page has no such heading.
    """
    return filled(
        'trawl_ros.estimation.report',
        PAGE,
        report=report,
        verdict=verdict(report),
        advice=advice,
        coefficients=coefficient_rows(report),
        chain_lines=chain_lines(report),
        sections=by_section(pictures),
        sensors=[sensor_cells(row) for row in report.sensors],
        sensor_headings=sensor_headings(report.sensors),
        scales=SCALES,
        largest_test_ratio=LARGEST_TEST_RATIO,
        channels=PAPER_CHANNELS,
        percent=percent,
        reasons=REASONS,
        law_names=LAWS,
        objective=objective_line(report),
        version=__version__,
    )


def objective_line(report: Report) -> str:
    """Objective of eq. 35 at the start values, at the end, and at the truth if it is known."""
    values = report.objectives
    start = 'no steady state' if math.isnan(values['start']) else f'{values["start"]:.4f}'
    truth = f', {values["truth"]:.4f} at the truth' if 'truth' in values else ''
    return f'Objective of eq. 35: {start} at the start, {values["end"]:.4f} at the end{truth}.'


def percent(value: float) -> str:
    """Format a share as a percentage, or a dash where it is not known."""
    return f'{100.0 * value:.1f} %' if math.isfinite(value) else '–'
