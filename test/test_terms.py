"""The glossary is in alphabetical order."""

import re
from pathlib import Path

GLOSSARY = Path(__file__).parents[1] / 'docs' / 'glossary.md'


def test_the_glossary_is_alphabetical_within_its_sections() -> None:
    for section in GLOSSARY.read_text('utf-8').split('\n## ')[1:]:
        terms = [term.lower() for term in re.findall(r'^- \*\*(.+?)\*\*', section, re.MULTILINE)]
        assert terms == sorted(terms)
        assert terms
