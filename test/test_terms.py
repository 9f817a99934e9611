"""Docstrings begin with a term, never with a question; the glossary names what there is."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import trawl_ros

PACKAGE = Path(trawl_ros.__file__).parent
GLOSSARY = Path(__file__).parents[1] / 'docs' / 'glossary.md'
QUESTION = re.compile(r'(What|How|Whether|Where|Who|Whom|Whose|Which|That|When|Why)\b')
DOCUMENTED = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def docstrings(source: str) -> Iterator[tuple[int, str]]:
    """Line and text of all docstrings of a module, those of attributes too."""
    for node in ast.walk(ast.parse(source)):
        for statement in node.body if isinstance(node, DOCUMENTED) else ():
            match statement:
                case ast.Expr(value=ast.Constant(value=str(text))):
                    yield statement.lineno, text


def offenders(source: str) -> list[tuple[int, str]]:
    """Line and first line of docstrings that begin with a word of a question."""
    return [
        (line, text.lstrip().split('\n', 1)[0])
        for line, text in docstrings(source)
        if QUESTION.match(text.lstrip())
    ]


def test_a_question_is_found_wherever_a_docstring_may_stand() -> None:
    source = (
        '"""What is kept."""\n'
        'LIMIT = 3\n'
        '"""How many there are."""\n'
        'class Kept:\n'
        '    """Whatever is kept, and where."""\n'
        '    def is_kept(self):\n'
        '        """Whether it is kept.\n\n        Nothing more.\n        """\n'
    )
    assert offenders(source) == [
        (1, 'What is kept.'),
        (3, 'How many there are.'),
        (7, 'Whether it is kept.'),
    ]


def test_docstrings_begin_with_a_term_or_a_verb() -> None:
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
