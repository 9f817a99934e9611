"""Size of the long tests, and the table that each of them prints."""

import os
from collections.abc import Sequence

from trawl_ros.lab.report.measured import MeasuredValue

FULL = os.environ.get('ENDURANCE') == 'full'
"""True for hours in place of minutes, as ``make endurance`` runs them."""


def table(title: str, rows: Sequence[MeasuredValue]) -> str:
    """Return rows as lines of text."""
    cells = [
        (row.what, row.figure, row.wanted, '' if row.target is None else 'yes' if row.ok else 'NO')
        for row in rows
    ]
    head = ('what', 'value', 'asked for', 'reached')
    widths = [max(len(row[column]) for row in (head, *cells)) for column in range(len(head))]
    lines = [
        '  '.join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in (head, *cells)
    ]
    return '\n'.join(('', title, *lines))
