"""The glossary names what is in the package, in alphabetical order."""

import ast
import re
from pathlib import Path

import trawl_ros

PACKAGE = Path(trawl_ros.__file__).parent
GLOSSARY = Path(__file__).parents[1] / 'docs' / 'glossary.md'


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
