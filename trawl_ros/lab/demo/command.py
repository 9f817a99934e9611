# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``trawl demo``: the whole chain through the real ROS graph, one process per node."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console

from trawl_ros.api import trials
from trawl_ros.bags.reader import summarise
from trawl_ros.bags.sentence_log import write_sentence_log
from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.cli.identify import print_report
from trawl_ros.cli.options import FOLDER, SCENARIO
from trawl_ros.core.errors import RosMissing, TrawlError
from trawl_ros.core.files import write_figure
from trawl_ros.core.progress import WorkProgress
from trawl_ros.core.resources import packaged
from trawl_ros.estimation.report.report import Report
from trawl_ros.lab.demo.folder import DemoFolder
from trawl_ros.lab.demo.hidden import hidden_effect
from trawl_ros.lab.demo.short_tows import diagnose_short_tows
from trawl_ros.lab.demo.summary import (
    finding_lines,
    load_result,
    refitted_line,
)
from trawl_ros.lab.running.chain import start_chain, stop_chain
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import Processes
from trawl_ros.model.water import build_water
from trawl_ros.plots.gear import gear_figure
from trawl_ros.plots.histories import history_figure
from trawl_ros.plots.moments import GEAR, read_moments
from trawl_ros.plots.reading import read_history
from trawl_ros.plots.shapes import gear_shape
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.fields import WaterColumn
from trawl_ros.records.topics import INSTRUMENTS, NAMESPACE, TRUTH, absolute
from trawl_ros.report.style import DPI
from trawl_ros.scenario.scenario import Scenario, load_scenario, true_coefficients
from trawl_ros.sentences.table import load_tables
from trawl_ros.view.bags import TowBags

if TYPE_CHECKING:
    from trawl_ros.lab.running.monitor import Monitor


LOOK_S = 0.2
PAGES = ('history.png', 'gear.png', 'report.html')
HIDDEN_PAGES = ('hidden/report.html', 'hidden/gap.png', 'hidden/model.yaml')
SYSTEMS = ('marport', 'scantrol', 'ship')


@dataclass
class Steps:
    """Steps of the demo, each announced with about how long it takes on two idle cores."""

    console: Console
    total: int
    number: int = 0

    def say(self, what: str, about_s: float) -> None:
        """Announce the next step."""
        self.number += 1
        self.console.print(f'{self.number} of {self.total}: {what}, about {about_s:g} s')


@dataclass(frozen=True)
class TopicCounts:
    """Messages by full topic name, as counted by publishers and as found in the bag."""

    published: Mapping[str, int]
    recorded: Mapping[str, int]

    @property
    def lost(self) -> dict[str, tuple[int, int]]:
        """Topics on which the two counts differ, with both counts."""
        return {
            topic: (self.published.get(topic, 0), self.recorded.get(topic, 0))
            for topic in sorted(self.published.keys() | self.recorded.keys())
            if self.published.get(topic, 0) != self.recorded.get(topic, 0)
        }


@click.command('demo')
@click.option('--out', required=True, type=FOLDER, help='Folder for the results.')
@click.option(
    '--scenario', type=SCENARIO, help='Scenario to tow, by default demo_short; with --full demo.'
)
@click.option('--full', is_flag=True, help='Tow an hour, fit all of it, and tow what is diagnosed.')
@click.option(
    '--diagnosis/--no-diagnosis', default=True, show_default=True, help='At the end, diagnose '
    'tows with an effect that the model lacks.',
)  # fmt: skip
def command(out: Path, scenario: Path | None, full: bool, diagnosis: bool) -> None:
    """Tow a synthetic trial through a ROS graph, record it, replay it, and estimate the doors.

    Every node is a separate process, and they communicate by DDS on this machine only. The folder
    receives the bag, identification.json, figures and summary.json. At the end the command
    diagnoses steady states with an effect that the model lacks, and writes a gear file with this
    effect into the folder 'hidden'.

    With --full it tows an hour, and estimates the doors from all of it, hauling included. It also
    tows what it diagnoses, in a current, and the repaired gear.
    """
    path = packaged(scenario or ('demo' if full else 'demo_short'), 'scenarios').absolute()
    loaded = load_scenario(path)
    truth = dict(zip(COEFFICIENTS, true_coefficients(path).tolist(), strict=True))
    folder = DemoFolder(out)
    console = error_console()
    steps = Steps(console, (5 if full else 4) - (not diagnosis))
    began = time.monotonic()
    with (
        own_graph(folder.logs) as environment,
        Processes(folder.logs, environment) as processes,
        _monitor(environment) as monitor,
    ):
        steps.say(
            f'{loaded.duration_s / 60:.0f} minutes at sea by simulation, instruments and recorder',
            120 if full else 30,
        )
        tow_s = _tow(processes, monitor, loaded, folder, console)
        traffic = _traffic(monitor, folder)
        steps.say('replay into the identification, which refits the boards', 60 if full else 20)
        _replay(processes, monitor, loaded, folder)
    learned = None
    if full:
        steps.say('fit of the boards to the whole tow', 120)
        learned = _learn(loaded, folder, console)
    result = load_result(folder.path)
    steps.say('pictures of the tow', 40 if full else 10)
    if full:
        _view(loaded, folder, console)
    figures = _draw(loaded, folder)
    _speak(loaded, folder)
    summary = {
        'finished': True,
        'scenario': path.stem,
        'minutes_at_sea': loaded.duration_s / 60.0,
        'times_real_time': loaded.duration_s / tow_s,
        'seconds': {'tow': tow_s, 'all': time.monotonic() - began},
        'messages': {
            topic: {'published': count, 'recorded': traffic.recorded.get(topic, 0)}
            for topic, count in sorted(traffic.published.items())
        },
        'messages_lost': sum(abs(a - b) for a, b in traffic.lost.values()),
        'windows': result['windows'],
        'objective': result['objective'],
        'channels': result['channels'],
        'coefficients': {
            name: {**values, 'truth': truth[name]}
            for name, values in result['coefficients'].items()
        },
        'chain': result.get('chain'),
        'bag': folder.bag.name,
        'figures': figures,
    }
    folder.write_summary(summary)
    _require_all(traffic, folder)
    if learned is not None:
        print_report(learned)
        _close(loaded, folder, traffic, tow_s, time.monotonic() - began)
        if diagnosis:
            steps.say('four more tows, their diagnosis and the repaired gear', 180)
            hidden_effect(folder.hidden, console)
        return
    found = None
    if diagnosis:
        steps.say('states of a log that errs, made without towing in time, diagnosed', 40)
        with ProgressDisplay(console) as display:
            found = diagnose_short_tows(folder.hidden, display)
        folder.write_summary({**summary, 'hidden': found.sizes})
    lines = (
        f'{loaded.duration_s / 60:.0f} min at sea, {tow_s:.0f} s here: '
        f'{sum(traffic.recorded.values())} messages recorded, as many as were published.',
        refitted_line(result, truth),
        *(() if found is None else finding_lines(found)),
    )
    click.echo('\n'.join(lines))
    click.echo(f'\nOpen, after {time.monotonic() - began:.0f} s:')
    for name in (*PAGES, *(() if found is None else HIDDEN_PAGES)):
        click.echo(f'  {folder.path / name}')


def _monitor(environment: Mapping[str, str]) -> 'Monitor':
    try:
        from trawl_ros.lab.running.monitor import Monitor
    except ImportError as reason:
        raise RosMissing('the demo', reason) from reason
    return Monitor(environment)


def _tow(
    processes: Processes,
    monitor: 'Monitor',
    scenario: Scenario,
    folder: DemoFolder,
    console: Console,
) -> float:
    """Tow and record; return the wall time (s)."""
    start_chain(processes, scenario.path, folder.bag)
    began = time.monotonic()
    with ProgressDisplay(console) as display:
        while not processes.finished('sim_node'):
            done = float(monitor.value('sim_node', 'tow', 'simulated time') or 0.0)
            step = monitor.value('sim_node', 'tow', 'step') or 'starting nodes'
            display(WorkProgress('towing', done, scenario.duration_s, 's', step))
            time.sleep(LOOK_S)
    took = time.monotonic() - began
    stop_chain(processes)
    return took


def _traffic(monitor: 'Monitor', folder: DemoFolder) -> TopicCounts:
    summary = summarise(folder.bag)
    if summary.problems:
        raise TrawlError('; '.join(summary.problems))
    watched = {absolute(topic.name) for topic in (*TRUTH, *INSTRUMENTS)}
    return TopicCounts(
        {topic: count for topic, count in monitor.published().items() if topic in watched},
        {entry.topic: entry.count for entry in summary.topics if entry.topic in watched},
    )


def topics_of_channels(bag: Path) -> list[str]:
    """Return the topics of a bag that the identification reads; not every ship has every sensor."""
    read = {absolute(channel.topic) for channel in CHANNELS.values()}
    return [entry.topic for entry in summarise(bag).topics if entry.topic in read]


def _replay(
    processes: Processes,
    monitor: 'Monitor',
    scenario: Scenario,
    folder: DemoFolder,
) -> None:
    """Replay the instrument topics of the bag to the identification, and let it finish."""
    path = str(scenario.path)
    processes.start(
        'identification_node',
        use_sim_time=True,
        gear=str(scenario.gear_file),
        truth=path,
        # At this speed the whole tow is fitted afterwards, from the bag.
        motion=False,
        output=str(folder.results),
    )
    processes.start(
        'bag_player',
        bag=str(folder.bag),
        rate=0.0,
        topics=topics_of_channels(folder.bag),
        wait_for=['identification_node'],
    )
    with ProgressDisplay(error_console()) as display:
        while not processes.finished('bag_player'):
            done = float(monitor.value('bag_player', 'bag', 'played until') or 0.0)
            windows = monitor.value('identification_node', 'estimate', 'windows') or '0'
            detail = f'{windows} steady windows'
            display(WorkProgress('replaying', done, scenario.duration_s, 's', detail))
            time.sleep(LOOK_S)
    success, message = monitor.finish_identification(processes.check)
    if not success:
        raise TrawlError(f'{folder.bag}: {message}')
    processes.stop('identification_node')
    folder.gather_results()


def _learn(scenario: Scenario, folder: DemoFolder, console: Console) -> Report:
    """Fit the boards to the whole tow.

    The report replaces that of the replay, whose windows it has.
    """
    with ProgressDisplay(console) as display:
        found = trials.identify(
            [folder.bag],
            gear=scenario.gear_file,
            truth=scenario.path,
            out=folder.results,
            on_progress=display,
        )
    folder.gather_results()
    return found


def _view(scenario: Scenario, folder: DemoFolder, console: Console) -> None:
    """Draw the tow in the viewer, if it is installed and this machine can draw."""
    try:
        from trawl_ros.view.picture import write_picture

        with ProgressDisplay(console) as display:
            tow = TowBags([folder.bag])
            write_picture(tow, scenario.plant, folder.path / 'view.png', on_progress=display)
    except TrawlError as reason:
        console.print(f'view.png is left out: {reason}', highlight=False, markup=False)


def _draw(scenario: Scenario, folder: DemoFolder) -> list[str]:
    read = read_history(folder.bag, build_water(scenario.plant).depth, NAMESPACE)
    tow = replace(read, name=scenario.path.stem)
    write_figure(folder.path / 'history.png', history_figure(tow), DPI)
    (end,) = read_moments(folder.bag, tow, [tow.duration_s], NAMESPACE, [GEAR])
    shape = gear_shape(end, tow, scenario.plant)
    if shape is not None:
        write_figure(folder.path / 'gear.png', gear_figure(shape, tow.name), DPI)
    return sorted(file.name for file in folder.path.glob('*.png'))


def _speak(scenario: Scenario, folder: DemoFolder) -> None:
    """Write the tow as sentences of a ship's instruments."""
    density = build_water(scenario.plant).density
    write_sentence_log(
        folder.bag,
        load_tables(SYSTEMS),
        folder.path / folder.SENTENCES,
        water=WaterColumn(density_kg_m3=density),
    )


def _close(
    scenario: Scenario, folder: DemoFolder, traffic: TopicCounts, tow_s: float, all_s: float
) -> None:
    recorded = sum(traffic.recorded.values())
    click.echo(
        f'{scenario.duration_s / 60:.1f} min at sea in {tow_s:.1f} s, '
        f'{scenario.duration_s / tow_s:.1f} × real time; {all_s:.0f} s in all'
    )
    click.echo(f'{folder.bag}: {recorded} messages, as many as were published')
    click.echo(f'{folder.path}: summary.json, identification.json and figures')


def _require_all(traffic: TopicCounts, folder: DemoFolder) -> None:
    if traffic.lost:
        listed = '; '.join(
            f'{topic}: {published} published, {recorded} recorded'
            for topic, (published, recorded) in traffic.lost.items()
        )
        raise TrawlError(
            f'{folder.bag}: messages are missing; expected all that were published: {listed}'
        )
