# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`trial_node`: sails a trial by itself, as far as its operator lets it."""

import math
import re
import time
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from trawl_ros.control.trial.machine import Trial
from trawl_ros.control.trial.memory import TrialMemory, load_memory, save_memory
from trawl_ros.control.trial.records import TrialCommand, TrialSettings, TrialState
from trawl_ros.core.errors import MessageError, TrawlError
from trawl_ros.core.files import is_there
from trawl_ros.core.time import SECOND
from trawl_ros.gear.load import load_gear
from trawl_ros.messages.commands import (
    VESSEL_COMMAND,
    WINCH_COMMAND,
    vessel_command,
    winch_command,
)
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status, diagnostic_array, read_statuses
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.model.water import build_water
from trawl_ros.nodes.command_watch import MAX_AGE, CommandWatch
from trawl_ros.nodes.runtime.credit import HEADER, ConsumerProgress, consumer_of
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Names
from trawl_ros.nodes.runtime.qos import CONSUMER, LATCHED, STREAM
from trawl_ros.nodes.runtime.reading import Reached, Rewinding
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.workers.proposals import read_knowledge
from trawl_ros.nodes.workers.trial_settings import TRIAL_SPECS, trial_settings
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import RangeSample
from trawl_ros.records.topics import SYNC

STATUS = 'trial/status'
IDENTIFICATION = 'identification/status'
WINCH = 'winch/joint_states'
SENSORS = (
    WINCH,
    'door/port/pressure',
    'door/starboard/pressure',
    'sonar/pressure',
    'sonar/opening_height',
    'sonar/bottom',
    'vessel/velocity_water',
    'vessel/heading',
    'vessel/echo_sounder/depth',
)

UPDATE_NS = SECOND // 4
"""Time between two commands."""

TICK_S = 0.05
"""Wall time between two looks at the time: readings that have ceased give no occasion."""

LOST_S = 1.5
"""Nodes say every half second of wall time that they are there, and instruments at sea say
something more often; not heard for so long they are lost."""

WHAT = re.compile('[,;]')
"""Marks behind which a trial says how long it has waited, and how far on that is."""

OWN = 400
"""Commands of which is known that they are our own, when they come in."""


class TrialNode(TrawlNode):
    """Sails a trial: goes where the identification learns most, as `trawl_ros.control.trial` says.

    It commands winches and ship through ``command/winch`` and ``command/vessel``. Services
    ``trial/pause``, ``trial/resume``, ``trial/veto`` and ``trial/take_over`` are the operator's; a
    command of somebody else takes over too.
    """

    SPECS: ClassVar = (
        *TRIAL_SPECS,
        MAX_AGE,
        Names('needs', 'Nodes that must be heard on sync/progress; without one of them it holds.',
              ('identification_node',)),
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('trial_node', **kwargs)
        gear = load_gear(self.parameters['gear'])
        gear.require_boards('for whose coefficients a trial could be sailed')
        self._gear = gear
        state = self.parameters['state']
        self._file = Path(state) if state else None
        self._trouble = self._obeyed = ''
        memory = self._resumed()
        self._trial = Trial(self._settings(), build_water(gear).depth, memory)
        self._saved = memory
        self._updated = 0
        self._own: deque[tuple[Any, ...]] = deque(maxlen=OWN)
        self._rewinding, self._reached = Rewinding(), Reached()
        self._heard_at = -math.inf
        self._beats = dict.fromkeys(self.parameters['needs'], -math.inf)
        self._news: tuple[object, ...] = ()
        self._line: tuple[object, ...] = ()
        for topic in (WINCH_COMMAND, VESSEL_COMMAND, STATUS):
            self.advertise(topic)
        self._progress = ConsumerProgress(self, idle=lambda: True)
        for name, act in (
            ('pause', self._trial.pause),
            ('resume', self._trial.resume),
            ('veto', self._trial.veto),
            ('take_over', self._trial.take_over),
        ):
            self.offer(f'trial/{name}', partial(self._obey, act))
        for topic in SENSORS:
            self.listen(topic, partial(self._take, topic), CONSUMER)
        self.listen(IDENTIFICATION, self._learn, LATCHED)
        self.listen(SYNC, self._hear_beat, STREAM, HEADER)
        self.listen(WINCH_COMMAND, partial(self._hear_command, WINCH_COMMAND), STREAM)
        self.listen(VESSEL_COMMAND, partial(self._hear_command, VESSEL_COMMAND), STREAM)
        self.every(TICK_S, self._tick)
        self._say()

    def parameter_changed(self, name: str) -> None:
        """Apply a live parameter's new value."""
        self._trial.change(self._settings())

    def statuses(self) -> list[Status]:
        """Return the status of the trial."""
        return [self._status(self._trial.state())]

    def finish_work(self) -> None:
        """Save the trial; ship and winches stay as they were commanded last."""
        self._save()

    def _settings(self) -> TrialSettings:
        return trial_settings(self.parameters, self._gear)

    def _resumed(self) -> TrialMemory | None:
        if self._file is None or not is_there(self._file, TrawlError):
            return None
        memory = load_memory(self._file)
        self.get_logger().info(
            f'{self._file}: goes on after {len(memory.towed)} states, in phase {memory.phase}'
        )
        return memory

    def _take(self, topic: str, message: Any) -> None:
        sample = to_sample(topic, message)
        # An infinite range is one without an echo; the watch looks at how old the last one is.
        echo = not isinstance(sample, RangeSample) or math.isfinite(sample.distance)
        if echo and (reason := impossible(sample)):
            raise MessageError(f'{topic}: {reason}')
        rewound, samples = self._rewinding.take(sample)
        if rewound:
            self._reached = Reached()
        self._heard_at = time.monotonic()
        for one in samples:
            self._trial.take(one, self._reached.take(one.stamp))
            self._update(self._reached.stamp)
        if topic == WINCH:
            self._progress.done(sample.stamp)

    def _learn(self, message: Any) -> None:
        knowledge = read_knowledge(read_statuses(message))
        if knowledge is not None:
            self._trial.learn(knowledge)

    def _hear_beat(self, message: Any) -> None:
        name, _ = consumer_of(message)
        if name in self._beats:
            self._beats[name] = time.monotonic()

    def _hear_command(self, topic: str, message: Any) -> None:
        trial = self._trial
        if trial.memory.mode == 'taken over' or trial.memory.phase in ('start', 'done'):
            return
        stamp = stamp_of(message)
        if (topic, stamp) in self._own:
            return
        # A simulation that refuses an old command is not taken over by it either.
        CommandWatch(topic).take(stamp, self._time(), 0.0, self.parameters['max_command_age_s'])
        self._obey(partial(trial.take_over, f'another node publishes {topic}'))

    def _obey(self, act: Callable[[], str]) -> str:
        sentence = act()
        # Whoever calls often would fill the log.
        if sentence != self._obeyed:
            self._obeyed = sentence
            self.get_logger().info(sentence)
        self._updated = 0
        self._update(self._time())
        return sentence

    def _lost(self) -> tuple[str, ...]:
        now = time.monotonic()
        return tuple(name for name, beat in self._beats.items() if now - beat > LOST_S)

    def _time(self) -> int:
        """Time of the readings while any come in, else that of the clock.

        A simulation may be ahead of those who listen, by more than the age of a stale reading.
        """
        silent = time.monotonic() - self._heard_at > LOST_S
        return max(self.now(), self._reached.stamp) if silent else self._reached.stamp

    def _tick(self) -> None:
        self._update(self._time())

    def _update(self, now: int) -> None:
        # A clock that stands at 0 has not begun.
        if now == 0 or 0 <= now - self._updated < UPDATE_NS:
            return
        self._updated = now
        command = self._trial.update(now, self._lost())
        if command is not None:
            self._send(now, command)
        self._save()
        self._say()

    def _send(self, now: int, command: TrialCommand) -> None:
        for topic, message in (
            winch_command(now, command.port, command.starboard),
            vessel_command(now, command.speed, command.turn_rate),
        ):
            self._own.append((topic, now))
            self.send(topic, message)

    def _save(self) -> None:
        memory = self._trial.memory
        if self._file is None or memory is self._saved:
            return
        try:
            save_memory(self._file, memory)
        except TrawlError as reason:
            self._trouble = str(reason)
        else:
            self._saved, self._trouble = memory, ''

    def _say(self) -> None:
        """Publish and log the state when it has changed."""
        state = self._trial.state()
        news = (state.phase, state.mode, state.held, state.target, state.waits, self._trouble)
        if news == self._news:
            return
        self._news = news
        # The log has once that it waits, the status how long.
        waits = WHAT.split(state.waits)[0] if state.phase in ('start', 'advice') else ''
        line = (*news[:4], waits, self._trouble)
        if line != self._line:
            self._line = line
            if state.held or self._trouble:
                self.get_logger().warning(f'trial: {self._trouble or state}')
            else:
                self.get_logger().info(f'trial: {state}')
        self.send(STATUS, diagnostic_array(self.now(), [self._status(state)]))

    def _status(self, state: TrialState) -> Status:
        values = {
            'phase': state.phase,
            'mode': state.mode,
            'held': '; '.join(state.held),
            'waits': state.waits,
            'hours': f'{state.hours:.3f}',
            'known': str(state.known),
            'windows': str(state.windows),
            'states': str(state.towed),
            'struck off': str(state.struck),
        }
        if (target := state.target) is not None:
            values |= {
                'port_warp': f'{target.port:g}',
                'starboard_warp': f'{target.starboard:g}',
                'speed': f'{target.speed:g}',
            }
        if self._trouble:
            return Status('trial', ERROR, self._trouble, values)
        calm = state.mode == 'sails' and not state.held
        return Status('trial', OK if calm else WARN, str(state), values)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(TrialNode, args)
