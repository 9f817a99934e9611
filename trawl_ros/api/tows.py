# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tows: simulated, recorded as bags, and read."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.bags.samples import SampleStream
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.core.files import new_folder
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.resources import packaged_bag
from trawl_ros.gear.records import GearRecord
from trawl_ros.messages.cdr import serialize
from trawl_ros.records.samples import Sample
from trawl_ros.records.topics import NAMESPACE, absolute
from trawl_ros.records.truth import Truth
from trawl_ros.scenario.recording import recorded_messages
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import load_scenario


@dataclass(frozen=True)
class TowedBag:
    """Bag written by `tow`.

    Attributes
    ----------
    path
        Path of the bag.
    messages
        Number of messages by full topic name.
    duration_s, planned_s
        Duration of the tow, and of the scenario, s.
    complete
        True if the tow reached the end of the scenario.
    gear, end
        Gear that was towed, and the truth at the end of the tow.

    Examples
    --------
    >>> import trawl_ros
    >>> bag = trawl_ros.tow('tow.yaml', 'towed')
    >>> bag.duration_s, bag.planned_s, bag.complete
    (6.0, 6.0, True)
    """

    path: Path
    messages: Mapping[str, int]
    duration_s: float
    planned_s: float
    complete: bool
    gear: GearRecord
    end: Truth


def simulate(scenario: str | Path) -> Iterator[Truth]:
    """Tow a scenario without instruments and bag.

    Parameters
    ----------
    scenario
        File, or name of a scenario of the package.

    Yields
    ------
    Truth
        Doors, net, winches and ship at the scenario's ``truth_rate_hz``, SI units, ``map`` axes.

    Raises
    ------
    ScenarioError
        If the file has errors, or the gear cannot be towed in this way.
    NoSteadyState
        If the start has no usable steady state.

    Examples
    --------
    >>> from itertools import islice
    >>> import trawl_ros
    >>> [round(truth.winches[0].length) for truth in islice(trawl_ros.simulate('tow.yaml'), 2)]
    [300, 300]
    """
    trial = Trial(load_scenario(scenario))
    while (truth := trial.step()) is not None:
        yield truth


def tow(
    scenario: str | Path,
    out: str | Path,
    *,
    stopped: Callable[[], bool] = lambda: False,
    on_progress: OnProgress = ignore,
) -> TowedBag:
    """Tow a scenario and record the readings of its instruments; a seed gives the same bytes.

    Parameters
    ----------
    scenario
        File, or name of a scenario of the package.
    out
        New folder for the bag.
    stopped
        Function called between time steps; True ends the bag there, complete.
    on_progress
        Function called with the progress.

    Returns
    -------
    TowedBag
        Path, number of messages by topic, and duration.

    Raises
    ------
    BagError
        If ``out`` exists, or cannot be written to.
    ScenarioError, NoSteadyState
        As in `simulate`.

    Examples
    --------
    Six seconds on the coarse gear:

    >>> import trawl_ros
    >>> bag = trawl_ros.tow('tow.yaml', 'my_tow')
    >>> bag.messages['/trawl/winch/joint_states']
    13
    """
    out = new_folder(Path(out), BagError)
    loaded = load_scenario(scenario)
    on_progress(WorkProgress('looking for the steady states'))
    trial = Trial(loaded)
    interrupted = False
    with BagWriter(out) as bag:
        for stamp, messages in recorded_messages(trial):
            for topic, message in messages:
                bag.write(absolute(topic), message.__msgtype__, serialize(message), stamp)
            step = loaded.step_at(trial.time_s).name
            on_progress(WorkProgress('towing', trial.time_s, trial.duration_s, 's', step))
            if interrupted := stopped():
                break
    return TowedBag(
        out,
        dict(bag.counts),
        trial.time_s,
        trial.duration_s,
        complete=not interrupted,
        gear=loaded.plant,
        end=trial.simulation.truth(),
    )


def read_bag(bag: str | Path, *, namespace: str = NAMESPACE) -> Iterator[Sample]:
    """Yield the readings of a bag's instruments in the order of their log times.

    Parameters
    ----------
    bag
        Folder or file, MCAP or SQLite, of any ROS 2 distribution; it may be damaged.
    namespace
        Namespace of the topics.

    Yields
    ------
    Sample
        A `WinchSample`, `PressureSample`, `RangeSample`, …, each with its ``stamp`` in ns, SI
        units and radians.

    Raises
    ------
    BagError
        If the bag cannot be read, or a topic has two sources.

    Examples
    --------
    >>> import trawl_ros
    >>> samples = trawl_ros.read_bag('sea_trial')
    >>> type(next(samples)).__name__.endswith('Sample')
    True
    """
    for _, sample in SampleStream([packaged_bag(bag)], namespace):
        yield sample
