"""``trawl study hostile``."""

from pathlib import Path

import click

from trawl_ros.cli.options import (
    FORCE_OPTION,
    REPORT_OPTION,
)
from trawl_ros.cli.progress import ProgressDisplay, error_console
from trawl_ros.core.errors import RosMissing
from trawl_ros.core.files import empty_folder
from trawl_ros.lab.commands.outcome import print_outcome


@click.command('hostile')
@REPORT_OPTION
@FORCE_OPTION
@click.option('--messages', default=100_000, show_default=True,
              type=click.IntRange(100, 100_000_000), help='Hostile messages.')  # fmt: skip
@click.option('--seed', default=1, show_default=True, type=click.IntRange(0, 2**31),
              help='Of all draws.')  # fmt: skip
def command(out: Path, force: bool, messages: int, seed: int) -> None:
    """Send messages that make no sense to each subscription of each node.

    Nodes run in this process and get the bytes as from the middleware. Writes
    hostile_messages.json.
    """
    try:
        from trawl_ros.lab.studies.hostile.report import REPORT as HOSTILE_REPORT
        from trawl_ros.lab.studies.hostile.report import write_hostile
        from trawl_ros.lab.studies.hostile.study import run_hostile
    except ImportError as reason:
        raise RosMissing('the study of hostile messages', reason) from reason
    empty_folder(out, force=force)
    with ProgressDisplay(error_console()) as display:
        found = run_hostile(messages, seed, display)
    print_outcome(write_hostile(out, found, seed), out / HOSTILE_REPORT)
