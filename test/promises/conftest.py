"""One test per command of README and docs, and the table of how long each takes."""

import re
from collections.abc import Iterator

import pytest
from promised.documents import ROOT, TABLE, Document, Promise, read_document
from promised.story import NOT_RUN, Story, by_beginning

SLOW_S = 4.0
LONG_S = 240.0
UNKNOWN_S = 600.0
DOCUMENTS = [
    read_document(path)
    for path in (ROOT / 'README.md', *sorted((ROOT / 'docs').rglob('*.md')))
    if path != TABLE
]
HEAD = f"""\
# Commands of these documents

`make promises` runs every command and code block of the README and of these documents, on the
default gear, and writes this table. `make test` runs those that take up to {SLOW_S:g} s, with
all that they need of others. `make test-slow` runs those up to {LONG_S:g} s, and `make
promises` the rest. Words instead of a time say why a command is not run, or that it was not
measured yet, which counts as long. Times are wall-clock times on two cores with other work.

| command | where | s |
|---|---|---|
"""
NOT_MEASURED = 'not measured yet'


def measured() -> dict[tuple[str, str], float]:
    """Seconds of each command, by document and command, as the table has them."""
    lines = TABLE.read_text().splitlines() if TABLE.exists() else []
    rows = (re.fullmatch(r'\| `(.+)` \| \[(\S+)\]\(.*\) \| ([\d.]+) \|', line) for line in lines)
    return {(row[2], row[1]): float(row[3]) for row in rows if row}


def table(seconds: dict[tuple[str, str], float]) -> str:
    """The table of all commands, documents in their order."""
    lines = []
    for document in DOCUMENTS:
        name = document.name
        link = f'[{name}]({name[5:] if name.startswith("docs/") else f"../{name}"})'
        for title in dict.fromkeys(promise.title for promise in document.promises):
            took = seconds.get((name, title))
            value = NOT_MEASURED if took is None else f'{took:.1f}'
            lines.append(f'| `{title}` | {link} | {by_beginning(NOT_RUN, title, value)} |\n')
    return HEAD + ''.join(lines)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        '--write-promises', action='store_true', help=f'measure all commands for {TABLE.name}'
    )


@pytest.fixture(scope='session')
def documents() -> list[Document]:
    return DOCUMENTS


@pytest.fixture(scope='session')
def stories(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Story]:
    """One story per document."""
    return {
        document.name: Story(document, tmp_path_factory.mktemp('story'))
        for document in DOCUMENTS
        if document.promises
    }


@pytest.fixture
def story(
    stories: dict[str, Story], promise: Promise, request: pytest.FixtureRequest
) -> Iterator[Story]:
    """That of a command; what it took is put into the table if that is asked for."""
    found = stories[promise.document]
    yield found
    if request.config.getoption('--write-promises', default=False):
        took = {(promise.document, step.title): took for step, took in found.seconds.items()}
        TABLE.write_text(table(measured() | took))


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Mark a command by what it took, with all that it needs, when it was measured."""
    if 'promise' not in metafunc.fixturenames:
        return
    seconds = measured()
    cases = []
    for document in DOCUMENTS:
        for promise in document.promises:
            if by_beginning(NOT_RUN, promise.title):
                continue
            chain = [promise, *document.before(promise)]
            takes = sum(seconds.get((document.name, part.title), UNKNOWN_S) for part in chain)
            marks = [pytest.mark.timeout(240.0 + 6.0 * takes)]
            if takes > SLOW_S:
                marks.append(pytest.mark.slow)
            if takes > LONG_S:
                marks.append(pytest.mark.report)
            cases.append(pytest.param(promise, marks=marks, id=f'{promise.place} {promise.title}'))
    metafunc.parametrize('promise', cases)
