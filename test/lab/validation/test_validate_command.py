"""``trawl validate``: its report, and what the committed one says."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.lab.validation.cases import NAMES, load_case

DOCS = Path(__file__).parents[3] / 'docs' / 'validation'


def test_a_few_cases_make_a_report(tmp_path: Path) -> None:
    out = tmp_path / 'report'
    done = CliRunner().invoke(
        trawl, ['validate', 'board_law', 'towed_wire', '--quick', '--out', str(out)]
    )
    assert done.exit_code == 0, done.output
    figures = json.loads((out / 'validation.json').read_text())
    assert {key.split('.')[0] for key in figures} == {'board_law', 'towed_wire'}
    for key, figure in figures.items():
        assert {'measured', 'expected', 'tolerance', 'ok'} <= set(figure), key
        assert figure['ok'], key
    for name in ('report.html', 'report.md'):
        text = (out / name).read_text()
        for picture in (out / 'figures').iterdir():
            assert f'figures/{picture.name}' in text


def test_an_unknown_case_is_named_with_those_there_are(tmp_path: Path) -> None:
    done = CliRunner().invoke(trawl, ['validate', 'towed_whale', '--out', str(tmp_path / 'out')])
    assert done.exit_code == 1
    assert 'towed_whale' in done.output
    assert 'towed_wire' in done.output
    assert not (tmp_path / 'out').exists()


def test_an_earlier_report_is_not_written_over(tmp_path: Path) -> None:
    (tmp_path / 'report.md').write_text('mine')
    done = CliRunner().invoke(trawl, ['validate', 'board_law', '--out', str(tmp_path)])
    assert done.exit_code == 1
    assert (tmp_path / 'report.md').read_text() == 'mine'


@pytest.mark.parametrize('name', NAMES)
def test_every_case_is_called_as_its_module(name: str) -> None:
    assert load_case(name).name == name


def test_the_committed_report_has_every_case_and_a_reason_for_what_does_not_hold() -> None:
    figures = json.loads((DOCS / 'validation.json').read_text())
    # The table of the flume tank lies beside the checkout, and need not be there.
    assert set(NAMES) - {key.split('.')[0] for key in figures} <= {'flume'}
    for key, figure in figures.items():
        assert figure['ok'] or len(figure['note']) > 20, key
    report = (DOCS / 'report.md').read_text()
    for picture in (DOCS / 'figures').iterdir():
        assert f'figures/{picture.name}' in report
