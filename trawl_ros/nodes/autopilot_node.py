# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`autopilot_node`: steers the ship by compass, GPS, speed log and fish sonar."""

import math
import time
from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.control.autopilot import (
    Autopilot,
    AutopilotSettings,
    HoldCourse,
    HoldHeading,
    Target,
    ToSchool,
)
from trawl_ros.core.errors import ScenarioError, TrawlError
from trawl_ros.core.geodesy import Datum
from trawl_ros.core.schema import load_yaml, validated
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.messages.commands import VESSEL_COMMAND, vessel_command
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.nodes.runtime.credit import ConsumerProgress
from trawl_ros.nodes.runtime.datum import datum_specs
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Number, ParameterError, Text
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.nodes.runtime.reading import possible_sample
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.samples import FixSample, HeadingSample, SchoolsSample, VelocitySample
from trawl_ros.records.towing_limits import LIMITS
from trawl_ros.scenario.driving import SteerRecord

HEADING = 'vessel/heading'
SENSORS = (
    'vessel/velocity_water',
    'vessel/velocity_ground',
    'vessel/fix',
    HEADING,
    'vessel/fish_sonar',
)
OFF = 'off'
BACK_NS = SECOND
"""Stamps that go back by more than this are those of a tow that has begun again."""

SELDOM_NS = 2 * SECOND
"""Without a compass, the other sensors keep time."""

SILENT_S = 5.0
DEFAULT = AutopilotSettings()


def load_track(path: str) -> SteerRecord:
    """Read a track from a YAML file, as ``steer`` in a scenario has it.

    Raises
    ------
    ScenarioError
        If the file cannot be read, or holds no track.
    """
    record = validated(SteerRecord, load_yaml(path, ScenarioError), path, ScenarioError)
    if record.track_m is None and record.track_deg is None:
        raise ScenarioError(f'{path}: no track, expected track_m or track_deg')
    return record


class AutopilotNode(TrawlNode):
    """Node that steers as `trawl_ros.control.autopilot` says.

    It answers each reading of the compass with a ``command/vessel``. When the compass is silent it
    asks for straight on, once all is silent too.
    """

    SPECS: ClassVar = (
        Text('mode', OFF, 'What is steered: a heading by compass, a course over ground, a track, '
             'toward the school that the fish sonar sees; off sends nothing.',
             choices=('heading', 'course', 'track', 'school', OFF), live=True),
        Number('heading_deg', 0.0, 'deg', -360.0, 360.0, 'Heading, as ENU yaw: 0 is east, to port '
               'positive.', live=True),
        Number('course_deg', 0.0, 'deg', -360.0, 360.0, 'Course over ground, as ENU yaw.',
               live=True),
        Text('track', '', 'YAML file with waypoints, track_m in east and north of map or track_deg '
             'in latitude and longitude.', live=True),
        Number('speed_m_s', 0.0, 'm/s', 0.0, LIMITS.speed_m_s[1],
               'Speed through the water to be held; 0 is what '
               'the log shows at the start.', live=True),
        Number('max_turn_deg_s', math.degrees(DEFAULT.max_turn), 'deg/s', 0.01, 3.0, 'Fastest rate '
               'of turn; the gear must be able to follow.', live=True),
        Number('turn_acceleration_deg_s2', math.degrees(DEFAULT.turn_acceleration), 'deg/s2', 0.001,
               1.0, 'How fast the ship takes up a turn.', live=True),
        Number('look_ahead_m', DEFAULT.look_ahead, 'm', 20.0, 5000.0, 'How far ahead on a track is '
               'aimed; more is calmer.', live=True),
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('autopilot_node', **kwargs)
        datum = self.declare_specs(datum_specs(load_instruments('default').vessel))
        if reason := self.objection('mode', self.parameters['mode']):
            raise ParameterError(f'{self.get_fully_qualified_name()}: parameter {reason}')
        self._datum = Datum(datum['datum_lat'], datum['datum_lon'])
        self._begin()
        self.advertise(VESSEL_COMMAND)
        self._progress = ConsumerProgress(self, idle=lambda: True)
        for topic in SENSORS:
            self._listen_to(topic)
        self.every(1.0, self._watch)

    def objection(self, name: str, value: Any) -> str | None:
        """Return an objection to a live parameter's value; None without one."""
        if name == 'mode' and value == 'track' and not self.parameters['track']:
            return "mode: found 'track', expected the parameter track to be set before"
        if name == 'track':
            if not value and self.parameters['mode'] == 'track':
                return "track: found none, expected a file while mode is 'track'"
            try:
                if value:
                    load_track(value)
            except TrawlError as reason:
                return f'track: found {value!r}, which is no track: {reason}'
        return None

    def parameter_changed(self, name: str) -> None:
        """Apply a live parameter's new value."""
        self._pilot.settings = self._settings()
        if name in ('mode', 'track', f'{self.parameters["mode"]}_deg'):
            self._steer()
        if self.parameters['mode'] == OFF:
            self._go_straight()

    def finish_work(self) -> None:
        """Stop the ship's turn."""
        self._go_straight()

    def statuses(self) -> list[Status]:
        """Return the status of the steering."""
        state, mode = self._pilot.state, self.parameters['mode']
        if mode == OFF:
            return [Status('autopilot', OK, 'off', {'mode': mode})]
        values = {
            'mode': mode,
            'wanted heading': _degrees(state.wanted),
            'wanted course': _degrees(state.course),
            'heading error': _degrees(math.remainder(state.wanted - self._heading, 2 * math.pi)),
            'rate of turn': f'{math.degrees(state.turn_rate):.3f}',
            'speed': f'{self._speed:.2f}',
            'leg': str(state.leg) if state.leg >= 0 else '',
            'cross-track error': _metres(state.across),
            'left of the leg': _metres(state.left),
            'ended': str(state.ended).lower(),
        }
        problems = list(state.problems)
        silent = time.monotonic() - self._heard_at
        if silent > SILENT_S:
            problems.append(f'sensors silent for {silent:.0f} s: goes straight on')
        elif math.isnan(self._speed):
            problems.append('waits for a speed from the log, or the parameter speed_m_s')
        if problems:
            return [Status('autopilot', WARN, '; '.join(problems), values)]
        return [Status('autopilot', OK, 'at the end' if state.ended else 'steers', values)]

    def _begin(self) -> None:
        self._pilot = Autopilot(self._settings(), self._datum)
        self._latest: dict[str, int] = {}
        self._steered_at = 0
        self._heard_at = time.monotonic()
        self._heading = math.nan
        self._log = math.nan
        self._turning = False
        self._steer()

    def _settings(self) -> AutopilotSettings:
        return AutopilotSettings(
            max_turn=math.radians(self.parameters['max_turn_deg_s']),
            turn_acceleration=math.radians(self.parameters['turn_acceleration_deg_s2']),
            look_ahead=self.parameters['look_ahead_m'],
        )

    @property
    def _speed(self) -> float:
        return float(self.parameters['speed_m_s'] or self._log)

    def _steer(self) -> None:
        if (target := self._target()) is not None:
            self._pilot.steer(target)

    def _target(self) -> Target | None:
        mode = self.parameters['mode']
        if mode == 'heading':
            return HoldHeading(math.radians(self.parameters['heading_deg']))
        if mode == 'course':
            return HoldCourse(math.radians(self.parameters['course_deg']))
        if mode == 'track':
            return load_track(self.parameters['track']).target(self._datum)
        return ToSchool() if mode == 'school' else None

    def _listen_to(self, topic: str) -> None:
        def take(message: Any) -> None:
            sample = possible_sample(topic, message)
            if isinstance(sample, HeadingSample | FixSample | VelocitySample | SchoolsSample):
                self._take(topic, sample)

        self.listen(topic, take, CONSUMER, settled=True)

    def _take(
        self, topic: str, sample: HeadingSample | FixSample | VelocitySample | SchoolsSample
    ) -> None:
        stamp = sample.stamp
        if stamp < self._latest.get(topic, stamp) - BACK_NS:
            self._begin()
        self._latest[topic] = stamp
        self._heard_at = time.monotonic()
        if isinstance(sample, HeadingSample):
            self._heading = sample.heading
        if isinstance(sample, VelocitySample) and sample.over == 'water' and math.isnan(self._log):
            self._log = float(sample.velocity[0])
        self._pilot.take(sample)
        if topic == HEADING or stamp - self._steered_at > SELDOM_NS:
            self._command(stamp)
        if topic == HEADING:
            self._progress.done(stamp)

    def _command(self, stamp: int) -> None:
        self._steered_at = stamp
        if self.parameters['mode'] == OFF or math.isnan(self._speed):
            return
        rate = self._pilot.turn_rate(stamp)
        self._turning = rate != 0.0
        self.send(*vessel_command(stamp, self._speed, rate))

    def _watch(self) -> None:
        """Stop the turn of a ship whose sensors are silent."""
        if time.monotonic() - self._heard_at > SILENT_S:
            self._go_straight()

    def _go_straight(self) -> None:
        if self._turning:
            self._turning = False
            self.send(*vessel_command(self._steered_at, self._speed, 0.0))


def _degrees(angle: float) -> str:
    return '' if math.isnan(angle) else f'{math.degrees(angle):.2f}'


def _metres(distance: float) -> str:
    return '' if math.isnan(distance) else f'{distance:.1f}'


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(AutopilotNode, args)
