"""Report of the study of the trawl sonar: JSON, Markdown, HTML and a figure."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.files import finite
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.lab.studies.sonar.study import SHOWN, STATES, SonarMeasurement, figures
from trawl_ros.plots.records import SonarPicture
from trawl_ros.plots.sonar import BACKGROUND, ECHOES, draw_sonar, prepare
from trawl_ros.report.pictures import Drawing

REPORT = 'sonar.md'
CAPTION = (
    'Sweeps at 500 m of warp: the net alone, with its ropes as circles; the same sweep as it is in '
    'the message; dense fish between the ropes; the seabed in view. Blue is what was read off.'
)


def write_sonar(folder: Path, measured: Sequence[SonarMeasurement], sweeps: int) -> None:
    """Write ``sonar.json``, ``.md``, ``.html`` and ``.png`` into a folder."""
    states, rows = scatter(measured), [_row(case) for case in measured]
    page = Page(
        name='sonar',
        title="The openings, as they are read off the trawl sonar's image",
        command=f'trawl study sonar --sweeps {sweeps}',
        method=f'{sweeps} sweeps of each case, readings less the truth in the middle of the sweep, '
        'm. "Unread" counts sweeps that gave NaN. Over the states of the gear alone, the first '
        f'{len(STATES)}, the scatter is {states["height"]:.2f} m of the height and '
        f'{states["width"]:.2f} m of the width.',
    )
    write_page(
        folder,
        page,
        [Section('The cases', tables=[_table(rows)])],
        [Drawing('sonar', CAPTION, images_figure(measured))],
        record={'sweeps': sweeps, 'cases': rows},
    )


def scatter(measured: Sequence[SonarMeasurement]) -> dict[str, float]:
    """Give the scatter (m, root mean square over the states of the gear) of both readings."""
    states = [case for case in measured if case.case in STATES]
    return {
        'height': _together([figures(m.height, m.true_height).scatter for m in states]),
        'width': _together([figures(m.width, m.true_width).scatter for m in states]),
    }


def _together(scatters: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(scatters)))) if scatters else float('nan')


def _row(measured: SonarMeasurement) -> dict[str, Any]:
    def side(readings: FloatArray, truth: FloatArray) -> dict[str, float | None]:
        found = {'truth': float(truth.mean()), **asdict(figures(readings, truth))}
        return {key: finite(value) for key, value in found.items()}

    return {
        'name': measured.case.name,
        'height': side(measured.height, measured.true_height),
        'width': side(measured.width, measured.true_width),
    }


def _table(rows: Sequence[Mapping[str, Any]]) -> TextTable:
    def cells(side: Mapping[str, float | None]) -> Iterator[str]:
        yield f'{side["truth"]:.1f}'
        for key in ('bias', 'scatter', 'worst'):
            yield '' if side[key] is None else f'{side[key]:.2f}'
        yield f'{side["unread"]:g}'

    errors = ('bias', 'scatter', 'worst', 'unread')
    return TextTable(
        'The openings as they are, and the errors of what was read, m.',
        ('case', 'height', *errors, 'width', *errors),
        tuple((row['name'], *cells(row['height']), *cells(row['width'])) for row in rows),
    )


def images_figure(measured: Sequence[SonarMeasurement]) -> Figure:
    """Draw the image of the clear 500 m case as it is in the message, and those with company."""
    by_case = {m.case: m for m in measured}
    clear, dense, seabed = (by_case[case] for case in SHOWN)
    figure = Figure(figsize=(11.0, 8.2), layout='constrained')
    axes = figure.subplots(2, 2)
    for place, case, title, with_truth in (
        (axes[0, 0], clear, 'the net, and where its ropes are', True),
        (axes[1, 0], dense, 'fish between the ropes', False),
        (axes[1, 1], seabed, 'the seabed below', False),
    ):
        picture = _picture(case, with_truth=with_truth)
        prepare(place, picture)
        draw_sonar(place, picture)
        place.set_ylim(-picture.scan.max_range, 20.0)
        place.set_title(title)
    scan, image = clear.scan, clear.image.image
    last = scan.angle_min + len(image) * scan.angle_increment
    first = np.degrees(scan.angle_min - 0.5 * scan.angle_increment)
    axes[0, 1].set_facecolor(BACKGROUND)
    axes[0, 1].imshow(
        image,
        extent=(0.0, scan.max_range, np.degrees(last - 0.5 * scan.angle_increment), first),
        aspect='auto',
        cmap=ECHOES,
        vmin=0,
        vmax=255,
        interpolation='nearest',
    )
    axes[0, 1].set_xlabel('range / m')
    axes[0, 1].set_ylabel('angle, positive to port / deg')
    axes[0, 1].set_title('the same sweep as it is in the message')
    return figure


def _picture(measured: SonarMeasurement, *, with_truth: bool) -> SonarPicture:
    return SonarPicture(
        time=0.0,
        image=measured.image,
        scan=measured.scan,
        height=float(measured.height[-1]),
        width=float(measured.width[-1]),
        mouth=measured.net.section[:, :2] if with_truth else np.zeros((0, 2)),
        closed=False,
    )
