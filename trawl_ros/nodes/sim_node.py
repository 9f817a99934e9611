# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`sim_node`: tows the gear and publishes the truth of it."""

import math
from collections.abc import Sequence
from dataclasses import replace
from time import monotonic
from typing import Any, ClassVar

from trawl_ros.core.errors import MessageError, TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.gear.load import load_gear
from trawl_ros.messages.commands import (
    VESSEL_COMMAND,
    WINCH_COMMAND,
    read_vessel_command,
    read_winch_command,
    read_winch_speeds,
)
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status
from trawl_ros.messages.markers import gear_markers
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.transforms import transforms_message
from trawl_ros.messages.truth_to_messages import clock_message, truth_messages
from trawl_ros.nodes.command_watch import MAX_AGE, CommandWatch
from trawl_ros.nodes.runtime.credit import SILENT_S, STALLED_S, Consumers, Pacer
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Flag, Names, Number, Text
from trawl_ros.nodes.runtime.qos import STREAM
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.runtime.transforms import sends_transforms
from trawl_ros.nodes.towing import (
    DEFAULT_START,
    CommandedTow,
    TowSetup,
    commanded_tow,
    fallen_sides,
)
from trawl_ros.records.topics import CLOCK, MAP, TRUTH
from trawl_ros.records.towing_limits import LIMITS
from trawl_ros.records.truth import Truth
from trawl_ros.scenario.records import MAX_TRUTH_HZ
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import Scenario, load_scenario


def wanted_lengths(message: Any) -> tuple[float | None, float | None]:
    """Return the warp lengths (m) of a command, None for a winch it does not name.

    Raises
    ------
    MessageError
        If it cannot be read, or asks for what cannot be.
    """
    wanted = read_winch_command(message)
    if objection := LIMITS.objection(wanted):
        raise MessageError(f'{WINCH_COMMAND}: {objection}')
    return wanted


def wanted_motion(message: Any) -> tuple[float, float]:
    """Return the speed (m/s) and rate of turn (rad/s, to port) of a command.

    Raises
    ------
    MessageError
        If it cannot be read, or asks for what cannot be.
    """
    speed, turn = read_vessel_command(message)
    if objection := LIMITS.objection((), speed, turn):
        raise MessageError(f'{VESSEL_COMMAND}: {objection}')
    return speed, turn


UNLIMITED = (math.inf, math.inf)
"""Speeds of winches that run as fast as they can."""

GEAR_MARKERS = 'truth/gear'
WHEN_SILENT = {VESSEL_COMMAND: 'the ship steers straight on', WINCH_COMMAND: 'the winches stop'}
BURST_S = 0.02
"""Wall time for which other callbacks may have to wait."""

SHORTEST_TICK_S = 0.002
LONGEST_TICK_S = 0.02
PATIENCE_S = 10.0
"""Time without progress that consumers have after the end of a scenario."""


class SimNode(TrawlNode):
    """Node that tows a gear from an equilibrium on, by a scenario or by commands.

    Truth and instruments are stamped with simulated time from 0 on when ``/clock`` is
    published, else with the time of the node's clock. ``pause``, ``resume``, ``step`` (to the
    next truth, while paused) and ``reset`` are services.
    """

    SPECS: ClassVar = (
        Text('gear', 'kaifuha', 'Gear file, or the name of one that comes with the package.'),
        Text('scenario', '', 'Scenario file or name: its gear, start, commands and end are used.'),
        Text('winches', 'scenario', 'Who moves the winches in a scenario: its steps, or '
             'command/winch.', choices=('scenario', 'command')),
        Flag('exit_at_end', False, 'Whether to end with the scenario.'),
        Number('warp_length_m', DEFAULT_START[0], 'm', *LIMITS.warp_m,
               'Length of both warps at the start.'),
        Number('speed_m_s', DEFAULT_START[1], 'm/s', *LIMITS.speed_m_s,
               'Speed through the water at the start.'),
        Number('heading_deg', 0.0, 'deg', -360.0, 360.0, 'First heading as ENU yaw.'),
        Number(
            'time_scale', 1.0, 'factor', 0.0, 1000.0, 'Simulated seconds per second of wall time; '
            '0 is as fast as the consumers follow. Other than 1 it forces publish_clock.',
            live=True,
        ),
        Flag('publish_clock', False, 'Whether to publish simulated time on /clock.'),
        Number('truth_rate_hz', MAX_TRUTH_HZ, 'Hz', 0.1, MAX_TRUTH_HZ, 'Rate of the truth: 10 '
               'divided by a whole number; a scenario brings its own.'),
        Number('gear_rate_hz', 1.0, 'Hz', 0.0, 1.0, 'Rate of the markers on truth/gear.',
               live=True),
        Number('odometry_std', 0.0, 'm, rad, m/s, rad/s', 0.0, 10.0, 'Standard deviation that '
               'odometry of the truth states, for estimators that take 0 as unknown.', live=True),
        Names('wait_for', 'Consumers (node names) without which the tow does not start.'),
        Number('lead_s', 3.0, 's', 1.0, 8.0, 'Simulated time that the slowest consumer may lag '
               'behind.', live=True),
        Number('command_timeout_s', 0.0, 's', 0.0, 3600.0, 'Simulated time without a '
               'command/vessel after which the ship steers straight on, and without a '
               'command/winch after which the winches stop; 0 is never.', live=True),
        MAX_AGE,
        Text('winch_velocity', 'ignored', 'What a velocity next to the position of a command/winch '
             'does: nothing; honoured it is the greatest speed of that winch; refused the command '
             'is left out.', choices=('ignored', 'honoured', 'refused'), live=True),
    )  # fmt: skip

    _clock_published = False
    _latest = 0

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('sim_node', **kwargs)
        self._scenario = self._load_scenario()
        self._clock_published = (
            self.parameters['publish_clock'] or self.parameters['time_scale'] != 1.0
        )
        if self._clock_published:
            self.advertise(CLOCK.name)
        for topic in TRUTH:
            self.advertise(topic.name)
        self._transforms = sends_transforms(self)
        self._consumers = Consumers(self, self.parameters['wait_for'])
        self._pacer = Pacer(self.parameters['time_scale'])
        self._tow, self._period = self._prepare()
        self._problem: str | None = None
        self._paused = False
        self._begin()
        self.listen(WINCH_COMMAND, self._command_winches, STREAM)
        self.listen(VESSEL_COMMAND, self._command_vessel, STREAM)
        for service in (self._reset, self._pause, self._resume, self._step):
            self.offer(service.__name__.strip('_'), service)
        self._ticker = self.every(self._tick_s(), self._tick)

    def now(self) -> int:
        """Return the time that this node publishes on /clock, or that of its own clock, ns."""
        return self._latest if self._clock_published else super().now()

    def objection(self, name: str, value: Any) -> str | None:
        """Return an objection to a live parameter's value; None without one."""
        if name == 'time_scale' and value != 1.0 and not self._clock_published:
            return (
                f'time_scale: found {value:g}, expected 1, since /clock is not published; set '
                'publish_clock at the start'
            )
        return None

    def parameter_changed(self, name: str) -> None:
        """Apply a live parameter's new value."""
        if name == 'time_scale':
            self._pacer.change(self.parameters['time_scale'])
            self._ticker.timer_period_ns = round(self._tick_s() * SECOND)

    def statuses(self) -> list[Status]:
        """Return the status of the tow."""
        command = self._tow.simulation.command
        missing = self._consumers.missing()
        values = {
            'simulated time': f'{self._tow.time_s:.1f}',
            'seconds lost': f'{self._pacer.lost_s:.1f}',
            'wanted port warp': f'{command.port_length:g}',
            'wanted starboard warp': f'{command.starboard_length:g}',
            'wanted speed': f'{command.speed:g}',
            'wanted rate of turn': f'{command.turn_rate:g}',
            'waits for': ', '.join([*missing, *self._consumers.waited_for()]),
            'fallen boards': fallen_sides(self._tow.simulation),
        }
        if self._scenario is not None:
            values['step'] = self._scenario.step_at(self._tow.time_s).name
        return [Status('tow', *self._state(missing), values)]

    def _state(self, missing: Sequence[str]) -> tuple[int, str]:
        if self._problem:
            return ERROR, self._problem
        if self._ended is not None:
            return OK, 'the scenario is at its end'
        if missing and self._started:
            return WARN, f'goes on without {", ".join(missing)}, silent for {SILENT_S:g} s'
        if missing:
            names = ', '.join(missing)
            reason = f'waits for {names}, which should report on sync/progress'
            return WARN, self.with_namespace(reason)
        if stalled := self._consumers.stalled():
            names = ', '.join(stalled)
            return WARN, f'goes on without {names}, not getting on for {STALLED_S:g} s'
        if slow := self._consumers.waited_for():
            return WARN, f'waits for {", ".join(slow)}, which gets on too slowly'
        if fallen := fallen_sides(self._tow.simulation):
            return WARN, f'board fallen: {fallen}; towed on, expected more speed or less warp'
        if lapsed := [topic for topic, watch in self._watches.items() if watch.lapsed]:
            timeout = self.parameters['command_timeout_s']
            done = ' and '.join(WHEN_SILENT[topic] for topic in lapsed)
            return WARN, f'{" and ".join(lapsed)} silent for {timeout:g} s: {done}'
        if self._paused:
            return OK, 'paused'
        if self._pacer.lost_s > 0.0:
            return WARN, 'slower than the time scale asks for; expected a smaller one'
        return OK, 'towing' if self._started else 'waits until discovery has finished'

    def _tick_s(self) -> float:
        scale = self.parameters['time_scale']
        wanted = SHORTEST_TICK_S if scale == 0.0 else 0.25 / MAX_TRUTH_HZ / scale
        return float(min(max(wanted, SHORTEST_TICK_S), LONGEST_TICK_S))

    def _load_scenario(self) -> Scenario | None:
        name = self.parameters['scenario']
        return load_scenario(name) if name else None

    def _prepare(self) -> tuple[TowSetup, int]:
        """Prepare the tow, and the time (ns) from one truth to the next."""
        if self._scenario is not None:
            return Trial(self._scenario), round(SECOND / self._scenario.record.truth_rate_hz)
        rate = self.parameters['truth_rate_hz']
        tow = commanded_tow(
            load_gear(self.parameters['gear']),
            (self.parameters['warp_length_m'], self.parameters['speed_m_s']),
            heading=math.radians(self.parameters['heading_deg']),
            truth_rate_hz=rate,
            warn=self.get_logger().warning,
        )
        return tow, round(SECOND / rate)

    def _begin(self) -> None:
        self._watches = {topic: CommandWatch(topic) for topic in (VESSEL_COMMAND, WINCH_COMMAND)}
        self._offset: int | None = None
        self._latest = 0
        self._next_s = 0.0
        self._next_gear_s = 0.0
        self._started = False
        self._ended: float | None = None
        self._pacer.restart()

    def _tick(self) -> None:
        if self._ended is not None:
            self._end_if_done()
            return
        if self._problem or not self._start() or self._paused:
            return
        end = monotonic() + BURST_S
        while self._ended is None and not self._problem and self._may_go_on():
            self._go_on()
            if monotonic() > end:
                break

    def _start(self) -> bool:
        alone = not self.parameters['wait_for'] and self.parameters['time_scale'] != 0.0
        if not self._started and (alone or self._consumers.ready()):
            self._started = True
            self._offset = 0 if self._clock_published else self.now()
            self._latest = self._offset
            self._consumers.begin(self._offset)
        return self._started

    def _may_go_on(self) -> bool:
        # Asked in this order: time that consumers take is not lost by the simulation.
        if not self._followed():
            self._pacer.restart()
            return False
        return self._pacer.due(self._next_s)

    def _followed(self) -> bool:
        """True if consumers are near enough for one truth more."""
        lead = round(self.parameters['lead_s'] * SECOND)
        return self._consumers.followed(self._latest + self._period - lead)

    def _go_on(self) -> None:
        self._watch_commands()
        try:
            truth = self._tow.step()
        except TrawlError as reason:
            self._problem = str(reason)
            if self.parameters['exit_at_end']:
                self.end(1, self._problem)
            return
        if truth is None:
            self._ended = monotonic()
            return
        self._next_s = (truth.stamp + self._period) / SECOND
        self._publish(truth)

    def _publish(self, truth: Truth) -> None:
        stamp = truth.stamp + (self._offset or 0)
        if self._clock_published:
            self.send(*clock_message(stamp))
        stated = self.parameters['odometry_std']
        for topic, message in truth_messages(replace(truth, stamp=stamp), stated):
            self.send(topic, message)
        if self._transforms:
            ship, odom = self.frames['publish_tf'], bool(self.frames['odom_frame'])
            self.send(*transforms_message(replace(truth, stamp=stamp), ship=ship, odom=odom))
        self._publish_gear(truth.stamp / SECOND, stamp)
        self._latest = stamp
        self._consumers.sent(stamp)

    def _publish_gear(self, time_s: float, stamp: int) -> None:
        rate = self.parameters['gear_rate_hz']
        if rate == 0.0 or time_s < self._next_gear_s - 1e-9:
            return
        self._next_gear_s = time_s + 1.0 / rate
        # Without subscribers no picture is drawn.
        if self.advertise(GEAR_MARKERS).get_subscription_count():
            picture = replace(self._tow.simulation.picture(), stamp=stamp)
            self.send(*gear_markers(picture, self.frame_names.get(MAP, MAP)))

    def _end_if_done(self) -> None:
        if not self.parameters['exit_at_end'] or self.exit_code is not None:
            return
        slowest = self._consumers.slowest()
        done = slowest is None or slowest >= self._latest
        absent = [*self._consumers.missing(), *self._consumers.stalled()]
        if done and absent:
            self.end(1, f'the scenario has come to its end without {", ".join(absent)}')
        elif done and self.all_acknowledged(1.0):
            self.end(0, f'the scenario has come to its end at {self._tow.time_s:.1f} s')
        elif monotonic() - (self._ended or 0.0) > PATIENCE_S and not done:
            self.end(1, 'consumers did not follow to the end of the scenario')

    def _command_winches(self, message: Any) -> None:
        wanted = wanted_lengths(message)
        speeds = self._wanted_speeds(message)
        if isinstance(self._tow, Trial) and self.parameters['winches'] == 'command':
            self._watch(WINCH_COMMAND, message)
            self._tow.command_winches(*wanted)
        else:
            self._commanded(WINCH_COMMAND, message).command_winches(*wanted, speeds)

    def _wanted_speeds(self, message: Any) -> tuple[float, float]:
        """Return the greatest speeds of the winches (m/s) by the parameter for velocities."""
        speeds, role = read_winch_speeds(message), self.parameters['winch_velocity']
        if role == 'honoured' or speeds == UNLIMITED:
            return speeds
        if role == 'refused':
            raise MessageError(
                f'{WINCH_COMMAND}: velocity {list(message.velocity)} next to a position; expected '
                "none, or the parameter winch_velocity to be 'honoured'"
            )
        self.say(
            f'velocity of {WINCH_COMMAND}', WARN, 'not used: winches pay out at their own speed'
        )
        return UNLIMITED

    def _command_vessel(self, message: Any) -> None:
        wanted = wanted_motion(message)
        self._commanded(VESSEL_COMMAND, message).command_vessel(*wanted)

    def _commanded(self, topic: str, message: Any) -> CommandedTow:
        tow = self._tow
        if not isinstance(tow, CommandedTow):
            raise MessageError(
                f'{topic}: the scenario is in command; expected no command on this topic'
            )
        self._watch(topic, message)
        return tow

    def _watch(self, topic: str, message: Any) -> None:
        most = self.parameters['max_command_age_s']
        self._watches[topic].take(stamp_of(message), self.now(), self._tow.time_s, most)

    def _watch_commands(self) -> None:
        tow, timeout = self._tow, self.parameters['command_timeout_s']
        turning = self._watches[VESSEL_COMMAND].lapses(tow.time_s, timeout)
        if turning and isinstance(tow, CommandedTow):
            tow.stop_turning()
        if self._watches[WINCH_COMMAND].lapses(tow.time_s, timeout):
            tow.command_winches(*tow.simulation.stop_lengths())

    def _reset(self) -> str:
        self._tow.reset()
        self._problem = None
        self._begin()
        return 'the tow is at its start again'

    def _pause(self) -> str:
        self._paused = True
        return f'the tow is paused at {self._tow.time_s:.1f} s'

    def _resume(self) -> str:
        self._paused = False
        self._take_up_time()
        return f'the tow goes on from {self._tow.time_s:.1f} s'

    def _step(self) -> str:
        if not self._paused:
            raise TrawlError('the tow is not paused; expected a call of pause before')
        if not self._started:
            raise TrawlError(f'the tow has not begun: {self._state(self._consumers.missing())[1]}')
        if self._ended is not None or self._problem:
            raise TrawlError(f'no further step: {self._state([])[1]}')
        if not self._followed():
            raise TrawlError('consumers are still busy with the steps before; call again')
        self._take_up_time()
        self._go_on()
        if self._problem:
            raise TrawlError(self._problem)
        return f'the tow is paused at {self._tow.time_s:.1f} s'

    def _take_up_time(self) -> None:
        """Take stamps that are not simulated time as the present again, after a pause."""
        self._pacer.restart()
        if self._offset is not None and not self._clock_published:
            self._offset = self.now() - round(self._next_s * SECOND)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(SimNode, args)
