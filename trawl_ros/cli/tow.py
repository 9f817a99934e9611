"""``trawl tow``: a bag in one process, without DDS."""

from collections.abc import Iterator
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from trawl_ros.bags.writer import BagWriter
from trawl_ros.cli.files import BAG, SCENARIO
from trawl_ros.cli.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.progress import TimeProgress, error_console
from trawl_ros.errors import BagError
from trawl_ros.files import packaged
from trawl_ros.instruments.suite import InstrumentSuite
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.markers import gear_markers
from trawl_ros.messages.pieces import TopicMessage
from trawl_ros.messages.stamps import SECOND
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.messages.topics import PICTURES, absolute
from trawl_ros.messages.truth_to_messages import truth_messages
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import load_scenario


@click.command('tow')
@click.argument('scenario', type=SCENARIO)
@click.option('--out', required=True, type=BAG, help='Folder of the bag; must not exist yet.')
def command(scenario: Path, out: Path) -> None:
    """Tow SCENARIO and record it as a bag: the same bytes whenever the seed is the same."""
    if out.exists():
        raise BagError(f'{out}: exists already and is not written over; expected a new path')
    console = error_console()
    loaded = load_scenario(packaged(scenario, 'scenarios'))
    with console.status('looking for the steady states'):
        trial = Trial(loaded)
    with (
        BagWriter(out) as bag,
        TimeProgress('towing', trial.duration_s, console) as progress,
        Interruption() as interruption,
    ):
        for stamp, messages in recorded(trial):
            for topic, message in messages:
                bag.write(absolute(topic), message.__msgtype__, serialize(message), stamp)
            progress.update(trial.time_s, loaded.step_at(trial.time_s).name)
            if interruption.requested:
                break
    _summarise(out, bag, trial, progress)
    if interruption.requested:
        console.print(
            f'Interrupted after {trial.time_s / 60:.1f} of {trial.duration_s / 60:.1f} min: '
            f'{out} can be read as far as that.'
        )
        raise SystemExit(INTERRUPTED)


def recorded(trial: Trial) -> Iterator[tuple[int, list[TopicMessage]]]:
    """Tow a trial to its end; yield each stamp (ns) with all messages its scenario records."""
    scenario = trial.scenario
    suite = InstrumentSuite(
        scenario.instruments,
        surroundings=scenario.surroundings,
        draws=scenario.draws,
        faults=scenario.faults,
    )
    showing = scenario.showing()
    while (truth := trial.step()) is not None:
        messages: list[TopicMessage] = []
        if 'truth' in scenario.record.record:
            messages += truth_messages(truth)
            if truth.stamp % SECOND == 0:
                messages.append(gear_markers(trial.simulation.picture()))
        for topic, message in map(sample_message, map(showing, suite.observe(truth))):
            if ('pictures' if topic in PICTURES else 'instruments') in scenario.record.record:
                messages.append((topic, message))
        yield truth.stamp, messages


def _summarise(out: Path, bag: BagWriter, trial: Trial, progress: TimeProgress) -> None:
    table = Table(box=None, pad_edge=False)
    table.add_column('messages', justify='right')
    table.add_column('topic')
    for topic, count in bag.counts.items():
        table.add_row(str(count), topic)
    console = Console(soft_wrap=True, highlight=False)
    console.print(table)
    console.print(
        f'{out}: {sum(bag.counts.values())} messages, {trial.time_s / 60:.1f} min at sea in '
        f'{progress.elapsed_s:.1f} s, {progress.speed_factor:.1f} × real time'
    )
