"""Tables on the standard output: as wide as they need to be where it is no terminal."""

from rich.console import Console, JustifyMethod
from rich.table import Table

FILE_WIDTH = 240
"""Columns of text in a file or pipe, which has no edge at which to cut words off."""


def output_console() -> Console:
    """Console of results."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=FILE_WIDTH)


def plain_table(
    *headings: str, right: tuple[str, ...] = (), wrapped: tuple[str, ...] = ()
) -> Table:
    """A table without frame: numbers in columns ``right``, long texts in columns ``wrapped``."""
    table = Table(box=None, pad_edge=False)
    for heading in headings:
        justify: JustifyMethod = 'right' if heading in right else 'left'
        table.add_column(heading, justify=justify, no_wrap=heading not in wrapped)
    return table


def figure(value: float | None) -> str:
    """Format a figure with the digits that one reads, or a dash for none."""
    return '–' if value is None else f'{value:.4g}'
