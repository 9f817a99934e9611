"""Docstrings, their descriptions and comments begin with a term, never with a question."""

import ast
import re
from collections.abc import Iterator
from io import StringIO
from itertools import pairwise
from pathlib import Path
from tokenize import COMMENT, generate_tokens

import trawl_ros

PACKAGE = Path(trawl_ros.__file__).parent
GLOSSARY = Path(__file__).parents[1] / 'docs' / 'glossary.md'
QUESTION = re.compile(r'(What|How|Whether|Where|Who|Whom|Whose|Which|That|When|Why)\b')
DOCUMENTED = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


ASKING = re.compile(r'# *(What|How|Whether|Who|Whom|Whose|Which|Why)\b')


def docstrings(source: str) -> Iterator[tuple[int, str]]:
    """Line and text of all docstrings of a module, those of attributes too."""
    for node in ast.walk(ast.parse(source)):
        for statement in node.body if isinstance(node, DOCUMENTED) else ():
            match statement:
                case ast.Expr(value=ast.Constant(value=str(text))):
                    yield statement.lineno, text


def descriptions(line: int, text: str) -> Iterator[tuple[int, str]]:
    """Line and text of the first lines of a docstring, of it and of its indented descriptions."""
    lines = text.split('\n')
    yield line, lines[0].lstrip()
    for number, (before, here) in enumerate(pairwise(lines), start=line + 1):
        if before.strip() and indent(here) > indent(before) > 0:
            yield number, here.strip()


def indent(line: str) -> int:
    return len(line) - len(line.lstrip())


def comments(source: str) -> Iterator[tuple[int, str]]:
    """Line and text of the first lines of comments."""
    lines = source.splitlines()
    for token in generate_tokens(StringIO(source).readline):
        row = token.start[0]
        goes_on = row > 1 and lines[row - 2].lstrip().startswith('#')
        if token.type == COMMENT and not goes_on:
            yield row, token.string


def offenders(source: str) -> list[tuple[int, str]]:
    """Line and text of what begins with a word of a question."""
    asking = [
        (line, words)
        for first, text in docstrings(source)
        for line, words in descriptions(first, text)
        if QUESTION.match(words)
    ]
    return asking + [(line, text) for line, text in comments(source) if ASKING.match(text)]


def test_a_question_is_found_wherever_a_docstring_may_stand() -> None:
    source = (
        '"""What is kept."""\n'
        'LIMIT = 3\n'
        '"""How many there are."""\n'
        'class Kept:\n'
        '    """Whatever is kept, and where."""\n'
        '    def is_kept(self):\n'
        '        """Whether it is kept.\n\n        Nothing more.\n        """\n'
        '    def keep(self, times):\n'
        '        """Keep it.\n\n'
        '        Parameters\n        ----------\n'
        '        times\n            How often.\n'
        '        """\n'
        '        # What is kept twice.\n'
        '        # What goes on is no beginning.\n'
    )
    assert offenders(source) == [
        (1, 'What is kept.'),
        (3, 'How many there are.'),
        (7, 'Whether it is kept.'),
        (17, 'How often.'),
        (19, '# What is kept twice.'),
    ]


def test_docstrings_descriptions_and_comments_begin_with_a_term_or_a_verb() -> None:
    found = [
        f'{path.relative_to(PACKAGE)}:{line}: {text}'
        for path in sorted(PACKAGE.rglob('*.py'))
        for line, text in offenders(path.read_text(encoding='utf-8'))
    ]
    assert not found, 'name the object or begin with a verb:\n' + '\n'.join(found)


def test_the_glossary_names_what_is_in_the_package() -> None:
    words = re.findall(r'`([A-Za-z_.]+)`', GLOSSARY.read_text('utf-8'))
    named = {word.split('.')[0] for word in words if not word.endswith('.yaml')}
    defined = {
        node.name
        for path in PACKAGE.rglob('*.py')
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8')))
        if isinstance(node, ast.ClassDef | ast.FunctionDef)
    }
    assert sorted(named - defined) == []


def test_the_glossary_is_alphabetical_within_its_sections() -> None:
    for section in GLOSSARY.read_text('utf-8').split('\n## ')[1:]:
        terms = [term.lower() for term in re.findall(r'^- \*\*(.+?)\*\*', section, re.MULTILINE)]
        assert terms == sorted(terms)
        assert terms
