"""The prose rule finds words to avoid and long sentences, in prose alone."""

from pathlib import Path

import pytest

api = pytest.importorskip('pymarkdown.api', reason='needs pymarkdownlnt, which make installs')
ROOT = Path(__file__).parents[1]
LONG = ' '.join(['word'] * 26)


@pytest.fixture
def found(tmp_path, monkeypatch):
    # The settings are those of pyproject.toml there.
    monkeypatch.chdir(ROOT)

    def scan(text: str) -> list[int]:
        page = tmp_path / 'page.md'
        page.write_text(f'# Page\n\n{text}\n')
        failures = api.PyMarkdownApi().scan_path(str(page)).scan_failures
        return [failure.line_number for failure in failures]

    return scan


@pytest.mark.parametrize(
    'text',
    [
        'The loop is run anew.',
        f'Short. {LONG}.',
        f'- an item\n- {LONG}',
        f'| key | meaning |\n|---|---|\n| a | {LONG} |',
        f'A [link](page.md) and {LONG[:-5]}',
    ],
)
def test_it_is_reported(found, text):
    assert len(found(text)) == 1


@pytest.mark.parametrize(
    'text',
    [
        f'{LONG[:-5]}. {LONG[:-5].capitalize()}.',
        f'One clause of a sentence: {LONG[:-5]}',
        f'```\nrun anew, {LONG}\n```',
        f'The command `{LONG} anew` is code.',
        'Two effects cannot be told apart.',
    ],
)
def test_it_passes(found, text):
    assert found(text) == []
