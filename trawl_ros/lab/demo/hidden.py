# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Last part of the demo: diagnose tows in a current that the model lacks, and repair the model.

It uses the commands and nodes of the package, each as a separate process.
"""

import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import click
import yaml
from rich.console import Console

from trawl_ros.bags.reader import summarise
from trawl_ros.cli.console.tables import output_console, plain_table
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import made_folder
from trawl_ros.core.parallel import cores
from trawl_ros.core.resources import packaged
from trawl_ros.core.units import UNITS
from trawl_ros.diagnosis.report.writing import MODEL_FILE
from trawl_ros.estimation.bag_windows import BagTask, read_tow
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.running.chain import start_chain, stop_chain
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import Processes
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.topics import NAMESPACE
from trawl_ros.scenario.scenario import load_scenario
from trawl_ros.solver.equilibrium import steady_state

LOOK_S = 0.2
SHOWN = {
    'door_spread': 'm',
    'port_door_depth': 'm',
    'vertical_opening': 'm',
    'port_tension': 'kN',
}
"""Printed channels with their display units."""


def tow_repaired(scenario: str, model: Path, sea: Path, bag: Path, console: Console) -> None:
    """Tow a repaired gear with `sim_node` in the first state of a tow, and print both results.

    Parameters
    ----------
    scenario
        Packaged scenario of the tow at sea; the repaired gear takes its water from ``model`` only.
    model
        Gear file with the effect that was found.
    sea
        Bag of the tow at sea.
    bag
        Bag of the tow of the repaired gear, to be written.

    Raises
    ------
    TrawlError
        If a node fails, or one of the bags has no steady window.
    """
    at_sea = load_scenario(packaged(scenario, 'scenarios'))
    record = at_sea.record.model_dump(mode='json', include={'heading_deg', 'start', 'seed'})
    first = at_sea.record.steps[0].model_dump(mode='json', exclude_none=True)
    path = bag.with_suffix('.yaml')
    content = {
        'description': f'The first state of {scenario}, with the repaired gear',
        'gear': str(model.relative_to(bag.parent)),
        **record,
        'seed': at_sea.record.seed + 1,
        'steps': [first],
        'record': ['instruments'],
    }
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    with (
        console.status('towing the repaired gear with sim_node'),
        own_graph(bag.parent / 'log') as environment,
        Processes(bag.parent / 'log', environment) as processes,
    ):
        start_chain(processes, path, bag)
        while not processes.finished('sim_node'):
            time.sleep(LOOK_S)
        stop_chain(processes)
    _print(_first_window(sea, at_sea.record.gear), at_sea.record.gear, _first_window(bag, model))


def _first_window(bag: Path, gear: str | Path) -> SteadyWindow:
    found = read_tow(BagTask(bag, load_gear(gear), NAMESPACE))
    if not found.windows:
        problems = '; '.join(summarise(bag).problems) or found.why_not
        raise TrawlError(f'{bag}: found no steady window, expected one ({problems})')
    return found.windows[0]


def _print(sea: SteadyWindow, gear: str, repaired: SteadyWindow) -> None:
    lengths = [sea.means[f'{side}_length'] for side in ('port', 'starboard')]
    before = steady_state(
        build_model(load_gear(gear)), sum(lengths) / len(lengths), sea.means['speed']
    ).observables
    table = plain_table('', 'at sea', gear, 'repaired', right=('at sea', gear, 'repaired'))
    for name, unit in SHOWN.items():
        values = (sea.means[name], getattr(before, name), repaired.means[name])
        shown = (f'{value / UNITS[unit].size:.1f}' for value in values)
        table.add_row(f'{name.replace("_", " ")} ({unit})', *shown)
    console = output_console()
    console.print('The first state again, with the repaired gear, sim_node and all instruments:')
    console.print(table)


BASELINE = 'baseline'
TOWS = ('tow_1', 'tow_2', 'tow_3')
"""Bags; the scenario of each has ``hidden_`` ahead of its name."""

FOUND = 'diagnosis'
REPAIRED = 'repaired'
AGAIN = 'diagnosis_of_repaired'

NO_DISCREPANCY, DISCREPANCY = 0, 10
"""Exit codes of ``trawl diagnose``."""


class Commands:
    """Runner of ``trawl`` commands in a folder; leaving the context ends running commands.

    Parameters
    ----------
    folder
        Working folder, to which their arguments are relative.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._running: list[subprocess.Popen[str]] = []

    def run(self, *words: str, expected: int = 0) -> str:
        """Run a command to its end, and return its output.

        Raises
        ------
        TrawlError
            With what the command said, if it ends with another code than expected.
        """
        process = subprocess.Popen(
            [sys.executable, '-c', 'from trawl_ros.cli.main import main; main()', *words],
            cwd=self._folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self._running.append(process)
        out, errors = process.communicate()
        if process.returncode != expected:
            raise TrawlError(
                f'{self._folder}: trawl {" ".join(words)} ended with {process.returncode}, '
                f'expected {expected}: {(errors or out).strip()}'
            )
        return out

    def __enter__(self) -> 'Commands':
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._running:
            if process.poll() is None:
                process.terminate()


def hidden_effect(folder: Path, console: Console) -> None:
    """Diagnose tows in a current that the model lacks, and again with the repaired gear.

    Writes bags and reports into ``folder``, also of the repaired gear towed by `sim_node`, and
    prints the commands and their results.

    Raises
    ------
    TrawlError
        If a command fails, the current is not found, or a discrepancy remains afterwards.
    """
    made_folder(folder)
    bags = (BASELINE, *TOWS)
    diagnose = ('diagnose', *TOWS, '--baseline', BASELINE, '--out')
    with ThreadPoolExecutor(cores()) as pool, Commands(folder) as commands:
        towing = [_shown('tow', f'hidden_{bag}', '--out', bag) for bag in bags]
        with console.status('towing in a current that the model lacks'):
            try:
                list(pool.map(lambda words: commands.run(*words), towing))
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        with console.status('diagnosing'):
            found = commands.run(*_shown(*diagnose, FOUND), expected=DISCREPANCY)
        click.echo(found)
        model = folder / FOUND / MODEL_FILE
        if not model.is_file():
            raise TrawlError(f'{model.parent}: no effect was named; expected the current')
        tow_repaired(f'hidden_{TOWS[0]}', model, folder / TOWS[0], folder / REPAIRED, console)
        repaired = ('--gear', f'{FOUND}/{MODEL_FILE}')
        with console.status('diagnosing with the repaired gear'):
            again = commands.run(*_shown(*diagnose, AGAIN, *repaired), expected=NO_DISCREPANCY)
        click.echo(again)


def _shown(*words: str) -> Sequence[str]:
    click.echo(f'$ trawl {" ".join(words)}')
    return words
