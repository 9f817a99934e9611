"""The command ``trawl``: one file per sub-command, loaded when it is called."""

import os
import signal
import sys
from collections.abc import Mapping, Sequence
from io import TextIOWrapper
from pathlib import Path
from types import FrameType, MappingProxyType
from typing import Any

import click

from trawl_ros.cli.loaded_group import LoadedGroup
from trawl_ros.core.errors import TrawlError, sentence_of
from trawl_ros.core.first_start import need_home
from trawl_ros.core.version import __version__

COMMANDS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        'demo': ('lab.demo.command', 'Tow, record, replay and refit through the real ROS graph.'),
        'tow': ('cli.tow', 'Tow a scenario and record what the instruments report as a bag.'),
        'identify': ('cli.identify', 'Refit the twelve board coefficients from recorded bags.'),
        'plan-trial': ('cli.plan_trial', 'Plan the trial that tells most about the boards.'),
        'diagnose': (
            'cli.diagnose',
            'Find where model and bags disagree, and name what is missing.',
        ),
        'effects': ('cli.effects', 'List the effects that a gear may have beyond the model.'),
        'trim': ('cli.trim', 'Find fastening points that give the boards wanted angles.'),
        'gear': ('cli.gear', 'Check gear files, and make them from net plans.'),
        'validate': ('lab.commands.validate', "Check the model's claims and write the report."),
        'benchmark': ('lab.commands.benchmark', 'Measure how fast things are, beside other tools.'),
        'scenarios': ('cli.scenarios', 'List the scenarios that come with the package.'),
        'import-log': ('cli.import_log', 'Turn a log from sea, a table or NMEA 0183, into a bag.'),
        'bag': ('cli.bag', 'Look into bags, check, repair and export them.'),
        'policy': ('cli.policy', 'Write the rights of all nodes, for a graph with SROS 2.'),
        'view': ('cli.view', 'Show the tow in bags in Rerun: in space and over time.'),
        'plot': ('cli.plot', 'Draw the tow in a bag: gear, histories, sonar, track, film.'),
    }
)
"""Modules and sentences, as `LoadedGroup` has them."""


class Trawl(LoadedGroup):
    """All commands, in the order of a sea trial; errors of input end in one sentence."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; an error of the input ends with one sentence and exit code 1."""
        try:
            return super().invoke(ctx)
        except TrawlError as error:
            raise click.ClickException(printable(sentence_of(error))) from error
        except SystemExit as error:
            # No command of the project ends so; code of other packages, as of an effect, may.
            if error.code not in (None, 0):
                raise
            raise click.ClickException('code of another package ended the command') from error

    def main(self, *args: Any, **options: Any) -> Any:
        """Run it all; what the system refuses ends with one sentence and exit code 1.

        That is a full disk, also behind the standard output, a folder that is read-only or gone.
        """
        try:
            return super().main(*args, **options)
        except OSError as error:
            click.echo(f'Error: {printable(refusal(error))}', err=True)
            _forget_output()
            sys.exit(1)


def printable(text: str) -> str:
    """Replace what a terminal would obey, since names come from foreign files; lines stay."""
    return ''.join(sign if sign.isprintable() or sign == '\n' else '?' for sign in text)


def refusal(error: OSError) -> str:
    """Say what the system refused: the file, where it names one, and the reason."""
    reason = error.strerror or str(error) or type(error).__name__
    try:
        Path.cwd()
    except OSError:
        if isinstance(error, FileNotFoundError):
            return f'the working folder: {reason}, expected one that is still there'
    return f'{error.filename}: {reason}' if error.filename else reason


def _forget_output() -> None:
    """Drop what the standard output did not take, which else would be tried again at the end."""
    try:
        sys.stdout.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


@click.group(cls=Trawl, modules=COMMANDS, context_settings={'help_option_names': ['-h', '--help']})
@click.version_option(__version__, prog_name='trawl')
def trawl() -> None:
    """Tow an emulated mid-water trawl, record it, and refit the model of its gear.

    Scenarios, gear and mappings are files, or names of those that come with the package.
    """


def main(args: Sequence[str] | None = None) -> None:
    """Run ``trawl``; termination ends it as orderly as Ctrl-C does."""
    signal.signal(signal.SIGTERM, _interrupt)
    need_home()
    for stream in (sys.stdout, sys.stderr):
        # Names of files may hold bytes that are no text.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors='backslashreplace')
    trawl.main(args=args, prog_name='trawl')


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
