"""Tow of the repaired gear through the ROS graph, beside the tow at sea that it is to be like."""

import time
from pathlib import Path

import yaml
from rich.console import Console

from trawl_ros.bags.reader import summarise
from trawl_ros.cli.tables import output_console, plain_table
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import packaged
from trawl_ros.core.units import UNITS
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
"""Channels that are printed, with the units in which one reads them."""


def tow_repaired(scenario: str, model: Path, sea: Path, bag: Path, console: Console) -> None:
    """Tow a repaired gear by `sim_node` in the first state of a tow, and print both beside.

    Parameters
    ----------
    scenario
        Packaged scenario of the tow at sea; of its water the repaired gear knows what it is told
        by ``model`` alone.
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
        console.status('towing the repaired gear by sim_node'),
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
    console.print('The first state again, by sim_node and all instruments, with the repaired gear:')
    console.print(table)
