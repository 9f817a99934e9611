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

from trawl_ros.cli.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.options import BAG, FILE, NAMESPACE_OPTION
from trawl_ros.cli.progress import ProgressDisplay, error_console
from trawl_ros.core.errors import RosMissing
from trawl_ros.core.network import THIS_MACHINE

if TYPE_CHECKING:
    from trawl_ros.view.bags import TowBags
    from trawl_ros.view.viewer.viewer import Kind, Viewer

LOOK_S = 0.2
"""Ctrl-C is looked for this often."""


@dataclass(frozen=True)
class Choices:
    """Arguments and options of the command, by their names."""

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
        """True if a picture is asked for."""
        return self.out is not None and self.out.suffix == '.png'

    def check(self) -> None:
        """Refuse options that do not go together."""
        if self.out is not None and self.web:
            raise click.UsageError('--out and --web: a recording is written, or shown')
        if self.live == bool(self.bags):
            raise click.UsageError('BAG... or --live: expected one of them')
        if self.live and self.picture:
            raise click.UsageError('--live: pictures are of bags; expected --out FILE.rrd')
        if self.live and self.model:
            raise click.UsageError('--live and --model: the model is drawn beside bags alone')


@click.command('view')
@click.argument('bags', metavar='BAG...', nargs=-1, type=BAG)
@click.option('--live', is_flag=True, help='Show the running graph in place of bags.')
@click.option(
    '--out', type=FILE, help='Write a recording (.rrd) for Rerun, or a picture (.png) of what it '
    'shows halfway, and open no viewer.',
)  # fmt: skip
@click.option('--web', is_flag=True, help='Show it on a web page of this machine.')
@click.option(
    '--bind', default=THIS_MACHINE, show_default=True, metavar='ADDRESS',
    help='Address on which the viewer listens. Whoever reaches another one than that of this '
    'machine sees the tow and can add to it.',
)  # fmt: skip
@click.option(
    '--port', type=click.IntRange(1024, 65534), help='Of the web page, whose data are at the next '
    'one; by default free ones.',
)  # fmt: skip
@click.option(
    '--memory', type=click.IntRange(100, 1_000_000), default=2000, show_default=True, metavar='MB',
    help='Of the viewer; beyond it the oldest data are given up.',
)  # fmt: skip
@click.option(
    '--gear', default='kaifuha', show_default=True, help='The gear: a file or the name of one that '
    'comes with the package. Its water turns pressure into depth, and its sizes draw the gear '
    'where the bag does not.',
)  # fmt: skip
@click.option(
    '--model', is_flag=True, help='Draw beside the readings what this gear shows when it is towed '
    'steadily, in each steady window. A steady state takes up to some seconds.',
)  # fmt: skip
@NAMESPACE_OPTION
@click.option('--force', is_flag=True, help='Replace the file of --out.')
def command(**given: Any) -> None:
    """Show the tow in BAG..., or of the running graph, in Rerun.

    Shown are gear, sonar, track, histories, estimates and findings. Several bags are parts of one
    tow, or a tow and what was estimated from it; their stamps put them on one time line. Opens the
    viewer's window, which ends with the command, and the command with it. With --live, `view_node`
    listens to the graph until Ctrl-C.
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
        click.echo(f'{asked.out}: {", ".join(map(str, asked.bags))}, for Rerun')
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
    click.echo(f'{out}: {", ".join(map(str, tow.paths))}, as Rerun shows it')


def _record_or_open(tow: 'TowBags', asked: Choices) -> bool:
    """Write the recording, or show it until its viewer is closed; True if it is whole."""
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
            viewer.wait(LOOK_S)
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
    """Become `view_node`, which knows ROS as commands do not; Ctrl-C then is for the node."""
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
    # JSON is YAML, so strings stay strings whatever is in them.
    options = [
        word for key, value in parameters.items() for word in ('-p', f'{key}:={json.dumps(value)}')
    ]
    code = (
        "import sys; sys.argv[0] = 'view_node'; "
        'from trawl_ros.nodes.view_node import main; sys.exit(main())'
    )
    remapped = ['--ros-args', '-r', f'__ns:=/{asked.namespace.strip("/")}', *options]
    os.execv(sys.executable, [sys.executable, '-c', code, *remapped])
