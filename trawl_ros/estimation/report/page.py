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
from trawl_ros.estimation.report.figures import drawings
from trawl_ros.estimation.report.motion import coefficient_rows, motion_lines
from trawl_ros.estimation.report.report import Report
from trawl_ros.estimation.report.residuals import ChannelResiduals
from trawl_ros.estimation.report.result import result
from trawl_ros.estimation.report.sensors import sensor_cells, sensor_headings
from trawl_ros.estimation.report.verdict import LARGEST_TEST_RATIO, verdict
from trawl_ros.estimation.windows.records import REASONS
from trawl_ros.report.pictures import Picture, by_section, draw, embedded
from trawl_ros.report.rendering import page as filled

PAGE = 'report.html'


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
        coefficients=_coefficients(report),
        motion=coefficient_rows(report.motion, report.truth) if report.motion else [],
        motion_lines=motion_lines(report),
        sections=by_section(pictures),
        sensors=[sensor_cells(row) for row in report.sensors],
        sensor_headings=sensor_headings(report.sensors),
        residuals=[_residual(row) for row in report.residuals],
        channels=PAPER_CHANNELS,
        tows=_tows(report),
        rejected=[
            (key, count, REASONS[key], report.found.get(key, ''))
            for key, count in report.rejected.items()
        ],
        laws=_laws(report),
        attack_deg=math.degrees(report.laws.angles.attack) if report.laws else math.nan,
        objectives=report.objectives,
        version=__version__,
    )


def _coefficients(report: Report) -> list[dict[str, object]]:
    estimate, rows = report.estimate, []
    for i, name in enumerate(estimate.names):
        row: dict[str, object] = {
            'name': name,
            'start': report.prior.start[i],
            'value': estimate.values[i],
            'low': estimate.low[i],
            'high': estimate.high[i],
            'shrink': estimate.shrink[i],
            'determined': estimate.determined[i],
        }
        if report.truth is not None:
            row['truth'] = report.truth[i]
            row['inside'] = estimate.low[i] <= report.truth[i] <= estimate.high[i]
        rows.append(row)
    return rows


def _laws(report: Report) -> list[dict[str, object]]:
    """Rows of the laws, none where they are not known."""
    if report.laws is None:
        return []
    known, number = report.laws.quantities, len(LAWS)

    def cells(i: int) -> dict[str, object]:
        return {'value': known.values[i], 'sd': known.sd[i], 'well': known.well_known[i]}

    return [
        {'name': law.name, 'angle': law.angle, 'at': cells(i), 'over': cells(number + i)}
        for i, law in enumerate(LAWS)
    ]


def _residual(row: ChannelResiduals) -> dict[str, object]:
    white = row.whiteness
    scale, unit = {'N': (1e-3, 'kN'), 'rad': (180.0 / math.pi, '°')}.get(row.unit, (1.0, row.unit))
    return {
        'name': row.channel.replace('_', ' '),
        'unit': unit,
        'windows': len(row.values),
        'mean': scale * row.mean,
        'std': scale * row.std,
        'stated_std': scale * row.stated_std,
        'test_ratio': row.test_ratio,
        'beyond': row.test_ratio > LARGEST_TEST_RATIO,
        'white': 'too few' if white is None else f'{white.p_value:.2g}',
        'coloured': white is not None and not white.white,
    }


def _tows(report: Report) -> list[dict[str, object]]:
    return [
        {
            'name': tow.name,
            'windows': tow.windows,
            'states': tow.states,
            'errors': [percent(error) for error in tow.held_out],
        }
        for tow in report.by_tow
    ]


def percent(value: float) -> str:
    """Format a share as a percentage, or a dash where it is not known."""
    return f'{100.0 * value:.1f} %' if math.isfinite(value) else '–'
