"""docs/model.md names every equation of the paper, and only functions that exist."""

import re
from pathlib import Path
from pkgutil import resolve_name

ROOT = Path(__file__).parents[2]
DOCUMENT = (ROOT / 'docs' / 'model.md').read_text(encoding='utf-8')
ROWS = re.findall(r'^\| ([\d–, ]+?)(?:, Table 1)? \| [^|]+ \| ([^|]+) \|$', DOCUMENT, re.MULTILINE)


def test_equations_1_to_38_are_all_there() -> None:
    found: list[int] = []
    for numbers, _ in ROWS:
        for part in numbers.split(','):
            first, _, last = part.partition('–')
            found.extend(range(int(first), int(last or first) + 1))
    assert sorted(found) == list(range(1, 39))


def test_what_it_names_exists() -> None:
    for name in re.findall(r'`([^`]+)`', ' '.join(where for _, where in ROWS)):
        if '/' in name:
            assert (ROOT / name).exists(), name
            continue
        assert resolve_name(f'trawl_ros.{name}'), name
    for name in re.findall(r'`(?:pytest -s )?(test/\S+?\.py)`', DOCUMENT):
        assert (ROOT / name).exists(), name
