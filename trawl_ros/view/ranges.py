"""Ranges of the panels: readings far out are not to hide the others, nor noise to look large."""

import numpy as np

from trawl_ros.plots.histories import FAR_OUT, Panel
from trawl_ros.view.records import Kind
from trawl_ros.view.series import path_of

KEPT = 2_000
"""Values of a panel and a kind that are kept at most, from all of the tow."""

ORDINARY = (10.0, 90.0)
"""Between these percentiles readings are ordinary, where no truth tells."""

ROOM = 0.3
"""Part of the height that is left free above and below."""


class _Thinned:
    """Values thinned out evenly, with the extremes of all."""

    def __init__(self) -> None:
        self.kept: list[float] = []
        self.low, self.high = np.inf, -np.inf
        self._stride, self._seen = 1, 0

    def take(self, value: float) -> None:
        self.low, self.high = min(self.low, value), max(self.high, value)
        self._seen += 1
        if (self._seen - 1) % self._stride == 0:
            self.kept.append(value)
        if len(self.kept) > KEPT:
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
        """Limits by the panel's entity, where not all values are to fill the height.

        That is where readings far out need several times the rest, and where nothing changes.
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
    ordinary = [np.percentile(values.kept, ORDINARY).tolist() for values in kinds.values()]
    # A model that is far from what was measured is seen to be.
    modelled = [extremes['model']] if 'model' in extremes else []
    spans = np.array((sure or ordinary) + modelled)
    low, high = float(spans.min()), float(spans.max())
    room = max(high - low, least)
    extent = max(v.high for v in kinds.values()) - min(v.low for v in kinds.values())
    if extent < least:
        middle = 0.5 * (low + high)
        return middle - 0.5 * least, middle + 0.5 * least
    if extent <= FAR_OUT * room:
        return None
    return low - ROOM * room, high + ROOM * room
