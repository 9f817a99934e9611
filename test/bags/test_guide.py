"""What `docs/bags.md` prints is what its commands print."""

import re
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / 'docs/bags.md').read_text()
BLOCKS = [
    (found[1], found[2]) for found in re.finditer(r'^```(\w*)\n(.*?)^```$', GUIDE, re.M | re.S)
]
CUT = 1_700_000
PROGRESS = ('exporting:', 'repairing:')
"""What is said every ten seconds on a slow machine."""


def block(kind, beginning=''):
    (text,) = [text for name, text in BLOCKS if name == kind and text.startswith(beginning)]
    return text


def printed():
    """Give (command, lines it prints) of all console blocks, in their order."""
    for kind, text in BLOCKS:
        if kind == 'console':
            for part in text.split('$ trawl ')[1:]:
                command, _, lines = part.partition('\n')
                yield command, lines.splitlines()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    shutil.copytree(ROOT / 'bags/sea_trial', tmp_path / 'sea_trial')
    (tmp_path / 'bridge.csv').write_text(block('csv'))
    (tmp_path / 'bridge.yaml').write_text(block('yaml'))
    (tmp_path / 'ship.nmea').write_text(block('', '$GP'))
    assert f'head -c {CUT} sea_trial/sea_trial_0.mcap > cut.mcap' in GUIDE
    whole = (tmp_path / 'sea_trial/sea_trial_0.mcap').read_bytes()
    (tmp_path / 'cut.mcap').write_bytes(whole[:CUT])
    monkeypatch.chdir(tmp_path)


def test_the_commands_of_the_guide_print_what_it_says(folder):
    commands = list(printed())
    assert len(commands) == 7
    for command, expected in commands:
        output = CliRunner().invoke(trawl, command.split()).output
        lines = [line.rstrip() for line in output.splitlines() if not line.startswith(PROGRESS)]
        skipping = False
        for line in expected:
            if line == '…':
                skipping = True
                continue
            assert line in lines, f'{command}: {line}\n' + '\n'.join(lines)
            place = lines.index(line)
            assert place == 0 or skipping, f'{command}: before {line}\n' + '\n'.join(lines)
            lines = lines[place + 1 :]
            skipping = False
        assert lines == [] or skipping, command
