"""The document of limits says what the program holds to."""

from pathlib import Path

from trawl_ros.core.limits import TABLE

DOCUMENT = Path(__file__).parents[2] / 'docs' / 'limits.md'


def test_the_document_is_the_table() -> None:
    rows = [line for line in DOCUMENT.read_text().splitlines() if line.startswith('| `')]
    assert rows == [f'| `{name}` | {limit} | {limit.what} |' for name, limit in TABLE.items()]
