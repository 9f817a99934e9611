# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Base class of the four instrument nodes: truth in, samples out, on truth's stamps."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from trawl_ros.core.errors import InstrumentError, MessageError
from trawl_ros.core.limits import TRUTH
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.sensor_effects import SensorEffects
from trawl_ros.gear.load import load_gear
from trawl_ros.instruments.errors.fault_plan import FaultPlan, PlannedFault
from trawl_ros.instruments.errors.faults import FaultPanel, Faulty
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.observing import ObservingInstruments
from trawl_ros.instruments.parameters import InstrumentParameters, load_instruments
from trawl_ros.messages.commands import FAULT_COMMAND, read_fault_command
from trawl_ros.messages.covariance_twins import covariance_twin
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.messages.fields import beyond
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.messages.truth_from_messages import observables_truth
from trawl_ros.model.water import build_water
from trawl_ros.nodes.runtime.credit import ConsumerProgress, Consumers
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Names, Number, Spec, Text
from trawl_ros.nodes.runtime.qos import CONSUMER, STREAM
from trawl_ros.records import topics
from trawl_ros.records.samples import Sample
from trawl_ros.records.sensors import INSTRUMENTS
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.scenario.scenario import load_scenario
from trawl_ros.scenario.sea import build_surroundings

OBSERVABLES = 'truth/observables'

LONGEST_WAIT = 200
"""Instants that may be incomplete at a time; truth at 10 Hz is 20 s of them."""


class Joiner:
    """Synchroniser of topics that all carry every stamp.

    Each topic's stamps rise until time is set back; from there on they belong to the next run.
    So nothing is mixed up when one topic has begun a run that another has not come to yet.

    Parameters
    ----------
    topics
        Names of the topics to be joined.

    Attributes
    ----------
    incomplete : int
        Instants given up because a topic was missing.
    """

    def __init__(self, topics: Sequence[str]) -> None:
        self._topics = tuple(topics)
        self._runs = dict.fromkeys(topics, 0)
        self._latest: dict[str, int] = {}
        self._waiting: dict[tuple[int, int], dict[str, Any]] = {}
        self.incomplete = 0

    def add(self, topic: str, stamp: int, message: Any) -> dict[str, Any] | None:
        """Add a message with its stamp (ns); return all of this stamp by topic once complete."""
        if stamp < self._latest.get(topic, stamp):
            self._runs[topic] += 1
        self._latest[topic] = stamp
        key = (self._run_of(topic, stamp), stamp)
        by_topic = self._waiting.setdefault(key, {})
        by_topic[topic] = message
        if len(by_topic) < len(self._topics):
            if len(self._waiting) > LONGEST_WAIT:
                # The one that waits longest: what false stamps have left behind may be ahead.
                self._give_up(next(iter(self._waiting)))
            return None
        for older in [other for other in self._waiting if other < key]:
            self._give_up(older)
        return self._waiting.pop(key)

    def _run_of(self, topic: str, stamp: int) -> int:
        """The run a message belongs to: the topic's own, unless only another awaits it.

        Who begins to listen while time is set back may hear the end of the run before on some
        topics only, and a single false stamp looks as if time were set back on its topic: their
        numbers would differ for ever.
        """
        own = self._runs[topic]
        awaiting = [
            run
            for (run, at), by_topic in self._waiting.items()
            if at == stamp and topic not in by_topic
        ]
        if awaiting and own not in awaiting and (own, stamp) not in self._waiting:
            self._runs[topic] = max(awaiting)
        return self._runs[topic]

    def _give_up(self, key: tuple[int, int]) -> None:
        del self._waiting[key]
        self.incomplete += 1


SEABED = 'truth/seabed'
"""Not finite where a scenario has no seabed."""


@dataclass(frozen=True)
class Setup:
    """Setup of the instruments, as in `InstrumentSuite`, with the sensor effects of their gear."""

    parameters: InstrumentParameters
    surroundings: Surroundings
    draws: SeedPlan
    sensor_effects: SensorEffects
    faults: tuple[PlannedFault, ...] = ()


class InstrumentNode(TrawlNode, ABC):
    """Base class of instrument nodes: observes truth whenever all parts of an instant are there.

    Samples are due by the stamps of truth alone, so the data are the same whatever the pace,
    and the same as those of `InstrumentSuite` in one process.
    """

    NAME: ClassVar[str]
    """Name of the node, by which the registry knows what it hears and publishes."""

    TRUTH: ClassVar[tuple[str, ...]]
    """Topics of truth that are looked at."""

    SAMPLES: ClassVar[tuple[str, ...]]
    """Topics of samples that are published."""

    TWINS: ClassVar[tuple[str, ...]]
    """Topics that carry samples with their covariance."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.TRUTH = tuple(row.name for row in topics.TRUTH if cls.NAME in row.heard_by)
        cls.SAMPLES = tuple(row.name for row in INSTRUMENTS if cls.NAME in row.published_by)
        cls.TWINS = tuple(row.name for row in topics.TWINS if cls.NAME in row.published_by)

    SPECS: ClassVar[tuple[Spec, ...]] = (
        Text('scenario', '', 'Scenario file or name: its instruments, seed, water and changes of '
             'state are used.'),
        Text('gear', 'kaifuha', 'Gear file or name, for the water and for effects that instruments '
             'have; a scenario brings its own.'),
        Text('instruments', 'default', 'File or name of instrument parameters; a scenario brings '
             'its own.'),
        Number('seed', -1, 'none', -1, 2**32 - 1, 'Seed of all noise; -1 is that of the scenario, '
               'or 0 without one.', whole=True),
        Names('faults', "Faults that are on, each as 'PLACE: FAULT', such as 'door/spread: offset "
              "3'; with those of the scenario and of command/fault.", live=True),
        Names('wait_for', 'Consumers of the samples (node names) without which this node does not '
              'announce itself to the simulation.'),
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(self.NAME, **kwargs)
        setup = self._setup()
        self._observing = ObservingInstruments(setup.parameters, setup.draws, (self.NAME,))
        self._panel = FaultPanel([*self.set_up(setup), *self._observing.instruments])
        self._sensor_effects = setup.sensor_effects
        self._plan = FaultPlan(setup.faults, self._panel)
        self._by_parameter: dict[str, str] = {}
        self._take_parameter()
        # Sensors of observables work by themselves: elsewhere truth may come without them.
        self._joiner = Joiner([topic for topic in self.TRUTH if topic != OBSERVABLES])
        for topic in (*self.SAMPLES, *self.TWINS):
            self.advertise(topic)
        self.listen(FAULT_COMMAND, self._command_fault, STREAM)
        self._progress = ConsumerProgress(self, self._ready())
        for topic in self.TRUTH:
            self._look_at(topic)

    @abstractmethod
    def set_up(self, setup: Setup) -> Sequence[Faulty]:
        """Make the instruments, and return all of them."""

    @abstractmethod
    def observe(self, stamp: int, messages: dict[str, Any]) -> Sequence[Sample]:
        """Return the samples due at a stamp (ns); ``messages`` are truth by topic."""

    def statuses(self) -> list[Status]:
        """Return the status of the instruments and their faults."""
        lost = self._joiner.incomplete
        values = {
            'truth seen until': f'{self._progress.stamp / 1e9:.1f}',
            'incomplete instants': str(lost),
        }
        faults = self._panel.active()
        sentence = f'{len(faults)} places have faults' if faults else 'no fault is on'
        there = Status('faults', WARN if faults else OK, sentence, faults)
        if lost:
            message = f'{lost} instants of truth were incomplete and gave no samples'
            return [Status('instruments', WARN, message, values), there]
        return [Status('instruments', OK, 'every instant of truth was complete', values), there]

    def objection(self, name: str, value: Any) -> str | None:
        """Return an objection to a live parameter's value; None without one."""
        if name == 'faults':
            try:
                for where, fault in _faults(value).items():
                    self._panel.check(where, fault)
            except InstrumentError as reason:
                return str(reason)
        return None

    def parameter_changed(self, name: str) -> None:
        """Apply a live parameter's new value."""
        if name == 'faults':
            self._take_parameter()

    def _take_parameter(self) -> None:
        for where, fault in self._by_parameter.items():
            self._panel.switch_off(where, fault)
        self._by_parameter = _faults(self.parameters['faults'])
        for where, fault in self._by_parameter.items():
            self._panel.switch(where, fault)

    def _command_fault(self, message: Any) -> None:
        where, fault = read_fault_command(message)
        if self._is_of_others(where):
            return
        try:
            self._panel.switch(where, fault)
        except InstrumentError as reason:
            raise MessageError(f'{FAULT_COMMAND}: {reason}') from reason

    def _is_of_others(self, where: str) -> bool:
        """True if a place belongs to another node."""
        if self._panel.knows(where):
            return False
        others = [row.name for row in INSTRUMENTS if row.name not in self.SAMPLES]
        return any(where == topic or where.startswith(f'{topic}/') for topic in others)

    def _send_samples(self, samples: Sequence[Sample]) -> None:
        for sample in map(self._sensor_effects, samples):
            self.send(*sample_message(sample))
            if twin := covariance_twin(sample, self._sensor_effects.water.depth):
                self.send(*twin)

    def _ready(self) -> Any:
        names = self.parameters['wait_for']
        return Consumers(self, names).ready if names else lambda: True

    def _setup(self) -> Setup:
        seed = self.parameters['seed']
        if name := self.parameters['scenario']:
            scenario = load_scenario(name)
            draws = scenario.draws if seed < 0 else SeedPlan(seed, scenario.state_changes_s)
            return Setup(
                scenario.instruments,
                scenario.surroundings,
                draws,
                scenario.sensor_effects(),
                scenario.faults,
            )
        gear = load_gear(self.parameters['gear'])
        return Setup(
            load_instruments(self.parameters['instruments']),
            build_surroundings(gear),
            SeedPlan(max(seed, 0)),
            SensorEffects(effects_of(gear), build_water(gear)),
        )

    def _look_at(self, topic: str) -> None:
        def take(message: Any) -> None:
            # A huge finite number is infinite in the shorter numbers of a reading.
            if wrong := beyond(message, TRUTH.value, unknown=topic == SEABED):
                raise MessageError(
                    f'{topic}: {min(wrong)} is not finite, or beyond ±{TRUTH.value:g}; expected '
                    'numbers of a tow'
                )
            stamp = stamp_of(message)
            if topic == OBSERVABLES:
                self._plan.follow(stamp)
                self._send_samples(self._observing.observe(observables_truth(message), stamp))
                return
            complete = self._joiner.add(topic, stamp, message)
            if complete is None:
                return
            self._plan.follow(stamp)
            try:
                self._send_samples(self.observe(stamp, complete))
            except MessageError as reason:
                self.refuse(topic, str(reason))
            self._progress.done(stamp)

        # As patient as a recorder: a truth that is lost is a sample that is lost.
        self.listen(topic, take, CONSUMER, settled=True)


def _faults(texts: Sequence[str]) -> dict[str, str]:
    """Parse faults by place, from texts such as 'door/spread: offset 3'."""
    faults = {}
    for text in texts:
        where, colon, fault = text.partition(':')
        if not colon:
            raise InstrumentError(f"parameter faults: found '{text}', expected 'PLACE: FAULT'")
        faults[where.strip()] = fault.strip()
    return faults
