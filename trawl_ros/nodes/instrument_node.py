"""What the four instrument nodes have in common: truth in, samples out, on truth's stamps."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from trawl_ros.errors import MessageError
from trawl_ros.files import packaged
from trawl_ros.gear.load import load_gear
from trawl_ros.instruments.instrument import Draws
from trawl_ros.instruments.parameters import InstrumentParameters, load_instruments
from trawl_ros.instruments.pressure import PressureAt
from trawl_ros.instruments.samples import Sample
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.model.gear_model import build_water
from trawl_ros.nodes.joining import Joiner
from trawl_ros.nodes.node import TrawlNode
from trawl_ros.nodes.parameters import Names, Number, Text
from trawl_ros.nodes.qos import CONSUMER
from trawl_ros.nodes.sync import Consumers, Progress
from trawl_ros.scenario.scenario import load_scenario


@dataclass(frozen=True)
class Setup:
    """What instruments are made with, as in `InstrumentSuite`."""

    parameters: InstrumentParameters
    pressure_at: PressureAt
    draws: Draws


class InstrumentNode(TrawlNode, ABC):
    """Looks at truth whenever all that it needs of an instant is there.

    Samples are due by the stamps of truth alone, so the data are the same whatever the pace,
    and the same as those of `InstrumentSuite` in one process.
    """

    TRUTH: ClassVar[tuple[str, ...]] = ()
    """Topics of truth that are looked at."""

    SAMPLES: ClassVar[tuple[str, ...]] = ()
    """Topics of samples that are published."""

    SPECS: ClassVar = (
        Text('scenario', '', 'Scenario file or name: its instruments, seed, water and changes of '
             'state are used.'),
        Text('gear', 'kaifuha', 'Gear file or name, for the water; a scenario brings its own.'),
        Text('instruments', 'default', 'File or name of instrument parameters; a scenario brings '
             'its own.'),
        Number('seed', -1, 'none', -1, 2**32 - 1, 'Seed of all noise; -1 is that of the scenario, '
               'or 0 without one.', whole=True),
        Names('wait_for', 'Consumers of the samples (node names) without which this node does not '
              'announce itself to the simulation.'),
    )  # fmt: skip

    def __init__(self, name: str, **kwargs: Any) -> None:
        super().__init__(name, **kwargs)
        self.set_up(self._setup())
        self._joiner = Joiner(self.TRUTH)
        for topic in self.SAMPLES:
            self.advertise(topic)
        self._progress = Progress(self, self._ready())
        for topic in self.TRUTH:
            self._look_at(topic)

    @abstractmethod
    def set_up(self, setup: Setup) -> None:
        """Make the instruments."""

    @abstractmethod
    def observe(self, stamp: int, messages: dict[str, Any]) -> Sequence[Sample]:
        """Give the samples due at a stamp (ns); ``messages`` are truth by topic."""

    def statuses(self) -> list[Status]:
        """How far the instruments are."""
        lost = self._joiner.incomplete
        values = {
            'truth seen until': f'{self._progress.stamp / 1e9:.1f}',
            'incomplete instants': str(lost),
        }
        if lost:
            message = f'{lost} instants of truth were incomplete and gave no samples'
            return [Status('instruments', WARN, message, values)]
        return [Status('instruments', OK, 'every instant of truth was complete', values)]

    def _ready(self) -> Any:
        names = self.parameters['wait_for']
        return Consumers(self, names).ready if names else lambda: True

    def _setup(self) -> Setup:
        seed = self.parameters['seed']
        if name := self.parameters['scenario']:
            scenario = load_scenario(packaged(Path(name), 'scenarios'))
            draws = scenario.draws if seed < 0 else Draws(seed, scenario.state_changes_s)
            water = build_water(scenario.plant)
            return Setup(scenario.instruments, water.pressure, draws)
        return Setup(
            load_instruments(self.parameters['instruments']),
            build_water(load_gear(self.parameters['gear'])).pressure,
            Draws(max(seed, 0)),
        )

    def _look_at(self, topic: str) -> None:
        def take(message: Any) -> None:
            stamp = stamp_of(message)
            complete = self._joiner.add(topic, stamp, message)
            if complete is None:
                return
            try:
                for sample in self.observe(stamp, complete):
                    self.send(*sample_message(sample))
            except MessageError as reason:
                self.refuse(topic, str(reason))
            self._progress.done(stamp)

        # As patient as a recorder: a truth that is lost is a sample that is lost.
        self.listen(topic, take, CONSUMER)
