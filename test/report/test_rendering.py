"""Whatever others named is text on every page."""

from pathlib import Path

import pytest

import trawl_ros
from trawl_ros.report import rendering

ROOT = Path(trawl_ros.__file__).parents[1]
PAGES = sorted((ROOT / 'trawl_ros').rglob('templates/*.html.j2'))


@pytest.mark.parametrize('path', PAGES, ids=lambda path: f'{path.parts[-3]}/{path.name}')
def test_every_html_page_escapes_what_is_filled_in(path: Path) -> None:
    environment = rendering._templates('.'.join(path.relative_to(ROOT).parts[:-2]))
    assert callable(environment.autoescape)
    assert environment.autoescape(environment.get_template(path.name).name)


def test_there_are_pages() -> None:
    assert len(PAGES) >= 5


def test_markdown_shows_signs_as_they_are() -> None:
    assert rendering.foreign('<b> a|b\n# c `d`') == '\\<b\\> a\\|b \\# c \\`d\\`'
