"""The document of the input names every reason for a rejection, and no other."""

import re
from pathlib import Path

from trawl_ros.estimation.windows.records import REASONS

DOCUMENT = Path(__file__).parents[2] / 'docs' / 'identification' / 'use.md'


def test_it_has_every_reason():
    text = DOCUMENT.read_text()
    rows = re.findall(r'^\| (`[a-z ]+`(?:, `[a-z ]+`)*) \| .+ \| .+ \|$', text, re.MULTILINE)
    assert sorted(re.findall('`(.+?)`', ' '.join(rows))) == sorted(REASONS)
