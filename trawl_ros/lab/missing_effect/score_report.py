# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Report of scores: a column for each method, reliability, and pairs that are confused."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from trawl_ros.core.version import __version__
from trawl_ros.lab.missing_effect.calibration import (
    CalibrationOptions,
    Case,
    confusion,
    likeliest,
    reliability,
    with_probabilities,
)
from trawl_ros.lab.missing_effect.plan import SERIES_SHARES
from trawl_ros.lab.missing_effect.records import AnswersRecord, KeyRecord
from trawl_ros.lab.missing_effect.scoring import all_sections
from trawl_ros.lab.report.machine import cpu_model
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.lab.trials.making import MAKING_OPTIONS
from trawl_ros.lab.trials.plant import FINER_MESH
from trawl_ros.report.pictures import Drawing
from trawl_ros.report.style import FAINT, MEASURED, quiet

COMPARED = ('Names', 'Probabilities', 'Sizes and repairs')
"""Sections whose rows are compared between methods."""

FIGURE_COLUMNS = 3
"""Largest number of reliability diagrams next to each other."""


def cases_of(key: KeyRecord, answers: AnswersRecord) -> list[Case]:
    """Return the truth of each trial with its answer."""
    return [(truth, answers.trials[name]) for name, truth in key.trials.items()]


def comparison_table(methods: Mapping[str, Sequence[Case]]) -> TextTable:
    """Return a table with a row for each measured value, and a column for each method."""
    rows: dict[str, dict[str, MeasuredValue]] = {}
    for name, cases in methods.items():
        for section in all_sections(cases):
            for row in section.rows if section.title in COMPARED else ():
                if not row.what.startswith('likeliest claim'):
                    rows.setdefault(row.what, {})[name] = row
    return TextTable(
        'Methods on the same trials',
        ('what', 'asked for', *methods),
        tuple(
            (what, next(iter(own.values())).wanted, *(_figure(own[name]) for name in methods))
            for what, own in rows.items()
        ),
    )


def _figure(row: MeasuredValue) -> str:
    """Return a value for a table, or a dash."""
    if row.value != row.value:
        return '–'
    counted = row.note.partition(';')[0]
    return f'{row.figure} ({counted})' if ' of ' in counted and row.unit == '%' else row.figure


def confusion_table(cases: Sequence[Case]) -> TextTable:
    """Return the ten likeliest pairs of what is hidden and what else is claimed."""
    return TextTable(
        'Likeliest confusions',
        ('hidden', 'claimed', 'mean probability', 'trials'),
        tuple(
            (hidden, claimed.replace('_', ' '), f'{probability:.2f}', str(number))
            for hidden, claimed, probability, number in confusion(cases)
        ),
    )


def reliability_figure(
    methods: Mapping[str, Sequence[Case]], options: CalibrationOptions
) -> Figure:
    """Draw stated probability against the share that is right, with exact 95 % intervals."""
    columns = min(FIGURE_COLUMNS, len(methods))
    rows = -(-len(methods) // columns)
    figure = Figure(figsize=(2.9 * columns + 0.6, 3.1 * rows + 0.3), layout='constrained')
    axes = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
    for own in axes[len(methods) :]:
        own.set_visible(False)
    for own, (name, cases) in zip(axes, methods.items(), strict=False):
        found = [likeliest(case) for case in with_probabilities(cases)]
        own.plot([0.0, 1.0], [0.0, 1.0], color=FAINT, linewidth=1.0)
        for part in reliability(found, options):
            low, high = part.interval
            own.plot([part.mean, part.mean], [low, high], color=MEASURED, linewidth=1.5)
            own.plot(part.mean, part.right / part.number, 'o', color=MEASURED)
            own.annotate(
                f'{part.number}', (part.mean, low), (0, -10),
                textcoords='offset points', ha='center', fontsize=8,
            )  # fmt: skip
        own.set(xlim=(0.0, 1.03), ylim=(-0.09, 1.06), title=name)
        own.title.set_fontsize(9)
        quiet(own)
    figure.supxlabel('stated probability', fontsize=10)
    figure.supylabel('share that is right', fontsize=10)
    return figure


def reliability_drawing(
    methods: Mapping[str, Sequence[Case]], options: CalibrationOptions
) -> Drawing:
    """Return the reliability diagrams with their caption."""
    return Drawing(
        'missing_effect_reliability',
        'Likeliest claim of each answer: stated probability, share that is right with its exact '
        '95 % interval, and number of trials.',
        reliability_figure(methods, options),
    )


def trials_words() -> str:
    """Return how trials are made, in sentences."""
    return (
        'A trial has one baseline and three tows of three steady states. All decide; the '
        f'errors are compared on the second. The plant is not the model: {FINER_MESH}, and '
        'netting of another law of drag. '
        'Windows are computed from linearised steady states; noise and offsets are '
        f'{MAKING_OPTIONS.sensor_deviation:.0%} larger or smaller than stated. The strength of a '
        'cause is a multiple of the smallest size that the likelihood of the plant can show. '
        'Right names were fixed before (`trawl_ros/lab/trials/answers.py`).'
    )


def _counted(key: KeyRecord) -> str:
    every = [truth.series for truth in key.trials.values()]
    counts = ', '.join(f'{every.count(series)} {series}' for series in SERIES_SHARES)
    return (
        f'{len(every)} trials of seed {key.seed} ({counts}; {len(key.not_possible)} draws were not '
        f'possible), gear {key.gear}, form {key.form}. On {cpu_model()}, trawl_ros {__version__}.'
    )


def write_score(
    folder: Path,
    command: str,
    key: KeyRecord,
    methods: Mapping[str, Sequence[Case]],
    options: CalibrationOptions | None = None,
) -> None:
    """Write ``missing_effect.md``, ``.html``, ``.json`` and the figure into a folder.

    The sections after the table of all methods are those of the first method.
    """
    options = options or CalibrationOptions()
    name, cases = next(iter(methods.items()))
    sections = [
        Section('All methods', tables=[comparison_table(methods)]),
        *all_sections(cases, options),
        Section('Confusions', tables=[confusion_table(cases)]),
    ]
    title = f'Benchmark of missing effects: {name}'
    page = Page('missing_effect', title, command, f'{trials_words()} {_counted(key)}')
    write_page(folder, page, sections, [reliability_drawing(methods, options)])
