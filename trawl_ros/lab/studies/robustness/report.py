"""Report of the study of robustness: JSON, Markdown and HTML."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from matplotlib.figure import Figure

from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.lab.report.rates import rate
from trawl_ros.lab.studies.robustness.study import RobustnessTrial
from trawl_ros.report.pictures import Drawing

REPORT = 'robustness.md'

ASKED = 1000
"""Hours of random commands asked for: with none that fails, fewer than 0.4 % do."""


def write_robustness(folder: Path, trials: Sequence[RobustnessTrial]) -> list[MeasuredValue]:
    """Write ``robustness.json``, ``.md``, ``.html`` and, of hours, ``.png`` into a folder."""
    values = [trial for trial in trials if trial.part == 'values']
    hours = [trial for trial in trials if trial.part == 'commands']
    page = Page(
        name='robustness',
        title='Changed gears, and hours of random commands',
        command='trawl study robustness',
        method='Each number of the gear file is changed by a fifth, one at a time, and the gear '
        'towed at 2.1 m/s. An hour of random commands ends with a quarter of an hour straight on '
        f'at 2.4 m/s. Meshes around the net: {_meshes(values)} for changed values, '
        f'{_meshes(hours)} for hours.',
    )
    sections = [
        Section('Changed values', _of_values(values), tables=[_refusals(values)]),
        Section('Random commands', _of_hours(hours)),
    ]
    caption = 'Hours of random commands, by the time with a fallen board, the longest first.'
    drawings = [Drawing('robustness', caption, _figure(hours))] if hours else []
    record: dict[str, object] = {'trials': [asdict(trial) for trial in trials]}
    return write_page(folder, page, sections, drawings, record=record)


def _meshes(trials: Sequence[RobustnessTrial]) -> str:
    counts = sorted({trial.around for trial in trials})
    return ' and '.join(str(around) for around in counts) or 'none'


def _of_values(trials: Sequence[RobustnessTrial]) -> list[MeasuredValue]:
    if not trials:
        return []
    counts = Counter(trial.outcome for trial in trials)
    words = ', '.join(f'{number} {outcome}' for outcome, number in counts.most_common())
    return [
        MeasuredValue(
            'changed gears without steady state or physical reason',
            counts['none found'],
            target=at_most(0.0),
            note=f'Of {len(trials)}: {words}.',
            key='none_found',
        ),
        MeasuredValue(
            'longest CPU time of an answer',
            max(trial.seconds for trial in trials),
            's',
            at_most(2.0),
            key='longest',
        ),
    ]


def _of_hours(trials: Sequence[RobustnessTrial]) -> list[MeasuredValue]:
    if not trials:
        return []
    failed = [trial for trial in trials if trial.outcome == 'failed']
    fell = [trial for trial in trials if trial.fallen_s]
    lying = [trial for trial in fell if trial.fallen_at_end and trial.outcome == 'towed']
    cost = sum(trial.seconds for trial in trials) / len(trials)
    return [
        MeasuredValue(
            'hours of random commands',
            len(trials),
            target=at_least(ASKED),
            note=f'An hour takes {cost:.1f} s of processor on average. A study that goes on in the '
            'same folder adds to them.',
            key='hours',
        ),
        MeasuredValue(
            'hours that ended before their time',
            len(failed),
            target=at_most(0.0),
            note=f'Of {len(trials)}. '
            + '; '.join(f'{trial.name}: {trial.sentence}' for trial in failed[:5]),
            key='failed',
        ),
        rate(
            'share of hours that ended before their time',
            [trial.outcome == 'failed' for trial in trials],
        ),
        MeasuredValue(
            'hours in which a board fell', len(fell), note='And the tow went on.', key='fell'
        ),
        MeasuredValue(
            'hours after which a board lay still', len(lying),
            note='A quarter of an hour after the gear was sped up.', key='lying',
        ),
    ]  # fmt: skip


def _refusals(trials: Sequence[RobustnessTrial]) -> TextTable:
    rows = [
        (trial.name, trial.outcome, trial.sentence) for trial in trials if trial.outcome != 'usable'
    ]
    return TextTable('Gears that cannot be towed', ('change', 'reason', 'in words'), tuple(rows))


def _figure(hours: Sequence[RobustnessTrial]) -> Figure:
    figure = Figure(figsize=(7.5, 4.0), layout='constrained')
    axes = figure.subplots()
    minutes = sorted((trial.fallen_s / 60.0 for trial in hours), reverse=True)
    axes.step(range(1, len(minutes) + 1), minutes, where='mid')
    axes.set_xlim(0.5, len(minutes) + 0.5)
    axes.set_ylim(0.0, 60.0)
    axes.set_xlabel('hour, the one with the most first')
    axes.set_ylabel('time with a fallen board (min)')
    axes.grid(alpha=0.3)
    return figure
