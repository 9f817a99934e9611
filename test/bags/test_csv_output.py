"""A spreadsheet that opens an export computes nothing that a bag says."""

import csv
from io import StringIO

import pytest

from trawl_ros.bags.export import CsvOutput

FORMULAS = ('=1+1', '+1+1', '-1+1', '@SUM(A1)', '\t=1', '\r=1', '=cmd|"/c calc"!A1', '-', '+',
            '\n=1', '＝1+1', '＠SUM(A1)')  # fmt: skip
NUMBERS = ('-1.5', '+2', '-1e-300', '-inf', 'nan', '-.5', '3.')


def written(cell: str) -> str:
    stream = StringIO(newline='')
    CsvOutput(stream).row(['0', cell])
    ((_, found),) = csv.reader(StringIO(stream.getvalue(), newline=''))
    return found


@pytest.mark.parametrize('cell', FORMULAS)
def test_text_that_begins_like_a_formula_is_text(cell: str) -> None:
    assert written(cell) == f"'{cell}"


@pytest.mark.parametrize('cell', [*NUMBERS, 'port', "it's", '', 'a=b', ' -x'])
def test_numbers_and_other_text_stay(cell: str) -> None:
    assert written(cell) == cell
