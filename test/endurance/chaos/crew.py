"""Nodes of a tow as processes that are stopped, killed and restarted."""

import time
from dataclasses import dataclass, replace
from pathlib import Path
from signal import SIGCONT, SIGSTOP

import psutil

from endurance.chaos.plan import IDENTIFICATION, RECORDER, SIMULATION
from endurance.watching import JournalMonitor
from trawl_ros.bags.reader import Bag
from trawl_ros.bags.repair import repair_bag
from trawl_ros.core.errors import BagError
from trawl_ros.lab.running.chain import INSTRUMENTS, chain_parameters
from trawl_ros.lab.running.processes import Processes
from trawl_ros.records.topics import INSTRUMENTS as INSTRUMENT_TOPICS
from trawl_ros.records.topics import absolute

TRUTH, IMAGE = absolute('truth/winch'), absolute('sonar/image')
READINGS = {absolute(topic.name) for topic in INSTRUMENT_TOPICS}


@dataclass(frozen=True)
class Recording:
    """Recording of a tow, and how its recorder ended.

    ``end`` says how, ``ended`` when (wall time, s), ``lost_s`` is the wall time by which truth
    that is missing in the bag had been heard before; ``problem`` says why it cannot be read.
    """

    path: Path
    end: str = 'stopped'
    ended: float = 0.0
    lost_s: float = 0.0
    messages: int = 0
    images: int = 0
    problem: str = ''


class Crew:
    """The chain and, if asked for, the identification.

    Parameters
    ----------
    processes
        Runs the nodes.
    scenario, gear
        Of the tow.
    folder
        Takes bags and the state of the estimate.
    identify
        True if `identification_node` is one of them.
    """

    def __init__(
        self, processes: Processes, scenario: Path, gear: str, folder: Path, *, identify: bool
    ) -> None:
        self._processes = processes
        self._scenario = scenario
        self._gear = gear
        self._folder = folder
        self.state = folder / 'state.json'
        self.recordings: list[Recording] = []
        self.nodes = (RECORDER, *([IDENTIFICATION] if identify else []), *INSTRUMENTS, SIMULATION)
        for node in self.nodes:
            self.start(node)

    def start(self, node: str) -> None:
        """Start a node, the recorder with a new bag."""
        if node == RECORDER:
            self.recordings.append(Recording(self._folder / f'bag{len(self.recordings)}'))
        if node == IDENTIFICATION:
            self._processes.start(
                node, use_sim_time=True, gear=self._gear, state=str(self.state), advise=False
            )
        else:
            consumers = [name for name in self.nodes if name != SIMULATION]
            bag = self.recordings[-1].path
            parameters = chain_parameters(node, self._scenario, bag, consumers)
            self._processes.start(node, **parameters)

    def stop(self, node: str) -> None:
        """Stop a node (SIGSTOP)."""
        self._processes.signal(node, SIGSTOP)

    def go_on(self, node: str) -> None:
        """Continue a stopped node (SIGCONT)."""
        self._processes.signal(node, SIGCONT)

    def kill(self, node: str) -> None:
        """Kill a node and restart it."""
        ended = time.monotonic()
        self._processes.kill(node)
        self.ended(node, 'killed', ended)
        self.start(node)

    def fill_disk(self) -> None:
        """Limit the size of the recorder's files to what they have now.

        A limit of the process, since a full disk would be that of everybody: writing fails the
        same way, with another number.
        """
        newest = self.recordings[-1].path
        size = max((file.stat().st_size for file in newest.glob('*.mcap')), default=0)
        recorder = psutil.Process(self._processes.pids()[RECORDER])
        recorder.rlimit(psutil.RLIMIT_FSIZE, (size, size))

    def ended(self, node: str, how: str, when: float) -> None:
        """Register how a node ended."""
        if node == RECORDER:
            self.recordings[-1] = replace(self.recordings[-1], end=how, ended=when)


def looked_into(recording: Recording, monitor: JournalMonitor) -> Recording:
    """Read a bag, repaired where that is needed, and compare its end with the received truth."""
    try:
        repaired = repair_bag(recording.path).out or recording.path
        latest, read, messages, images = 0, 0, 0, 0
        for message in Bag(repaired).as_stored():
            messages += 1
            images += message.topic == IMAGE
            if message.topic == TRUTH:
                latest = max(latest, message.log_time)
            elif message.topic in READINGS:
                read = max(read, message.log_time)
    except BagError as reason:
        return replace(recording, problem=str(reason))
    # Killed soon after its start, a recorder may know those who read truth, and not yet truth.
    missed = monitor.first_after(latest or read)
    lost_s = 0.0 if missed is None or not recording.ended else max(0.0, recording.ended - missed)
    return replace(recording, lost_s=lost_s, messages=messages, images=images)
