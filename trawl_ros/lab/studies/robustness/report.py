"""Report of the study of robustness: JSON, Markdown and HTML."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.lab.studies.robustness.study import RobustnessTrial

REPORT = 'robustness.md'


def write_robustness(folder: Path, trials: Sequence[RobustnessTrial]) -> list[MeasuredValue]:
    """Write ``robustness.json``, ``.md`` and ``.html`` into a folder."""
    values = [trial for trial in trials if trial.part == 'values']
    hours = [trial for trial in trials if trial.part == 'commands']
    page = Page(
        name='robustness',
        title='Changed gears, and hours of random commands',
        command='trawl study robustness',
        method='Each number of the gear file is changed by a fifth, one at a time, and the gear '
        'towed at 2.1 m/s. An hour of random commands ends with a quarter of an hour straight on '
        f'at 2.4 m/s. Meshes around the net: {_meshes(trials)}.',
    )
    sections = [
        Section('Changed values', _of_values(values), tables=[_refusals(values)]),
        Section('Random commands', _of_hours(hours)),
    ]
    record: dict[str, object] = {'trials': [asdict(trial) for trial in trials]}
    return write_page(folder, page, sections, record=record)


def _meshes(trials: Sequence[RobustnessTrial]) -> str:
    return ', '.join(str(around) for around in sorted({trial.around for trial in trials}))


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
    return [
        MeasuredValue(
            'hours that ended before their time',
            len(failed),
            target=at_most(0.0),
            note=f'Of {len(trials)}. '
            + '; '.join(f'{trial.name}: {trial.sentence}' for trial in failed[:5]),
            key='failed',
        ),
        MeasuredValue('hours in which a board fell', len(fell), key='fell'),
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
