"""The site builds without a warning, has every public name, and asks no other host for anything."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import trawl_ros

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope='module')
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp('site')
    done = subprocess.run(
        [sys.executable, '-m', 'mkdocs', 'build', '--strict', '--site-dir', str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return folder


def test_every_public_name_is_in_the_reference(site: Path) -> None:
    pages = [page.read_text() for page in (site / 'reference').glob('*.html')]
    there = {name for page in pages for name in re.findall(r'id="trawl_ros\.(\w+)"', page)}
    assert there == set(trawl_ros.__all__)


def test_nothing_is_loaded_from_elsewhere(site: Path) -> None:
    loaded = re.compile(
        r'<(?:script|img|iframe)[^>]*\ssrc="(https?:)?//|<link[^>]*\shref="https?://'
    )
    pages = list(site.rglob('*.html'))
    assert len(pages) > 30
    assert [page.name for page in pages if loaded.search(page.read_text())] == []


def test_all_guides_are_in_the_navigation(site: Path) -> None:
    index = (site / 'guides/index.html').read_text()
    guides = {path.stem for path in (ROOT / 'docs/guides').glob('*.md')} - {'index'}
    assert guides <= set(re.findall(r'href="(?:\./)?(\w+)\.html"', index))
