"""The harness of studies: options, shards, resuming, and the page from rows of an earlier run."""

import json
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path

import pytest

from studies.__main__ import NAMES
from studies.harness import Study, StudyResult, Work, main, option, parser, render, run_study
from studies.kept import KeptTrials, TrialTask
from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most, between
from trawl_ros.lab.report.page import Section

DOCS = Path(__file__).parents[2] / 'docs' / 'studies'


@dataclass(frozen=True)
class Toss:
    series: str
    number: int
    value: float


@dataclass(frozen=True)
class TossPlan:
    seed: int = option(3, 'Of all trials.')
    tosses: int = option(4, 'Number of trials.')
    loud: bool = option(False, 'Say more.')

    def tasks(self):
        return [TrialTask('toss', number, self.seed, 'none') for number in range(self.tosses)]


def toss(task):
    return Toss(task.series, task.number, float(task.rng().random()))


def toss_rows(plan, work):
    kept = work.trials({'seed': plan.seed}, Toss, toss, plan.tasks())
    values = [one.value for one in kept.series('toss')]
    rows = [
        MeasuredValue('tosses', len(values), target=at_least(2)),
        MeasuredValue('largest', max(values), target=at_most(1.0), low=0.0),
        MeasuredValue('mean', sum(values) / len(values), 'm', between(0.9, 1.0), 'a note'),
    ]
    return StudyResult([Section('Values', rows[:2]), Section('Mean', rows[2:])])


STUDY = Study(
    'toss', 'toss', 'Tosses', TossPlan, {'tosses': 2}, toss_rows, lambda plan: 'By chance.'
)


def test_fields_of_a_plan_are_options_and_the_command_has_those_that_differ(tmp_path, capsys):
    main(STUDY, ['--quick', '--loud', '--out', str(tmp_path), '--workers', '1'])
    assert '2 of 3 targets are reached' in capsys.readouterr().out
    assert "make study NAME=toss ARGS='--tosses 2 --loud'" in (tmp_path / 'toss.md').read_text()
    assert len((tmp_path / 'trials.jsonl').read_text().splitlines()) == 3
    assert STUDY.command(TossPlan()) == 'make study NAME=toss'


def test_shards_make_all_trials_between_them_and_a_study_resumes(tmp_path):
    plan = TossPlan()
    for part in (1, 2):
        run_study(STUDY, plan, Work(tmp_path, workers=1, shard=(part, 2)))
    assert len(list(tmp_path.glob('trials_*_of_2.jsonl'))) == 2
    steps = []
    rows = run_study(STUDY, plan, Work(tmp_path, steps.append, workers=1))
    assert rows[0].value == 4.0
    assert steps[-1].total == 0


def test_a_page_is_rendered_again_from_its_rows(tmp_path):
    rows = run_study(STUDY, TossPlan(), Work(tmp_path / 'one', workers=1))
    again = render(STUDY, tmp_path / 'one' / 'toss.json', tmp_path / 'two')
    assert [replace(row, target=None) for row in again[1:2]] == [replace(rows[1], target=None,
            high=again[1].high)]  # fmt: skip
    one, two = (json.loads((tmp_path / name / 'toss.json').read_text()) for name in ('one', 'two'))
    assert one == two
    assert '## Mean' in (tmp_path / 'two' / 'toss.md').read_text()


@pytest.mark.parametrize('name', NAMES)
def test_the_committed_rows_of_each_study_can_be_rendered(name, tmp_path):
    study = import_module(f'studies.{name}.study').STUDY
    assert parser(study).format_help()
    committed = json.loads((DOCS / f'{study.page}.json').read_text())
    rows = render(study, DOCS / f'{study.page}.json', tmp_path)
    assert [row.what for row in rows] == [row['what'] for row in committed['rows']]
    assert [row.ok for row in rows] == [row['ok'] for row in committed['rows']]


def test_a_row_that_says_it_is_reached_and_is_not_is_refused(tmp_path):
    row = MeasuredValue('height', 2.0, 'm', at_most(1.0)).record() | {'ok': True}
    path = tmp_path / 'toss.json'
    path.write_text(json.dumps({'rows': [row]}))
    with pytest.raises(TrawlError, match='height: found ok True'):
        render(STUDY, path, tmp_path / 'out')


def test_trials_are_kept_and_a_line_without_its_end_is_made_again(tmp_path):
    first, second, third = (Toss('toss', number, 0.5) for number in range(3))
    kept = KeptTrials(tmp_path, {'seed': 1}, Toss)
    kept.add(first)
    kept.add(second)
    path = kept.path
    path.write_text(path.read_text() + '{"series": "toss", "num')
    again = KeptTrials(tmp_path, {'seed': 1}, Toss)
    assert again.series('toss') == (first, second)
    again.add(third)
    assert KeptTrials(tmp_path, {'seed': 1}, Toss).series('toss') == (first, second, third)
    assert not KeptTrials(tmp_path, {'seed': 1}, Toss, force=True).has('toss', 0)


def test_trials_of_other_settings_are_refused(tmp_path):
    kept = KeptTrials(tmp_path, {'seed': 1, 'around': 12}, Toss)
    with pytest.raises(TrawlError, match=r'seed 1.*expected seed 2.*--force'):
        KeptTrials(tmp_path, {'seed': 2, 'around': 12}, Toss)
    kept.path.unlink()
    (tmp_path / 'report.md').write_text('of somebody else')
    with pytest.raises(TrawlError, match='holds files already'):
        KeptTrials(tmp_path, {'seed': 1, 'around': 12}, Toss)
    kept.path.write_text('notes\n')
    with pytest.raises(TrawlError, match='not a file of trials'):
        KeptTrials(tmp_path, {'seed': 1, 'around': 12}, Toss)
