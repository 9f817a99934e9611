"""Every command and code block of README and docs does as it stands there."""

import re
import shlex

import click
from promised.documents import ROOT, TABLE
from promised.story import BESIDE, ENDS, NOT_RUN

from trawl_ros.cli.main import trawl


def test_it_runs(promise, story):
    story.run(promise)


def test_every_block_is_run_or_is_a_file_with_a_name(documents):
    assert [place for document in documents for place in document.unknown] == []


def test_every_command_has_its_line_in_the_table(documents):
    wanted = {
        (promise.document, promise.title) for document in documents for promise in document.promises
    }
    rows = re.findall(r'^\| `(.+)` \| \[(\S+)\]', TABLE.read_text(), re.M)
    assert {(document, title) for title, document in rows} == wanted, '`make promises` writes it'


def test_what_is_said_of_single_commands_is_said_of_some_that_exist(documents):
    titles = [promise.title for document in documents for promise in document.promises]
    for beginning in (*NOT_RUN, *ENDS, *BESIDE):
        assert any(title.startswith(beginning) for title in titles), beginning


def test_the_options_of_every_command_exist(documents):
    """Also of those in the midst of sentences, and of those that take long."""
    for document in documents:
        commands = [promise.title for promise in document.promises]
        for words in map(str.split, (*document.mentioned, *commands)):
            if words[:2] == ['trawl', 'study']:
                # Pages of earlier runs name their command: docs/studies/lessons.md has the commit.
                assert document.name.startswith(('docs/studies/', 'docs/validation/')), words
            elif words[0] == 'trawl':
                parse(trawl, words)
            elif words[0] == 'make':
                words = shlex.split(' '.join(words))
                (target,) = (word for word in words[1:] if '=' not in word)
                assert re.search(rf'^{target}:', (ROOT / 'Makefile').read_text(), re.M), words


def parse(command, words, parent=None):
    """Walk down the sub-commands and read the options, their values aside."""
    name, *rest = words
    context = command.make_context(name, list(rest), parent=parent, resilient_parsing=True)
    if isinstance(command, click.Group) and rest:
        found = command.get_command(context, rest[0])
        assert found is not None, f'{context.command_path} {rest[0]}'
        parse(found, rest, context)
