"""`trawl benchmark` writes a report that says all it was asked for."""

import json

import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.benchmark import modules
from trawl_ros.lab.benchmark.modules import NAMES
from trawl_ros.lab.report.machine import cpu_model, software
from trawl_ros.lab.report.page import Findings

KEYS = {'what', 'value', 'low', 'high', 'unit', 'target', 'ok', 'note'}


def run(*arguments):
    return CliRunner().invoke(trawl, ['benchmark', *map(str, arguments)])


@pytest.mark.parametrize(
    'name',
    [pytest.param(name, marks=pytest.mark.slow if name == 'commands' else ()) for name in NAMES],
)
def test_every_module_runs_in_its_small_version(name, tmp_path):
    result = run('--quick', '--out', tmp_path, name)
    assert result.exit_code == 0, result.output
    rows = json.loads((tmp_path / 'benchmark.json').read_text())['rows']
    assert rows
    assert all(set(row) == KEYS for row in rows)
    # What it measures on so little says nothing; what breaks off or lacks a reason does.
    assert not any(row['what'].endswith('to its end') for row in rows), rows
    assert all(row['ok'] or row['note'] for row in rows)
    report = (tmp_path / 'benchmark.md').read_text()
    assert all(row['what'] in report for row in rows)
    assert 'small version' in report
    assert cpu_model() in report
    assert all(version in report for version in software().values())
    for line in report.splitlines():
        if line.startswith('!['):
            assert (tmp_path / line.rpartition('(')[2].rstrip(')')).is_file()


@pytest.mark.parametrize('name', ['start', 'recording'])
def test_without_ros_figures_of_nodes_are_missed_and_it_is_said_why(name, tmp_path, monkeypatch):
    monkeypatch.setattr(modules, 'find_spec', lambda _: None)
    result = run('--quick', '--out', tmp_path, name)
    assert result.exit_code == 0, result.output
    (row,) = json.loads((tmp_path / 'benchmark.json').read_text())['rows']
    assert (row['value'], row['ok']) == (None, False)
    assert row['note'].startswith('rclpy ')


def test_a_name_that_is_none_is_refused_with_those_that_are(tmp_path):
    result = run('--out', tmp_path, 'geer')
    assert result.exit_code == 1
    assert result.output.startswith('Error: geer: ')
    assert 'gear, ' in result.output


def test_files_are_not_written_over_unasked(tmp_path):
    (tmp_path / 'mine.txt').write_text('kept')
    result = run('--out', tmp_path, 'equilibrium')
    assert result.exit_code == 1
    assert 'holds files already' in result.output
    assert [file.name for file in tmp_path.iterdir()] == ['mine.txt']


class _Module:
    """Stands where a module of the benchmark would."""

    def __init__(self, error):
        self.error = error

    def measure(self, quick) -> Findings:
        raise self.error


def test_what_breaks_off_is_a_row_that_is_missed(monkeypatch, tmp_path):
    broken = _Module(TrawlError('ropes tangled'))
    monkeypatch.setattr(modules, 'import_module', lambda name: broken)
    result = run('--out', tmp_path, 'gear')
    assert result.exit_code == 0
    (row,) = json.loads((tmp_path / 'benchmark.json').read_text())['rows']
    assert (row['ok'], row['note']) == (False, 'ropes tangled')
    assert '0 of 1 targets' in result.output


def test_ctrl_c_ends_it_without_a_report(monkeypatch, tmp_path):
    monkeypatch.setattr(modules, 'import_module', lambda name: _Module(KeyboardInterrupt()))
    result = run('--out', tmp_path, 'gear')
    assert result.exit_code == 130
    assert list(tmp_path.iterdir()) == []
