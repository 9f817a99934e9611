"""The table of a long test is printed whether it passes or not."""

import sys
from collections.abc import Callable, Sequence

import pytest

from endurance.table import table
from trawl_ros.lab.report.measured import MeasuredValue


@pytest.fixture
def show(capsys: pytest.CaptureFixture[str]) -> Callable[[str, Sequence[MeasuredValue]], None]:
    """Print rows; give what prints them."""

    def printed(title: str, rows: Sequence[MeasuredValue]) -> None:
        with capsys.disabled():
            sys.stdout.write(f'{table(title, rows)}\n')

    return printed
