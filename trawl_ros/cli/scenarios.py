# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl scenarios``."""

from typing import Literal

import click
from rich.console import Console
from rich.table import Table

from trawl_ros.core.errors import ScenarioError
from trawl_ros.core.resources import share_path
from trawl_ros.core.schema import load_yaml, validated
from trawl_ros.scenario.records import ScenarioRecord

TABLE_COLUMNS = 140


@click.command('scenarios')
def command() -> None:
    """List the scenarios of the package with their purpose."""
    table = Table(box=None, pad_edge=False)
    for heading in ('name', 'minutes', 'description'):
        side: Literal['left', 'right'] = 'right' if heading == 'minutes' else 'left'
        table.add_column(heading, justify=side, no_wrap=True)
    for path in sorted(share_path('config', 'scenarios').glob('*.yaml')):
        record = validated(ScenarioRecord, load_yaml(path, ScenarioError), path, ScenarioError)
        minutes = sum(step.minutes for step in record.steps)
        table.add_row(path.stem, f'{minutes:g}', record.description)
    # One line per scenario on a terminal of any width.
    Console(width=TABLE_COLUMNS, highlight=False).print(table, soft_wrap=True)
