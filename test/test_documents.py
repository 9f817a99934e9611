"""Documents name only files, folders, modules and links that there are."""

import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest
from count_words import count_words

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / 'trawl_ros'
DOCUMENTS = [*sorted(ROOT.glob('*.md')), *sorted((ROOT / 'docs').rglob('*.md'))]
FOLDERS = {path.name for base in (ROOT, PACKAGE) for path in base.iterdir() if path.is_dir()}
PLACEHOLDER = re.compile(r'[A-Z]{3,}')
"""A name that the reader is to put in, as in ``config/gear/NAME.yaml``."""
MOST_WORDS = 28_000
"""Longest that all pages by hand may be: CONTRIBUTING.md."""
MOST_WORDS_OF_README = 700


def names(document: Path) -> Iterator[str]:
    """All that a document sets as code, within lines."""
    text = re.sub(r'^```.*?^```', '', document.read_text('utf-8'), flags=re.DOTALL | re.MULTILINE)
    yield from re.findall(r'`([^`\n]+)`', text)


def there_is(name: str) -> bool:
    """True if a path from the root, from the package or from docs leads to something."""
    return any(list(base.glob(name.rstrip('/'))) for base in (ROOT, PACKAGE, ROOT / 'docs'))


@pytest.mark.parametrize('document', DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_each_named_path_exists(document: Path) -> None:
    wrong = []
    for name in names(document):
        if PLACEHOLDER.search(name.partition('.')[0].rpartition('/')[2]):
            name = name.rpartition('/')[0]
        path = re.fullmatch(r'([\w.-]+)/[\w./*-]*', name)
        if path and path[1] in FOLDERS - {'out'} and not there_is(name):
            wrong.append(name)
        if re.fullmatch(r'\w+\.py', name):
            there = [*ROOT.glob(name), *PACKAGE.rglob(name), *(ROOT / 'test').rglob(name)]
            wrong += [] if there else [name]
        if re.fullmatch(r'trawl_ros(\.\w+)+', name) and document.name != 'CHANGELOG.md':
            wrong += [] if is_importable(name) else [name]
    assert wrong == []


def is_importable(name: str) -> bool:
    """True if a module, or a name in one, can be imported."""
    parent, _, last = name.rpartition('.')
    if ROOT.joinpath(*name.split('.')).with_suffix('.py').exists():
        return True
    return hasattr(import_module(parent), last)


@pytest.mark.parametrize('document', DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_each_link_leads_somewhere(document: Path) -> None:
    links = re.findall(r'\]\(([^)#\s]+)', document.read_text('utf-8'))
    own = [link for link in links if not re.match(r'\w+:', link)]
    assert [link for link in own if not (document.parent / link).exists()] == []


def test_pages_by_hand_are_short() -> None:
    words = count_words()
    assert words['README.md'] <= MOST_WORDS_OF_README
    assert sum(words.values()) <= MOST_WORDS, 'python test/tools/count_words.py counts each page'


def linked_pages(page: Path) -> set[Path]:
    links = re.findall(r'\]\(([^)#\s:]+\.md)', page.read_text('utf-8'))
    return {(page.parent / link).resolve() for link in links}


@pytest.mark.parametrize('start', ['README.md', 'docs/index.md'])
def test_answers_to_a_strangers_questions_are_two_clicks_away(start: str) -> None:
    near = {ROOT / start} | linked_pages(ROOT / start)
    near |= set().union(*map(linked_pages, near))
    _, questions = (ROOT / 'CONTRIBUTING.md').read_text('utf-8').split('## Ten questions')
    answers = {
        (ROOT / link).resolve()
        for row in re.findall(r'^\| .+\? \| (.+) \|$', questions, re.MULTILINE)
        for link in re.findall(r'\]\(([^)#\s]+)', row)
    }
    assert len(answers) >= 10
    assert answers - near == set()
