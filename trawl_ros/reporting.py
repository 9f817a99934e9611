"""What the reports of validation and benchmark share: templates, and figures as text."""

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

DPI = 110


def templates(package: str) -> Environment:
    """The templates of a package, with the filters of this module."""
    environment = Environment(
        loader=PackageLoader(package, 'templates'),
        autoescape=select_autoescape(['html']),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(number=number, cell=cell)
    return environment


def number(value: float) -> str:
    """A figure with as many digits as one reads."""
    if value != value:
        return 'not measured'
    return f'{value:.4g}' if abs(value) < 1e4 else f'{value:.0f}'


def cell(text: str) -> str:
    """Text in a cell of a Markdown table."""
    return text.replace('|', '\\|').replace('\n', ' ')
