# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables on the standard output, with full width if it is not a terminal."""

from rich.console import Console, JustifyMethod
from rich.table import Table

FILE_COLUMNS = 2000
"""Width of a file or pipe, in which no cell is cut off."""


def output_console() -> Console:
    """Return the console for results."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=FILE_COLUMNS)


def plain_table(
    *headings: str, right: tuple[str, ...] = (), wrapped: tuple[str, ...] = ()
) -> Table:
    """Return a table without a frame: numbers in columns ``right``, long texts in ``wrapped``."""
    table = Table(box=None, pad_edge=False)
    for heading in headings:
        justify: JustifyMethod = 'right' if heading in right else 'left'
        table.add_column(heading, justify=justify, no_wrap=heading not in wrapped)
    return table


def figure(value: float | None) -> str:
    """Format a figure with four digits, or a dash for None."""
    return '–' if value is None else f'{value:.4g}'
