# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Layout of the view: places of space, sonar, track, histories, estimates and notes."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.view.series import VIEW_PANELS, path_of, title_of
from trawl_ros.view.viewer.rerun_library import rr, rrb

TIMELINE = 'time'

SEA = (14, 24, 38)
GRID = (38, 54, 76)
GRID_M = 50.0

Limits = tuple[float, float]

LATEST = rr.TimeRange(
    rr.TimeRangeBoundary.cursor_relative(seconds=-600.0),
    rr.TimeRangeBoundary.cursor_relative(seconds=0.0),
)
WHOLE = rr.TimeRange(rr.TimeRangeBoundary.infinite(), rr.TimeRangeBoundary.infinite())


@dataclass(frozen=True)
class Camera:
    """Centre of the gear in the ship's axes (ahead, to port, up), and its length, m."""

    middle: tuple[float, float, float]
    length: float


NEUTRAL = Camera((-250.0, 0.0, -60.0), 600.0)
"""Camera before the gear is known: some 500 m of gear, astern."""


def layout(
    topics: Collection[str],
    camera: Camera | None,
    panels: Collection[str] | None,
    limits: Mapping[str, Limits],
    *,
    live: bool,
) -> rrb.Blueprint:
    """Lay the views out of which there can be something.

    Parameters
    ----------
    topics
        Relative names of the topics.
    camera
        Place of the gear; None before it is known.
    panels
        Entities of the histories that there are; None for all that there may be.
    limits
        Of the vertical axis by the entity of a panel; that of others holds all values.
    live
        True to follow what comes, with the last minutes in the histories.
    """
    span = LATEST if live else WHOLE
    below = [_top(), *([_sonar()] if 'sonar/image' in topics else [])]
    left = [_space(camera or NEUTRAL), rrb.Horizontal(*below)]
    left.append(rrb.Tabs(*_notes(topics)))
    tabs = [rrb.Grid(*_histories(panels, limits, span), grid_columns=2, name='Histories')]
    if 'identification/status' in topics:
        tabs.append(rrb.Grid(*_estimates(WHOLE), grid_columns=3, name='Estimates'))
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(*left, row_shares=[5.0, 4.0, 1.6]),
            tabs[0] if len(tabs) == 1 else rrb.Tabs(*tabs, active_tab=0),
            column_shares=[1.0, 1.15],
        ),
        rrb.TimePanel(
            state='collapsed', timeline=TIMELINE, play_state='following' if live else 'paused'
        ),
        rrb.BlueprintPanel(state='collapsed'),
        rrb.SelectionPanel(state='collapsed'),
    )


def _space(camera: Camera) -> rrb.Spatial3DView:
    x, y, z = camera.middle
    far = 0.42 * camera.length
    return rrb.Spatial3DView(
        name='Gear, coloured by tension',
        origin='/map/ship',
        contents='/map/**',
        background=SEA,
        line_grid=rrb.LineGrid3D(visible=True, spacing=GRID_M, color=GRID, stroke_width=1.0),
        eye_controls=rrb.EyeControls3D(
            position=(x - 0.25 * far, y - far, z + 0.45 * far),
            look_target=(x, y, z),
            eye_up=(0.0, 0.0, 1.0),
        ),
    )


def _top() -> rrb.Spatial2DView:
    return rrb.Spatial2DView(
        name='From above, north up',
        origin='/top',
        background=SEA,
    )


def _sonar() -> rrb.Spatial2DView:
    return rrb.Spatial2DView(name='Trawl sonar, looking ahead', origin='/sonar')


def _notes(topics: Collection[str]) -> Iterator[rrb.View]:
    yield rrb.TextLogView(name='Findings and notes', origin='/notes')
    if 'identification/status' in topics:
        yield rrb.TextDocumentView(name='Estimate', origin='/estimates')


def _plot(
    name: str, origin: str, limits: Limits | None, span: rr.TimeRange, *, legend: bool
) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        name=name,
        origin=origin,
        axis_x=rrb.TimeAxis(view_range=span),
        axis_y=None if limits is None else rrb.ScalarAxis(range=limits),
        plot_legend=rrb.PlotLegend(visible=legend),
    )


def _histories(
    panels: Collection[str] | None, limits: Mapping[str, Limits], span: rr.TimeRange
) -> Iterator[rrb.TimeSeriesView]:
    for panel in VIEW_PANELS:
        path = path_of(panel)
        if panels is None or path in panels:
            yield _plot(title_of(panel), path, limits.get(path), span, legend=False)


def _estimates(span: rr.TimeRange) -> Iterator[rrb.TimeSeriesView]:
    for name in COEFFICIENTS:
        yield _plot(name, f'/estimate/{name}', None, span, legend=False)
    yield _plot('innovations over their deviations', '/innovations', None, span, legend=True)
