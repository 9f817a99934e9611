# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Series over time: panel, unit, colour and place of each quantity, and ranges of the panels.

Far outliers must not hide the other readings, and noise must not look large.
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.plots.histories import PANELS, Curve, Panel
from trawl_ros.plots.records import Kind
from trawl_ros.records.truth import SIDES
from trawl_ros.report import style

ROOT = '/histories'

HEADING = 'heading'

FAR_RANGE_RATIO = 3.0
"""An axis leaves outliers out if all readings need this many times the height of the others."""


def _panels() -> tuple[Panel, ...]:
    """Panels of the histories in pictures; depths share one, with the seabed in it."""
    panels = []
    for panel in PANELS:
        names = [curve.name for curve in panel.curves]
        if names == ['net_depth']:
            continue
        if 'port_door_depth' in names:
            curves = (
                *(replace(curve, label=f'{curve.label} door') for curve in panel.curves),
                Curve('net_depth', 'headrope', style.MEASURED, style.MEASURED_TRUTH),
                Curve('seabed', 'seabed', style.FAINT, style.FAINT),
            )
            # An axis cannot point down, so depths are heights that are negative.
            panel = Panel('height over the surface / m', curves, panel.least, scale=-1.0)
        panels.append(panel)
    bottom = Curve('bottom', 'headrope', style.MEASURED, style.MEASURED_TRUTH)
    keel = Curve('depth', 'keel', style.SECOND, style.SECOND_TRUTH)
    return (*panels, Panel('height over the seabed / m', (bottom, keel), 2.0))


VIEW_PANELS = _panels()

COLOUR_NAMES = {
    style.PORT: 'red',
    style.STARBOARD: 'green',
    style.MEASURED: 'blue',
    style.SECOND: 'orange',
    style.FAINT: 'grey',
}

LEGEND = (
    'dots are measured, lines are true or wanted, broad ones the model; port is red, starboard '
    'green'
)

WHITER = 0.4
"""Whitening of lines over dots, visible on a dark window background and on a white page."""

NARROW, BROAD = 1.3, 4.0
"""Widths of lines: dots lie on the broad ones of the model where it is right."""

MOST_KEPT = 2_000
"""Largest number of kept values per panel and kind, spread over the whole tow."""

ORDINARY_PERCENTILES = (10.0, 90.0)
"""Percentiles between which readings are ordinary, if there is no truth."""

FREE_HEIGHT_SHARE = 0.3
"""Share of the height that stays free at the top and at the bottom."""

RGB = tuple[int, int, int]


@dataclass(frozen=True)
class Line:
    """Line or dots of a quantity: entity, name in the legend, colour, whether it is dots, width."""

    path: str
    name: str
    colour: RGB
    dots: bool
    width: float = NARROW


@dataclass(frozen=True)
class PlacedCurve:
    """Curve in its panel."""

    panel: Panel
    curve: Curve

    def line(self, kind: Kind) -> Line:
        """Return the line of one kind."""
        words = [self.curve.label, kind] if self.curve.label else [kind]
        return Line(
            f'{path_of(self.panel)}/{self.curve.name}/{kind}',
            ' '.join(words),
            rgb_of(self.curve.colour, 0.0 if kind == 'measured' else WHITER),
            dots=kind == 'measured',
            width=BROAD if kind == 'model' else NARROW,
        )

    def shown(self, value: float) -> float:
        """Convert a value (SI) into the panel's unit."""
        if self.curve.name == HEADING:
            return 90.0 - float(np.degrees(value))
        return self.panel.scale * value


def title_of(panel: Panel) -> str:
    """Title of a panel: quantity, unit, and the colours of its curves but those of the sides."""
    names = [
        f'{curve.label} {COLOUR_NAMES[curve.colour]}'
        for curve in panel.curves
        if curve.label not in ('', *SIDES)
    ]
    return f'{panel.label}: {", ".join(names)}' if names else panel.label


def path_of(panel: Panel) -> str:
    """Entity of a panel."""
    what = panel.label.partition(' /')[0].partition(',')[0]
    return f'{ROOT}/{what.replace(" ", "_")}'


def rgb_of(web: str, whiter: float = 0.0) -> RGB:
    """Colour of the pictures, whitened by a share."""
    red, green, blue = (
        round((1.0 - whiter) * int(web[k : k + 2], 16) + 255 * whiter) for k in (1, 3, 5)
    )
    return red, green, blue


CURVES = {curve.name: PlacedCurve(panel, curve) for panel in VIEW_PANELS for curve in panel.curves}
"""Curves by the name of their quantity."""


class Unwrapped:
    """Angles without jumps of a whole turn between consecutive values."""

    def __init__(self) -> None:
        self._last: dict[str, float] = {}

    def take(self, name: str, angle: float) -> float:
        """Return an angle (rad) within half a turn of the last one of that name."""
        if not np.isfinite(angle):
            return angle
        # Of compass degrees the first is from 0 to 360.
        last = self._last.get(name, -0.5 * np.pi)
        turned = last + float(np.remainder(angle - last + np.pi, 2.0 * np.pi) - np.pi)
        self._last[name] = turned
        return turned


class _Thinned:
    """Values thinned out evenly, with the extremes of all values."""

    def __init__(self) -> None:
        self.kept: list[float] = []
        self.low, self.high = np.inf, -np.inf
        self._stride, self._seen = 1, 0

    def take(self, value: float) -> None:
        self.low, self.high = min(self.low, value), max(self.high, value)
        self._seen += 1
        if (self._seen - 1) % self._stride == 0:
            self.kept.append(value)
        if len(self.kept) > MOST_KEPT:
            del self.kept[1::2]
            self._stride *= 2


class PanelRanges:
    """Ranges of values per panel, in its unit."""

    def __init__(self) -> None:
        self._values: dict[str, tuple[Panel, dict[str, _Thinned]]] = {}

    def take(self, panel: Panel, kind: Kind, value: float) -> None:
        """Take a value."""
        _, kinds = self._values.setdefault(path_of(panel), (panel, {}))
        kinds.setdefault(kind, _Thinned()).take(value)

    @property
    def panels(self) -> set[str]:
        """Entities of the panels that have values."""
        return set(self._values)

    def limits(self) -> dict[str, tuple[float, float]]:
        """Axis limits by panel, for panels in which not all values may fill the height.

        These are panels in which far outliers need several times the range of the rest, and panels
        in which nothing changes.
        """
        found = {}
        for path, (panel, kinds) in self._values.items():
            limits = _limits(kinds, panel.least)
            if limits is not None:
                found[path] = limits
        return found


def _limits(kinds: dict[str, _Thinned], least: float) -> tuple[float, float] | None:
    extremes = {kind: [values.low, values.high] for kind, values in kinds.items()}
    sure = [span for kind, span in extremes.items() if kind in ('truth', 'wanted')]
    ordinary = [
        np.percentile(values.kept, ORDINARY_PERCENTILES).tolist() for values in kinds.values()
    ]
    # A model that is far from what was measured is seen to be.
    modelled = [extremes['model']] if 'model' in extremes else []
    spans = np.array((sure or ordinary) + modelled)
    low, high = float(spans.min()), float(spans.max())
    room = max(high - low, least)
    extent = max(v.high for v in kinds.values()) - min(v.low for v in kinds.values())
    if extent < least:
        middle = 0.5 * (low + high)
        return middle - 0.5 * least, middle + 0.5 * least
    if extent <= FAR_RANGE_RATIO * room:
        return None
    return low - FREE_HEIGHT_SHARE * room, high + FREE_HEIGHT_SHARE * room
