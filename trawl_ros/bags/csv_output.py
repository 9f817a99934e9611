"""CSV output whose text no spreadsheet takes for a formula."""

import csv
import re
from collections.abc import Iterable
from typing import TextIO

_FORMULA = ('=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠')  # wide ones
_NUMBER = re.compile(r'[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|inf|nan)', re.IGNORECASE)


class CsvOutput:
    """CSV writer of rows: comma, lines that end with LF.

    Parameters
    ----------
    stream
        Opened with ``newline=''``.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        # Before Python 3.13 a CR in a cell is quoted only where it is part of the line's end.
        self._writer = csv.writer(self, lineterminator='\r\n')

    def row(self, cells: Iterable[str]) -> None:
        """Write one row; see `harmless` for text that a spreadsheet would compute."""
        self._writer.writerow([harmless(cell) for cell in cells])

    def write(self, line: str) -> None:
        """Write a line from the module `csv`."""
        self._stream.write(f'{line[:-2]}\n')


def harmless(cell: str) -> str:
    """Put an apostrophe before text that begins like a formula; numbers stay as they are."""
    if cell.startswith(_FORMULA) and not _NUMBER.fullmatch(cell):
        return f"'{cell}"
    return cell
