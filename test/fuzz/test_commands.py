"""No command shows a traceback for a foreign file, nor for a folder that it cannot write to."""

import os
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Literal

import pytest
from hostile.target import command
from hostile.targets.bag_files import MAGIC, record

Role = Literal['bag', 'yaml', 'log']

READERS: dict[str, tuple[Role, tuple[str, ...]]] = {
    'bag check': ('bag', ('bag', 'check', 'FILE')),
    'bag export': ('bag', ('bag', 'export', 'FILE', '--out', 'OUT')),
    'bag info': ('bag', ('bag', 'info', 'FILE')),
    'bag repair': ('bag', ('bag', 'repair', 'FILE', '--out', 'OUT')),
    'plot': ('bag', ('plot', 'FILE', '--out', 'OUT')),
    'identify': ('bag', ('identify', 'FILE', '--out', 'OUT')),
    'diagnose': ('bag', ('diagnose', 'FILE', '--out', 'OUT')),
    'diagnose --baseline': ('bag', ('diagnose', 'BAG', '--baseline', 'FILE', '--out', 'OUT')),
    'plot --gear': ('yaml', ('plot', 'BAG', '--gear', 'FILE', '--out', 'OUT')),
    'identify --gear': ('yaml', ('identify', 'BAG', '--gear', 'FILE', '--out', 'OUT')),
    'identify --truth': ('yaml', ('identify', 'BAG', '--truth', 'FILE', '--out', 'OUT')),
    'diagnose --gear': ('yaml', ('diagnose', 'BAG', '--gear', 'FILE', '--out', 'OUT')),
    'tow': ('yaml', ('tow', 'FILE', '--out', 'OUT')),
    'plan-trial': ('yaml', ('plan-trial', 'FILE', '--out', 'OUT')),
    'trim': ('yaml', ('trim', 'FILE', '--attack', '20', '--inclination', '5')),
    'demo': ('yaml', ('demo', '--scenario', 'FILE', '--out', 'OUT')),
    'import-log --mapping': ('yaml', ('import-log', 'LOG', '--mapping', 'FILE', '--out', 'OUT')),
    'import-log': ('log', ('import-log', 'FILE', '--mapping', 'nmea', '--out', 'OUT')),
    'import-log, a table': (
        'log',
        ('import-log', 'FILE', '--mapping', 'door_test_haul_log', '--out', 'OUT'),
    ),
}
"""All commands by what they read; FILE is hostile, the others are sound."""

LONG = ('tow', 'plan-trial')
SUFFIX: dict[Role, str] = {'bag': '.mcap', 'yaml': '.yaml', 'log': '.log'}


def _sparse(path: Path) -> None:
    with path.open('wb') as file:
        file.truncate(1 << 40)


def _database(path: Path) -> None:
    with closing(sqlite3.connect(path)) as file:
        file.execute('CREATE TABLE topics(id, name, type)')
        file.execute("INSERT INTO topics VALUES(NULL, x'00ff', 9e999)")
        file.commit()
    path.write_bytes(path.read_bytes()[:-1500] + b'\xff' * 1500)


def _folder_with(content: bytes) -> Callable[[Path], object]:
    def made(path: Path) -> None:
        path.mkdir()
        (path / 'metadata.yaml').write_bytes(content)

    return made


KINDS: dict[str, Callable[[Path], object]] = {
    'missing': lambda path: None,
    'empty': lambda path: path.touch(),
    'text': lambda path: path.write_text('dear all,\nthis is a letter: not a bag\n'),
    'half of YAML': lambda path: path.write_text('name: [1, {a: "'),
    'tags': lambda path: path.write_text('name: !!int abc\n? !!str [a]\n: !!map [1]\n'),
    'deep YAML': lambda path: path.write_bytes(b'[' * 100_000),
    'list': lambda path: path.write_text('- 1\n- 2\n'),
    'NUL': lambda path: path.write_bytes(bytes(5000)),
    'latin-1': lambda path: path.write_bytes('name: Trål\n'.encode('latin-1')),
    'MCAP cut short': lambda path: path.write_bytes(MAGIC + record(1, bytes(8))[:-3]),
    'MCAP without content': lambda path: path.write_bytes(MAGIC + record(1, bytes(8))),
    'database': _database,
    'database by its name': lambda path: path.write_bytes(b'SQLite format 3\0' + b'\xff' * 4000),
    'zstd': lambda path: path.write_bytes(b'\x28\xb5\x2f\xfd' + b'\xff' * 40),
    'folder': lambda path: path.mkdir(),
    'folder with metadata': _folder_with(b'rosbag2_bagfile_information: !!bool abc'),
    'folder with metadata that are deep': _folder_with(b'[' * 100_000),
    'pipe': lambda path: os.mkfifo(path),
    'device': lambda path: path.symlink_to('/dev/zero'),
    'file that cannot be read': lambda path: path.symlink_to('/proc/self/mem'),
    'link to itself': lambda path: path.symlink_to(path),
    'a terabyte of zeros': _sparse,
}


@pytest.fixture(scope='session')
def sound(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """A bag and a log with which nothing is wrong, both short."""
    folder = tmp_path_factory.mktemp('sound')
    log = folder / 'log.nmea'
    log.write_text('$GPRMC,103851.00,A,5730.5000,N,15215.2500,W,3.9,090.0,010826,,,A*71\n')
    command('import-log', log, '--mapping', 'nmea', '--out', folder / 'bag')
    return {'LOG': str(log), 'BAG': str(folder / 'bag')}


@pytest.mark.timeout(20)
@pytest.mark.parametrize('kind', KINDS)
@pytest.mark.parametrize('name', READERS)
def test_a_foreign_file_ends_in_a_sentence(
    name: str, kind: str, sound: dict[str, str], tmp_path: Path
) -> None:
    role, words = READERS[name]
    path = tmp_path / f'given{".db3" if "database" in kind and role == "bag" else SUFFIX[role]}'
    KINDS[kind](path)
    before = sorted(tmp_path.rglob('*'))
    places = {'FILE': str(path), 'OUT': str(tmp_path / 'out'), **sound}
    said = command(*(places.get(word, word) for word in words))
    assert 'Error: ' in said or role == 'bag', said
    assert len(max(said.splitlines(), key=len, default='')) < 1500, said
    left = [found for found in sorted(tmp_path.rglob('*')) if found not in before]
    assert not [found for found in left if found.is_file()] or 'Error: ' not in said


@pytest.mark.timeout(20)
@pytest.mark.parametrize(
    'name',
    # Those two work for long before they write.
    [name for name, (_, words) in READERS.items() if 'OUT' in words and words[0] not in LONG],
)
@pytest.mark.parametrize('out', ['/proc/out', '/dev/full', '/dev/null/out', 'FILE/out', 'x' * 300])
def test_a_folder_that_cannot_be_written_to_ends_in_a_sentence(
    name: str, out: str, sound: dict[str, str], tmp_path: Path
) -> None:
    role, words = READERS[name]
    own = {'bag': sound['BAG'], 'log': sound['LOG'], 'yaml': _packaged(name)}
    (tmp_path / 'FILE').write_text('mine')
    out = out if out.startswith('/') else str(tmp_path / out)
    places = {**sound, 'FILE': own[role], 'OUT': out}
    assert 'Error: ' in command(*(places.get(word, word) for word in words))
    assert (tmp_path / 'FILE').read_text() == 'mine'


@pytest.mark.timeout(20)
@pytest.mark.parametrize('name', READERS)
def test_a_working_folder_that_is_gone_ends_in_a_sentence(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / 'gone').mkdir()
    monkeypatch.chdir(tmp_path / 'gone')
    (tmp_path / 'gone').rmdir()
    assert 'Error: ' in command(*READERS[name][1])


def _packaged(name: str) -> str:
    """Name of a sound file for an argument that is YAML."""
    if name in ('tow', 'demo', 'identify --truth'):
        return 'demo'
    return 'nmea' if name.startswith('import') else 'kaifuha'
