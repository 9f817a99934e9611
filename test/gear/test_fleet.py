"""The gears that come with the package: each loads, is checked, and is drawn."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from trawl_ros.api.gear_check import check_gear
from trawl_ros.cli.main import trawl
from trawl_ros.core.resources import share_path
from trawl_ros.gear.load import load_gear

FLEET = sorted(path.stem for path in share_path('config', 'gear').glob('*.yaml'))

GATHERED = {
    # Their plans sew these sections to wider ones: see the gear files.
    'harstad_1436': ('pieces[8]', 'pieces[9]'),
    'krill_1420': ('pieces[7]', 'pieces[8]'),
}


def test_there_are_at_least_six() -> None:
    assert len(FLEET) >= 6


@pytest.mark.parametrize('name', FLEET)
def test_a_gear_is_named_as_its_file_and_cites_its_source(name: str) -> None:
    path = share_path('config', 'gear', f'{name}.yaml')
    assert load_gear(name).name == name
    head = path.read_text().split('name:')[0]
    assert any(word in head for word in ('paper', 'http', 'published.yaml'))


@pytest.mark.parametrize('name', [name for name in FLEET if name != 'kaifuha'])
def test_a_planned_gear_is_checked_and_drawn(name: str, tmp_path: Path) -> None:
    found = check_gear(name).findings
    expected = GATHERED.get(name, ())
    assert len(found) == len(expected), found
    for part, finding in zip(expected, found, strict=True):
        assert part in finding.key
    done = CliRunner().invoke(trawl, ['gear', 'check', name, '--out', str(tmp_path / 'out')])
    assert done.exit_code == (3 if expected else 0), done.output
    assert {path.name for path in (tmp_path / 'out').iterdir()} == {'gear.png', 'net_plan.png'}
