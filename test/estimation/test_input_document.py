"""The document of the input names every reason, in the order of the list, and no other."""

import re
from pathlib import Path

import pytest

from trawl_ros.estimation.windows.records import REASONS, WindowOptions
from trawl_ros.records.channels import CHANNELS

DOCUMENT = Path(__file__).parents[2] / 'docs' / 'identification' / 'input.md'


@pytest.fixture(scope='module')
def text():
    return DOCUMENT.read_text()


def test_it_has_every_reason(text):
    rows = re.findall(r'^\| `([a-z ]+)` \| (.+) \| (.+) \|$', text, re.MULTILINE)
    assert [reason for reason, _, _ in rows] == list(REASONS)


def test_delays_and_patience_are_those_of_the_code(text):
    for name in ('port_length', 'port_door_depth', 'vertical_opening'):
        assert f'{CHANNELS[name].delay:g} s' in text
    assert f'`patience_s` ({WindowOptions.patience_s:g} s)' in text
    assert f'more than {WindowOptions.reorder_s:g} s' in text


def test_the_files_it_names_exist(text):
    for name in re.findall(r'`(?:pytest test/estimation/)?(test_\w+\.py)`', text):
        assert list(Path(__file__).parent.rglob(name)), name
