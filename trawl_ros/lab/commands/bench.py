# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl bench``: tow the same scenarios with several controllers, and compare them."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, fields
from pathlib import Path

import click
from matplotlib.figure import Figure

from trawl_ros.cli.options import FORCE_OPTION, REPORT_OPTION
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder
from trawl_ros.core.progress import WorkProgress
from trawl_ros.lab.autotrawls.controllers import MakeController, load_class, shipped
from trawl_ros.lab.autotrawls.tows import (
    SCENARIOS,
    Score,
    TowHistory,
    bench_scenario,
    score,
    tow_with,
)
from trawl_ros.lab.commands.outcome import stoppable
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.report.pictures import Drawing
from trawl_ros.report.rendering import number
from trawl_ros.scenario.scenario import Scenario

HEADS = {
    'imbalance': 'imbalance, %',
    'tension_std': 'tension std, %',
    'spread_error': 'spread error, m',
    'wire_speed': 'wire speed, m/s',
}
METHOD = (
    'Each scenario is towed with each controller, from the same start with the same noise; the '
    'first minute is calm and not scored. Imbalance is the RMS of (port − starboard) / (port + '
    'starboard) of the true tensions; tension std that of a warp over its mean; spread error the '
    'RMS distance of the door spread from that of an undisturbed tow at the set lengths; wire '
    'speed the mean speed of the wire. Less is better.'
)
Towed = dict[str, dict[str, TowHistory]]


@click.group('bench')
def command() -> None:
    """Compare controllers in the same scenarios."""


@command.command('autotrawl')
@REPORT_OPTION
@FORCE_OPTION
@click.option('--node', help='Command that starts a node, such as "python my_autotrawl.py".')
@click.option('--class', 'kind', help='Python class as module:Class, with update(sample).')
@click.option(
    '--scenario', 'names', multiple=True, type=click.Choice(SCENARIOS),
    help='Scenario of the bench. May be given several times; all by default.',
)  # fmt: skip
def autotrawl(
    out: Path, force: bool, node: str | None, kind: str | None, names: Sequence[str]
) -> None:
    """Tow five scenarios with autotrawls, yours and the project's.

    Yours is a node that answers winch/joint_states with command/winch, or a class. The report has
    the scores of all, and figures. Without either, the controllers of the project are compared.
    """
    empty_folder(out, force=force)
    towed: Towed = {}
    with ExitStack() as stack:
        display, console = stack.enter_context(stoppable())
        chosen = tuple(dict.fromkeys(names)) or SCENARIOS
        for done, name in enumerate(chosen):
            scenario = bench_scenario(name)
            for controller, make in _controllers(scenario, kind).items():
                display(
                    WorkProgress('towing', done, len(chosen), 'scenarios', f'{name}: {controller}')
                )
                towed.setdefault(name, {})[controller] = tow_with(scenario, make)
            if node:
                towed[name]['yours'] = _tow_node(scenario, node, out / 'logs' / name)
            for controller, tow in towed[name].items():
                console.print(f'{name}, {controller}: {_row(score(tow))}', markup=False)
    write_bench(out, towed)
    click.echo(str(out / 'autotrawl.md'))


def _controllers(scenario: Scenario, kind: str | None) -> dict[str, MakeController]:
    made = shipped(scenario.plant.winch)
    return {'yours': load_class(kind), **made} if kind else made


def _tow_node(scenario: Scenario, node: str, logs: Path) -> TowHistory:
    try:
        # Its import needs ROS 2.
        from trawl_ros.lab.autotrawls.node_controller import node_controller
    except ImportError as reason:
        raise TrawlError(f'--node: ROS 2 is not there ({reason}); expected rclpy') from reason
    with node_controller(node, logs) as make:
        return tow_with(scenario, make)


def write_bench(folder: Path, towed: Mapping[str, Mapping[str, TowHistory]]) -> None:
    """Write ``autotrawl.json``, ``.md``, ``.html`` and figures into a folder."""
    scores = {
        name: {controller: score(tow) for controller, tow in tows.items()}
        for name, tows in towed.items()
    }
    sections = [
        Section(
            title=name.replace('_', ' '),
            text=f'{bench_scenario(name).record.description}.',
            tables=[_table(by_controller)],
        )
        for name, by_controller in scores.items()
    ]
    record = {
        name: {controller: asdict(one) for controller, one in by_controller.items()}
        for name, by_controller in scores.items()
    }
    drawings = [_drawing(name, tows) for name, tows in towed.items()]
    page = Page('autotrawl', 'Autotrawls', 'trawl bench autotrawl --out FOLDER', METHOD)
    write_page(folder, page, sections, drawings, record)


def _table(scores: Mapping[str, Score]) -> TextTable:
    rows = tuple(
        (controller, *(number(value) for value in asdict(one).values()))
        for controller, one in scores.items()
    )
    return TextTable('', ('controller', *(HEADS[field.name] for field in fields(Score))), rows)


def _row(one: Score) -> str:
    return ', '.join(f'{HEADS[name]} {number(value)}' for name, value in asdict(one).items())


def _drawing(name: str, tows: Mapping[str, TowHistory]) -> Drawing:
    figure = Figure(figsize=(8.0, 6.0), layout='constrained')
    tensions, spread = figure.subplots(2, 1, sharex=True)
    for controller, tow in tows.items():
        port, starboard = tow.tensions.T
        minutes = tow.times / 60.0
        tensions.plot(minutes, 100.0 * (port - starboard) / (port + starboard), label=controller)
        spread.plot(minutes, tow.spreads - tow.wanted_spreads, label=controller)
    tensions.set_ylabel('imbalance, %')
    spread.set_ylabel('spread error, m')
    spread.set_xlabel('minutes')
    tensions.legend()
    return Drawing(name, f'{name.replace("_", " ")}: imbalance and error of the spread.', figure)
