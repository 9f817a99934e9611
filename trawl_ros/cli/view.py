# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl view``."""

import json
import os
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from trawl_ros.cli.console.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.options import BAG, FILE, NAMESPACE_OPTION
from trawl_ros.core.errors import RosMissing
from trawl_ros.core.network import THIS_MACHINE

if TYPE_CHECKING:
    from trawl_ros.view.bags import TowBags
    from trawl_ros.view.viewer.viewer import Kind, Viewer

POLL_S = 0.2
"""Interval of checks for Ctrl-C, s."""


@dataclass(frozen=True)
class Choices:
    """Arguments and options of the command, by name."""

    bags: tuple[Path, ...]
    live: bool
    out: Path | None
    web: bool
    bind: str
    port: int | None
    memory: int
    gear: str
    model: bool
    namespace: str
    force: bool

    @property
    def picture(self) -> bool:
        """True if a picture is wanted."""
        return self.out is not None and self.out.suffix == '.png'

    def check(self) -> None:
        """Refuse options that exclude each other."""
        if self.out is not None and self.web:
            raise click.UsageError('--out and --web: found both, expected one of them')
        if self.live == bool(self.bags):
            raise click.UsageError('BAG... and --live: found both or neither, expected one of them')
        if self.live and self.picture:
            raise click.UsageError('--live: found --out with a picture, expected FILE.rrd')
        if self.live and self.model:
            raise click.UsageError(
                '--live and --model: found both, expected --model with bags only'
            )


@click.command('view')
@click.argument('bags', metavar='BAG...', nargs=-1, type=BAG)
@click.option('--live', is_flag=True, help='Show the running graph instead of bags.')
@click.option(
    '--out', type=FILE, help='Write a Rerun recording (.rrd), or a picture (.png) of the middle of '
    'the tow, instead of opening a viewer.',
)  # fmt: skip
@click.option('--web', is_flag=True, help='Show the tow on a web page of this machine.')
@click.option(
    '--bind', default=THIS_MACHINE, show_default=True, metavar='ADDRESS',
    help='Address on which the viewer listens. With another address than that of this machine, '
    'others can see the tow and add data to it.',
)  # fmt: skip
@click.option(
    '--port', type=click.IntRange(1024, 65534), help='Port of the web page; its data use the next '
    'one. By default free ports.',
)  # fmt: skip
@click.option(
    '--memory', type=click.IntRange(100, 1_000_000), default=2000, show_default=True, metavar='MB',
    help='Memory of the viewer; above it the oldest data are dropped.',
)  # fmt: skip
@click.option(
    '--gear', default='kaifuha', show_default=True, help='Gear file or name of a gear of the '
    'package. Its water converts pressure to depth, and its sizes are drawn if the bag has none.',
)  # fmt: skip
@click.option(
    '--model', is_flag=True, help='Also draw the steady state of this gear in each steady window. '
    'A steady state takes up to a few seconds.',
)  # fmt: skip
@NAMESPACE_OPTION
@click.option('--force', is_flag=True, help='Replace the file of --out.')
def command(**given: Any) -> None:
    """Show the tow of BAG..., or of the running graph, in Rerun.

    It shows gear, sonar, track, time series, estimates and findings. Several bags are parts of one
    tow, or a tow and its estimates; their stamps put them on one time line. The command opens the
    viewer's window and ends with it. With --live, `view_node` listens to the graph until Ctrl-C.
    """
    asked = Choices(**given)
    asked.check()
    if asked.live:
        _run_node(asked)
    from trawl_ros.view.bags import TowBags

    tow = TowBags(asked.bags, asked.namespace)
    if asked.out is not None and asked.picture:
        _draw(tow, asked.out, asked)
        return
    complete = _record_or_open(tow, asked)
    if asked.out is not None:
        click.echo(f'{asked.out}: recording of {", ".join(map(str, asked.bags))} for Rerun')
        if not complete:
            raise SystemExit(INTERRUPTED)


def _draw(tow: 'TowBags', out: Path, asked: Choices) -> None:
    from trawl_ros.gear.load import load_gear
    from trawl_ros.view.picture import write_picture
    from trawl_ros.view.recording import check_file

    check_file(out, force=asked.force)
    with ProgressDisplay(error_console()) as display:
        gear = load_gear(asked.gear)
        write_picture(tow, gear, out, model=asked.model, on_progress=display)
    for problem in tow.problems:
        click.echo(problem, err=True)
    click.echo(f'{out}: Rerun picture of {", ".join(map(str, tow.paths))}')


def _record_or_open(tow: 'TowBags', asked: Choices) -> bool:
    """Write the recording, or show it until its viewer is closed; return True if complete."""
    from trawl_ros.view.recording import to_file, to_viewer
    from trawl_ros.view.viewer.viewer import Viewer

    with ExitStack() as stack, Interruption() as interruption:
        viewer: Viewer | None = None
        if asked.out is not None:
            recording = stack.enter_context(to_file(asked.out, force=asked.force))
        else:
            kind: Kind = 'web' if asked.web else 'window'
            viewer = stack.enter_context(
                Viewer(kind, bind=asked.bind, port=asked.port, memory_mb=asked.memory)
            )
            if asked.web:
                click.echo(viewer.page)
            recording = stack.enter_context(to_viewer(viewer.url))
        complete = _show(tow, recording, asked, interruption, viewer)
        for problem in tow.problems:
            click.echo(problem, err=True)
        while viewer is not None and viewer.running and not interruption.requested:
            viewer.wait(POLL_S)
        if viewer is not None:
            viewer.check()
    return complete


def _show(
    tow: 'TowBags',
    recording: object,
    asked: Choices,
    interruption: Interruption,
    viewer: 'Viewer | None',
) -> bool:
    from trawl_ros.gear.load import load_gear
    from trawl_ros.view.rerun_log import RerunLog

    def stopped() -> bool:
        return interruption.requested or (viewer is not None and not viewer.running)

    log, gear = RerunLog(recording, tow.topics), load_gear(asked.gear)
    with ProgressDisplay(error_console()) as display:
        return tow.show(log, gear, model=asked.model, on_progress=display, stopped=stopped)


def _run_node(asked: Choices) -> NoReturn:
    """Replace this process by `view_node`, which uses ROS and receives Ctrl-C."""
    if find_spec('rclpy') is None:
        raise RosMissing('trawl view --live', ModuleNotFoundError(name='rclpy'))
    parameters = {
        'viewer': 'web' if asked.web else 'window',
        'output': '' if asked.out is None else str(asked.out),
        'host': asked.bind,
        'port': asked.port or 0,
        'memory_mb': asked.memory,
        'gear': asked.gear,
    }
    # JSON is valid YAML, so strings remain strings with any content.
    options = [
        word for key, value in parameters.items() for word in ('-p', f'{key}:={json.dumps(value)}')
    ]
    code = (
        "import sys; sys.argv[0] = 'view_node'; "
        'from trawl_ros.nodes.view_node import main; sys.exit(main())'
    )
    remapped = ['--ros-args', '-r', f'__ns:=/{asked.namespace.strip("/")}', *options]
    os.execv(sys.executable, [sys.executable, '-c', code, *remapped])
