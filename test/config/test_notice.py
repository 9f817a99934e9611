"""NOTICE names the source of every figure that the configuration takes from others."""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
FILES = [
    path
    for folder in ('doors', 'gear', 'hauls', 'panels')
    for path in sorted((ROOT / 'config' / folder).glob('*.yaml'))
]


def flat(text: str) -> str:
    return ' '.join(text.split())


@pytest.fixture(scope='module')
def notice() -> str:
    return flat((ROOT / 'NOTICE').read_text('utf-8'))


def sources(data: object) -> Iterator[str]:
    """Titles of the named sources of a file, and other sources that it gives in words."""
    if isinstance(data, list):
        for entry in data:
            yield from sources(entry)
    if isinstance(data, dict):
        for key, value in data.items():
            if key == 'sources':
                yield from (source['title'] for source in value.values())
            elif key == 'source' and ' ' in value:
                yield value
            elif key != 'not_used':
                yield from sources(value)


@pytest.mark.parametrize('path', FILES, ids=lambda path: f'{path.parent.name}/{path.name}')
def test_a_file_and_its_sources_are_named(path: Path, notice: str) -> None:
    assert f'config/{path.parent.name}/{path.name}' in notice
    text = path.read_text('utf-8')
    named = [flat(source) for source in sources(yaml.safe_load(text))]
    head = text.split('name:')[0] if path.parent.name == 'gear' else ''
    named += re.findall(r'https?://[^\s,;]+[^\s,;.]', head)
    named += re.findall(r'\w+\.yaml(?=, CC BY)', head)
    assert [source for source in named if source not in notice] == []


def test_doors_hauls_and_panels_give_sources() -> None:
    for path in FILES:
        if path.parent.name in ('doors', 'hauls', 'panels'):
            assert list(sources(yaml.safe_load(path.read_text('utf-8'))))


def test_licence_and_notice_come_with_the_package(tmp_path: Path) -> None:
    command = [sys.executable, 'setup.py', '-q', 'egg_info', '--egg-base', str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=60)
    made = tmp_path / 'trawl_ros.egg-info'
    # Wheels take the files that the metadata names, source archives those of the list.
    wheel = re.findall(r'^License-File: (.*)$', (made / 'PKG-INFO').read_text(), re.MULTILINE)
    assert {'LICENSE', 'NOTICE'} <= set(wheel)
    assert {'LICENSE', 'NOTICE'} <= set((made / 'SOURCES.txt').read_text().splitlines())
