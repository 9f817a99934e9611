# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Common parts of reports: templates, and figures as text."""

import re
from functools import lru_cache

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, select_autoescape

DPI = 110


@lru_cache
def _templates(package: str) -> Environment:
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader('trawl_ros.report')]),
        # Names end in .j2, which jinja would treat as plain text.
        autoescape=select_autoescape(['html.j2']),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(number=number, cell=cell, foreign=foreign)
    return environment


def page(package: str, name: str, /, **content: object) -> str:
    """Fill in the template ``<name>.j2`` of a package, which may include those of this one.

    Content of HTML pages is escaped. In Markdown, foreign names such as that of a gear need the
    filter `foreign`.
    """
    return _templates(package).get_template(f'{name}.j2').render(content)


def number(value: float) -> str:
    """Format a figure with four digits."""
    if value != value:
        return 'not measured'
    return f'{value:.4g}' if abs(value) < 1e4 else f'{value:.0f}'


def cell(text: str) -> str:
    """Escape text for a cell of a Markdown table."""
    return text.replace('|', '\\|').replace('\n', ' ')


def foreign(text: str) -> str:
    """Escape foreign text in Markdown, so that it is shown literally."""
    return re.sub(r'([\\`*_{}\[\]<>()#|!&~])', r'\\\1', ' '.join(text.split()))
