"""Tables on the standard output: as wide as they need to be where it is no terminal."""

from rich.console import Console
from rich.table import Table

FILE_WIDTH = 240
"""Columns of text in a file or pipe, which has no edge at which to cut words off."""


def output_console() -> Console:
    """Console of results."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=FILE_WIDTH)


def plain_table(*headings: str, right: tuple[str, ...] = ()) -> Table:
    """A table without frame; columns named in ``right`` hold numbers."""
    table = Table(box=None, pad_edge=False)
    for heading in headings:
        table.add_column(heading, justify='right' if heading in right else 'left', no_wrap=True)
    return table


def figure(value: float | None) -> str:
    """Format a figure with the digits that one reads, or a dash for none."""
    return '–' if value is None else f'{value:.4g}'
