"""The page of instruments names every kind of fault."""

from pathlib import Path

import pytest

from trawl_ros.instruments.errors.faults import KINDS

PAGE = Path(__file__).parents[2] / 'docs' / 'instruments.md'

if not PAGE.is_file():
    pytest.skip('the documents are in a source checkout only', allow_module_level=True)


def test_every_kind_of_fault_is_named() -> None:
    text = PAGE.read_text()
    assert [kind for kind in KINDS if f'`{kind}`' not in text] == []
