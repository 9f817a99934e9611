"""Study of simulated range sensors compared with those of a survey."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from studies.harness import Study, StudyResult, Work, option
from studies.instruments.calibrations import Calibration, read_calibrations
from studies.instruments.comparison import (
    Comparison,
    SensorFindings,
    compare_sensors,
    percentiles,
)
from studies.instruments.guards import CLASSES, WORST
from studies.instruments.statistics import EDGES_M, STATISTICS
from studies.instruments.wire_steps import Stretch, growth, read_steps
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.lab.report.measured import MeasuredValue, at_least, between
from trawl_ros.lab.report.page import Section, TextTable
from trawl_ros.report.pictures import Drawing

AGREEMENT = 0.9
LOG_FROM = 100.0
"""Readings (m) from which on a picture has a logarithmic axis."""

LOG_TICKS = (2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)

SWAPPED = (False, True)
"""Of the picture's columns: is the simulated haul the upper one?"""


@dataclass(frozen=True)
class InstrumentsPlan:
    """Tables and parameters; values of the sensors were chosen by looking at seed 1."""

    table: str = option(
        '', 'Readings of a survey, CSV packed by gzip: HAUL, t, CABINET_SENSOR_FLAG, VALUE, '
        'DATUM_CODE.',
    )  # fmt: skip
    beside: str = option(
        '', 'Folder with further tables: stepped lengths of wire, counters and marks on the wire, '
        'distances on a dock.',
    )  # fmt: skip
    instruments: str = option('default', 'File or name of instrument parameters.')
    seed: int = option(20, 'Of the simulated readings.')


def run(plan: InstrumentsPlan, work: Work) -> StudyResult:
    """Compare simulated range sensors with those of a survey, haul by haul."""
    if not plan.table:
        raise TrawlError('--table: found none, expected the file of readings of a survey')
    ship = load_instruments(plan.instruments)
    steps, calibrations = None, None
    if plan.beside:
        steps = read_steps(Path(plan.beside))
        calibrations = read_calibrations(Path(plan.beside))
    empty_folder(work.folder, force=work.force)
    found = compare_sensors(Path(plan.table), ship, plan.seed, work.on_progress)
    return result(found, steps, calibrations)


def result(
    found: Sequence[SensorFindings],
    steps: Mapping[str, Sequence[Stretch]] | None = None,
    calibrations: Sequence[Calibration] | None = None,
) -> StudyResult:
    """Sections and pictures; steps and calibrations are those of the further tables."""
    sections = [
        section for one in found for section in (*_statistics_sections(one), _gates_section(one))
    ]
    if steps is not None:
        sections.append(_steps_section(steps))
    if calibrations is not None:
        sections.append(_calibrations_section(calibrations))
    sections.append(_answer_section(found))
    drawings = [
        Drawing(
            'instruments',
            'In each column one haul was measured and one was simulated, with the same axes. '
            'Which is which stands in the last table of instruments.md.',
            pair_figure(found),
        ),
        Drawing(
            'instruments_statistics',
            'Statistics of the simulated hauls of odd numbers (dot: median, line: middle 90 %) '
            'within the middle 90 % of the measured ones (bar; tick: median), scaled by it.',
            statistics_figure(found),
        ),
    ]
    return StudyResult(sections, drawings)


METHOD = (
    'Readings of two acoustic net sensors through the hauls of a bottom trawl survey: '
    'the distance between the wing tips, and the height of the headrope. The simulated '
    'sensor goes through the course of each haul, the running median of what was measured, '
    'for as long; its recorder keeps whole seconds and tenths of a metre as that of the survey '
    'does, and the first reading of each second. Statistics are computed for each haul. Those '
    'of odd numbers judge: the median of the simulated hauls has to lie within the middle '
    '90 % of the measured ones. By those of even numbers the values of the sensors were '
    'chosen. Turns of the ship are in none of the files, so whether readings are lost in '
    'them is not seen.'
)


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
    return [Section(f'The sensor of {name}', rows, tables=[fitted, _noise_table(one)])]


def _noise_table(one: SensorFindings) -> TextTable:
    classes = zip(EDGES_M[:-1], EDGES_M[1:], *one.noise, strict=True)
    return TextTable(
        f'Noise of {one.sensor.name} against the distance, m: robust standard deviation of a '
        'reading about the line through those before and after it, in all hauls; beyond towing '
        'distance the net is shot and hauled, and what it moves by is in it.',
        ('from', 'to', 'measured', 'readings', 'simulated'),
        tuple(
            (f'{low:g}', f'{high:g}', f'{measured:.2f}', str(number), f'{made:.2f}')
            for low, high, (measured, number), (made, _) in classes
            if np.isfinite(measured) and np.isfinite(made)
        ),
    )


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


def _steps_section(steps: Mapping[str, Sequence[Stretch]]) -> Section:
    rows = []
    for sensor, stretches in steps.items():
        correlation, p_value = growth(stretches)
        rows.append(
            MeasuredValue(
                f'{sensor}: rank correlation of wire and share of silence',
                correlation,
                '',
                note=f'p = {p_value:.2g} of {len(stretches)} stretches; simulated sensors fall '
                'silent as often at any depth',
            )
        )
    lengths = sorted({one.wire_m for stretches in steps.values() for one in stretches})
    table = TextTable(
        'Wire, and of each sensor readings per minute and share of the time within silences of '
        'more than 10 s.',
        ('wire / m', *(f'{sensor}: {what}' for sensor in steps for what in ('1/min', 'silent'))),
        tuple(
            (
                f'{wire:.0f}',
                *(cell for stretches in steps.values() for cell in _at_wire(stretches, wire)),
            )
            for wire in lengths
        ),
    )
    return Section('Silences against the length of wire', rows, tables=[table])


def _at_wire(stretches: Sequence[Stretch], wire: float) -> tuple[str, str]:
    there = [one for one in stretches if one.wire_m == wire]
    duration = sum(one.duration_s for one in there)
    if not there:
        return '', ''
    readings, silent = sum(s.readings for s in there), sum(s.silent_s for s in there)
    return f'{60.0 * readings / duration:.1f}', f'{100.0 * silent / duration:.1f} %'


def _gates_section(one: SensorFindings) -> Section:
    gates, name = one.gates, one.sensor.name
    alone = gates.agreement(with_outliers=False)
    rows = [
        MeasuredValue(
            f'{name}: agreement (F1) of the timestamp check with the editors',
            alone,
            '',
            at_least(AGREEMENT),
            f'of {gates.readings} readings the editors rejected {gates.by_editors} '
            f'({_share(gates.by_editors, gates.readings)}), the check {gates.stamps} '
            f'({_share(gates.stamps, gates.readings)}), both {gates.both}: the second of two '
            'readings in one second',
        ),
        MeasuredValue(
            f'{name}: agreement (F1) of all gates with the editors',
            gates.agreement(with_outliers=True),
            '',
            at_least(AGREEMENT),
            f'{gates.off} of {gates.towed} readings while towing '
            f'({_share(gates.off, gates.towed)}) were rejected as false echoes or outliers, '
            f'{gates.off_kept} of which the editors kept: their codes in this file '
            'are those of repeated seconds alone, whatever was read',
        ),
        MeasuredValue(
            f'{name}: windows of a minute with a mean that can be used',
            100.0 * gates.used / gates.windows if gates.windows else np.nan,
            '%',
            note=f'{gates.used} of {gates.windows}; without: '
            + (', '.join(f'{why} {n}' for why, n in sorted(one.reasons.items())) or 'none'),
        ),
    ]
    return Section(
        f'Gates of the estimation on the sensor of {name}',
        rows,
        tables=[_classes_table(one), _hauls_table(one)],
    )


def _share(part: int, whole: int) -> str:
    return f'{100.0 * part / whole:.1f} %' if whole else ''


def _classes_table(one: SensorFindings) -> TextTable:
    readings = {
        kind: sum(haul.counts.get(kind, 0) for haul in one.disagreements) for kind in CLASSES
    }
    return TextTable(
        f'Readings of {one.sensor.name} on which gates and editors differ, by what is wrong with '
        'them; each counts for the first class that fits.',
        ('class', 'what is wrong', 'readings'),
        tuple((kind, CLASSES[kind], str(number)) for kind, number in readings.items()),
    )


def _hauls_table(one: SensorFindings) -> TextTable:
    hauls = [haul for haul in one.disagreements if haul.total > WORST]
    return TextTable(
        f'Hauls in which gates and editors differ on more than {WORST} readings of '
        f'{one.sensor.name}: {len(hauls)} of {len(one.disagreements)}.',
        ('haul', 'readings', 'differing', *CLASSES, 'mostly'),
        tuple(
            (
                str(haul.number),
                str(haul.readings),
                str(haul.total),
                *(str(haul.counts.get(kind, 0)) for kind in CLASSES),
                haul.main,
            )
            for haul in hauls
        ),
    )


def _calibrations_section(calibrations: Sequence[Calibration]) -> Section:
    rows = [
        MeasuredValue(
            f'{one.sensor}: scatter about its line, without rounding',
            one.bias,
            'm',
            note=f'{one.number} readings: scale {100.0 * one.scale_error:+.2f} %, offset '
            f'{one.offset:+.1f} m, scatter {one.scatter:.2f} m, of which rounding '
            f'{one.rounding:.2f} m',
        )
        for one in calibrations
    ]
    return Section('Calibrations', rows)


def _answer_section(found: Sequence[SensorFindings]) -> Section:
    table = TextTable(
        'Of the hauls in the picture.',
        ('sensor', 'measured', 'simulated'),
        tuple(
            (one.sensor.name, *('BA' if SWAPPED[column % len(SWAPPED)] else 'AB'))
            for column, one in enumerate(found)
        ),
    )
    return Section('Which haul was measured', tables=[table])


def pair_figure(found: Sequence[SensorFindings]) -> Figure:
    """Draw a measured haul and a simulated one of each sensor, without saying which is which."""
    figure = Figure(figsize=(11.0, 6.0), layout='constrained')
    axes = figure.subplots(2, len(found), sharex='col', sharey='col', squeeze=False)
    for column, one in enumerate(found):
        pair = one.pair[::-1] if SWAPPED[column % len(SWAPPED)] else one.pair
        start = min(side.time[0] for side in pair)
        for place, letter, side in zip(axes[:, column], 'AB', pair, strict=True):
            place.plot((side.time - start) / 60.0, side.value, '.', color='0.2', markersize=2.5)
            if max(values.max() for values in (side.value for side in pair)) > LOG_FROM:
                place.set_yscale('log')
                place.set_yticks(LOG_TICKS, [f'{tick:g}' for tick in LOG_TICKS])
                place.minorticks_off()
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


STUDY = Study(
    'instruments', 'instruments', 'Range sensors beside measured ones', InstrumentsPlan, {},
    run, lambda plan: METHOD,
)  # fmt: skip
