"""Tables on the standard output, with full width if it is not a terminal."""

from rich.console import Console
from rich.table import Table

FILE_WIDTH = 240
"""Columns of text in a file or pipe."""


def output_console() -> Console:
    """Return the console for results."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=FILE_WIDTH)


def plain_table(*headings: str, right: tuple[str, ...] = ()) -> Table:
    """Return a table without a frame; columns in ``right`` are aligned right."""
    table = Table(box=None, pad_edge=False)
    for heading in headings:
        table.add_column(heading, justify='right' if heading in right else 'left', no_wrap=True)
    return table


def figure(value: float | None) -> str:
    """Format a figure with four digits, or a dash for None."""
    return '–' if value is None else f'{value:.4g}'
