# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Command ``trawl``: one file per sub-command, loaded when it is called."""

import os
import signal
import sys
from collections.abc import Mapping, Sequence
from io import TextIOWrapper
from pathlib import Path
from types import FrameType, MappingProxyType
from typing import Any

import click

from trawl_ros.cli.console.loaded_group import UNITS_KEY, LoadedGroup
from trawl_ros.core.display_units import METRIC
from trawl_ros.core.errors import NoSteadyState, TrawlError, sentence_of
from trawl_ros.core.first_start import need_home
from trawl_ros.core.version import __version__

COMMANDS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        'demo': ('lab.demo.command', 'Tow, record, replay and estimate through a ROS graph.'),
        'tow': ('cli.tow', 'Tow a scenario and record its instruments as a bag.'),
        'compare': ('cli.compare', 'Compare logs with a gear file as it is; nothing is fitted.'),
        'identify': ('cli.identify', 'Estimate the door coefficients from recorded bags.'),
        'plan-trial': ('cli.plan_trial', 'Plan the sea trial that determines the boards best.'),
        'diagnose': (
            'cli.diagnose',
            'Find where model and bags disagree, and name the missing effect.',
        ),
        'effects': ('cli.effects', 'List the effects that a gear may have beyond the model.'),
        'trim': ('cli.trim', 'Find fastening points that give the doors wanted angles.'),
        'gear': ('cli.gear', 'Check, copy and change gear files, and find steady states.'),
        'validate': (
            'lab.commands.validate',
            'Check the model against the paper, tanks and hauls.',
        ),
        'benchmark': ('lab.commands.benchmark', 'Compare the speed of this package with others.'),
        'bench': ('lab.commands.bench', 'Score autotrawls, yours too, in the same scenarios.'),
        'missing-effect': (
            'lab.commands.missing_effect',
            'Score methods of diagnosis on blind trials with a hidden effect.',
        ),
        'scenarios': ('cli.scenarios', 'List the scenarios of the package.'),
        'files': ('cli.files', 'Print or copy the files of the package: gears, scenarios, bag.'),
        'import-log': ('cli.import_log', 'Convert a log from sea, a table or NMEA 0183, to a bag.'),
        'swept': ('cli.swept', 'Compute swept area and volume of hauls, with intervals.'),
        'bag': ('cli.bag', 'Inspect, check, repair, compare and export bags.'),
        'policy': ('cli.policy', 'Write the access rights of all nodes for SROS 2.'),
        'view': ('cli.view', 'Show the tow of bags in Rerun, in space and over time.'),
        'plot': ('cli.plot', 'Draw the tow of a bag: gear, time series, sonar, track, film.'),
    }
)
"""Module and sentence of each command, for `LoadedGroup`."""


class Trawl(LoadedGroup):
    """All commands, in the order of a sea trial; an input error prints one sentence."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; an input error prints one sentence and exits with 1."""
        try:
            return super().invoke(ctx)
        except TrawlError as error:
            text = sentence_of(error)
            if isinstance(error, NoSteadyState):
                text = ctx.meta.get(UNITS_KEY, METRIC).sentence(text)
            raise click.ClickException(printable(text)) from error
        except SystemExit as error:
            # Commands of the project never exit so; code of a plug-in effect may.
            if error.code not in (None, 0):
                raise
            raise click.ClickException(
                'code of another package stopped the command, such as that of an effect'
            ) from error

    def main(self, *args: Any, **options: Any) -> Any:
        """Run ``trawl``; an error of the operating system prints one sentence and exits with 1.

        Examples are a full disk, also behind the standard output, or a read-only folder.
        """
        try:
            return super().main(*args, **options)
        except OSError as error:
            click.echo(f'Error: {printable(refusal(error))}', err=True)
            _forget_output()
            sys.exit(1)


def printable(text: str) -> str:
    """Replace control characters except newlines, because names come from foreign files."""
    return ''.join(sign if sign.isprintable() or sign == '\n' else '?' for sign in text)


def refusal(error: OSError) -> str:
    """Describe an error of the operating system: the file, if it is known, and the reason."""
    reason = error.strerror or str(error) or type(error).__name__
    try:
        Path.cwd()
    except OSError:
        if isinstance(error, FileNotFoundError):
            return f'the working folder: {reason}, expected a folder that exists'
    return f'{error.filename}: {reason}' if error.filename else reason


def _forget_output() -> None:
    """Discard unwritten output, which Python would otherwise try to write again at exit."""
    try:
        sys.stdout.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


@click.group(cls=Trawl, modules=COMMANDS, context_settings={'help_option_names': ['-h', '--help']})
@click.version_option(__version__, prog_name='trawl')
def trawl() -> None:
    """Tow an emulated mid-water trawl, record it, and fit the model of its gear to measured tows.

    Scenarios, gears, bags and mappings are files, or names of files of the package.
    `trawl COMMAND --help` explains a command.
    """


def main(args: Sequence[str] | None = None) -> None:
    """Run ``trawl``; SIGTERM stops it in the same way as Ctrl-C."""
    signal.signal(signal.SIGTERM, _interrupt)
    need_home()
    for stream in (sys.stdout, sys.stderr):
        # File names may contain bytes that are not valid text.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors='backslashreplace')
    trawl.main(args=args, prog_name='trawl')


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt
