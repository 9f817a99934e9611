"""Rows of the smallest detectable sizes, and the median of their ratios over the catalogue."""

from itertools import groupby

import numpy as np

from studies.motion.detectable_sizes import DetectableSizes
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.report.rendering import number

MOST_RATIO = 0.5
"""Smallest detectable size by all of the tows over that by their windows, at most."""

SERIES = 'four tows of an hour'


def detectable_rows(found: DetectableSizes) -> list[MeasuredValue]:
    """Medians over effects and over their values, and a row for each effect."""
    ratios, every, rows, blind = [], [], [], []
    for effect, lines in groupby(_lines(found), lambda line: line[0]):
        own = list(lines)
        each = [m / w for _, _, w, m in own if w is not None and m is not None]
        if not each:
            blind.append(effect)
            continue
        every += each
        ratios.append(float(np.exp(np.mean(np.log(each)))))
        words = '; '.join(
            f'{what} {_size(still)}, {_size(moving)}' for _, what, still, moving in own
        )
        what = f'{SERIES}: smallest detectable {effect}, all of them over windows alone'
        rows.append(MeasuredValue(what, ratios[-1], note=f'by windows, by all: {words}'))
    told = f'neither shows {", ".join(blind)}; ' if blind else ''
    return [
        MeasuredValue(
            f'{SERIES}: smallest detectable effect, all of them over windows alone, median',
            float(np.median(ratios)), '', at_most(MOST_RATIO),
            f'of {len(ratios)} effects, one of several values by the geometric mean of theirs; '
            f'least and most; {found.number_of_windows} windows, '
            f'{found.counted_s / 60.0:.0f} min that count; {told}of board_added_mass, which no '
            f'window shows, {_size(found.added_mass)}; {found.cpu_s:.0f} s of processor time',
            low=min(ratios), high=max(ratios),
        ),
        MeasuredValue(
            f'{SERIES}: the same, median of all values one by one',
            float(np.median(every)), '',
            note=f'of {len(every)} values; effects of one side and of boards have several; least '
            'and most',
            low=min(every), high=max(every),
        ),
        *rows,
    ]  # fmt: skip


def _lines(found: DetectableSizes) -> list[tuple[str, str, float | None, float | None]]:
    words = [
        f'{value} ({unit})' if unit else value
        for value, unit in zip(found.values, found.units, strict=True)
    ]
    return list(zip(found.effects, words, found.windows, found.motion, strict=True))


def _size(size: float | None) -> str:
    return 'none' if size is None else number(size)
