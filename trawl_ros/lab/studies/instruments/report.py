"""Report of the study of instruments: JSON, Markdown, HTML and figures."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.lab.report.measured import MeasuredValue, at_least, between
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.lab.studies.instruments.statistics import STATISTICS
from trawl_ros.lab.studies.instruments.study import (
    SEED,
    Comparison,
    SensorFindings,
    percentiles,
)
from trawl_ros.report.pictures import Drawing

REPORT = 'instruments.md'
AGREEMENT = 0.9
LOG_FROM = 100.0
"""Readings (m) from which on a picture has a logarithmic axis."""

SWAPPED = (False, True)
"""Of the picture's columns: is the simulated haul the upper one?"""


def write_instruments(
    folder: Path, found: Sequence[SensorFindings], ship: str, seed: int
) -> list[MeasuredValue]:
    """Write ``instruments.json``, ``.md``, ``.html`` and figures into a folder; return all rows."""
    seeded = '' if seed == SEED else f' --seed {seed}'
    page = Page(
        name='instruments',
        title='Range sensors beside measured ones',
        command=f'trawl study instruments --table FILE --instruments {ship}{seeded}',
        method='Readings of two acoustic net sensors through the hauls of a bottom trawl survey: '
        'the distance between the wing tips, and the height of the headrope. The simulated '
        'sensor goes through the course of each haul, the running median of what was measured, '
        'for as long; its recorder keeps whole seconds as that of the survey does, and the first '
        'reading of each. Statistics are computed for each haul. Those of odd numbers judge: the '
        'median of the simulated hauls has to lie within the middle 90 % of the measured ones. '
        'By those of even numbers the values of the sensors were chosen. Neither depth nor '
        'turns of the ship are in the file, so what depends on them is not seen.',
    )
    sections = [
        section for one in found for section in (*_statistics_sections(one), _gates_section(one))
    ]
    drawings = [
        Drawing(
            'instruments',
            'In each column one haul was measured and one was simulated.',
            pair_figure(found),
        ),
        Drawing(
            'instruments_statistics',
            'Statistics of the simulated hauls of odd numbers (dot: median, line: middle 90 %) '
            'within the middle 90 % of the measured ones (bar; tick: median), scaled by it.',
            statistics_figure(found),
        ),
    ]
    return write_page(folder, page, sections, drawings)


def _statistics_sections(one: SensorFindings) -> list[Section]:
    name = one.sensor.name
    rows = [_row(name, key, one.judged) for key in STATISTICS]
    fitted = TextTable(
        'Hauls of even numbers, by which values were chosen: medians, and the middle 90 % of the '
        'measured ones.',
        ('statistic', 'measured', 'low', 'high', 'simulated'),
        tuple(
            (
                sentence,
                *(
                    f'{value:.3g}'
                    for value in (
                        percentiles(one.fitted.measured[key])[1],
                        *one.fitted.band(key),
                        one.fitted.median(key),
                    )
                ),
            )
            for key, (sentence, _) in STATISTICS.items()
        ),
    )
    return [Section(f'The sensor of {name}', rows, tables=[fitted])]


def _row(name: str, key: str, judged: Comparison) -> MeasuredValue:
    sentence, unit = STATISTICS[key]
    low, high = judged.band(key)
    return MeasuredValue(
        f'{name}: {sentence}',
        judged.median(key),
        unit,
        None if np.isnan(low) else between(low, high),
        f'{100.0 * judged.inside(key):.0f} % of the simulated hauls lie within; measured median '
        f'{percentiles(judged.measured[key])[1]:.3g}',
    )


def _gates_section(one: SensorFindings) -> Section:
    gates, name = one.gates, one.sensor.name
    alone = gates.agreement(with_outliers=False)
    rows = [
        MeasuredValue(
            f'{name}: agreement (F1) of the timestamp check with the editors',
            alone,
            '',
            at_least(AGREEMENT),
            f'of {gates.readings} readings the editors rejected {gates.by_editors}, the check '
            f'{gates.stamps}, both {gates.both}: the second of two readings in one second',
        ),
        MeasuredValue(
            f'{name}: agreement (F1) of all gates with the editors',
            gates.agreement(with_outliers=True),
            '',
            at_least(AGREEMENT),
            f'the outlier gate rejected {gates.off} of {gates.towed} readings while towing, '
            f'{gates.off_kept} of which the editors kept: their codes in this file are those of '
            'repeated seconds alone, whatever was read',
        ),
        MeasuredValue(
            f'{name}: windows of a minute with a mean that can be used',
            100.0 * gates.used / gates.windows if gates.windows else np.nan,
            '%',
            note=f'{gates.used} of {gates.windows}; without: '
            + (', '.join(f'{why} {n}' for why, n in sorted(one.reasons.items())) or 'none'),
        ),
    ]
    return Section(f'Gates of the estimation on the sensor of {name}', rows)


def pair_figure(found: Sequence[SensorFindings]) -> Figure:
    """Draw a measured haul and a simulated one of each sensor, without saying which is which."""
    figure = Figure(figsize=(11.0, 6.0), layout='constrained')
    axes = figure.subplots(2, len(found), sharex='col', squeeze=False)
    for column, one in enumerate(found):
        pair = one.pair[::-1] if SWAPPED[column % len(SWAPPED)] else one.pair
        start = min(side.time[0] for side in pair)
        for place, letter, side in zip(axes[:, column], 'AB', pair, strict=True):
            place.plot((side.time - start) / 60.0, side.value, '.', color='0.2', markersize=2.5)
            if max(values.max() for values in (side.value for side in pair)) > LOG_FROM:
                place.set_yscale('log')
            place.set_ylabel(f'{one.sensor.name} / m')
            place.set_title(letter, loc='left')
            place.grid(alpha=0.3)
        axes[-1, column].set_xlabel('time / min')
    return figure


def statistics_figure(found: Sequence[SensorFindings]) -> Figure:
    """Draw where the simulated statistics lie within the measured ones."""
    figure = Figure(figsize=(11.0, 5.5), layout='constrained')
    axes = figure.subplots(1, len(found), sharey=True, squeeze=False)[0]
    places = np.arange(len(STATISTICS))[::-1]
    for place, one in zip(axes, found, strict=True):
        for y, key in zip(places, STATISTICS, strict=True):
            low, high = one.judged.band(key)
            width = high - low if high > low else 1.0
            ends = np.array(percentiles(one.judged.simulated[key]))
            line = np.clip((ends - low) / width, -0.5, 1.5)
            place.barh(y, 1.0, color='0.85', height=0.7)
            middle = (percentiles(one.judged.measured[key])[1] - low) / width
            place.plot([middle, middle], [y - 0.35, y + 0.35], color='0.4')
            place.plot(line[[0, 2]], [y, y], color='C0')
            place.plot(line[1], y, 'o', color='C0')
        place.set_title(one.sensor.name)
        place.set_xlim(-0.5, 1.5)
        place.set_xticks([0.0, 1.0], ['5 %', '95 %'])
    axes[0].set_yticks(places, [sentence for sentence, _ in STATISTICS.values()])
    return figure
