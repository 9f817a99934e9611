# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`nmea_in`: publishes what instruments say over serial lines, UDP and TCP."""

import math
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

from trawl_ros.control.set_points import SetPointGuard, SetPointLimits
from trawl_ros.core.errors import MessageError, SentenceError
from trawl_ros.core.geodesy import Datum
from trawl_ros.core.stamps import impossible_time
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.messages.commands import (
    VESSEL_COMMAND,
    WINCH_COMMAND,
    vessel_command,
    winch_command,
)
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.nodes.command_watch import MAX_AGE, CommandWatch
from trawl_ros.nodes.links.channels import parse_link
from trawl_ros.nodes.links.threads import LineSource
from trawl_ros.nodes.runtime.datum import datum_specs
from trawl_ros.nodes.runtime.incoming import error_of_program
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Flag, Names, Number, Text
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.nodes.runtime.reading import possible_sample
from trawl_ros.nodes.runtime.run import run
from trawl_ros.nodes.runtime.transforms import ShipPose, send_mounts, sends_transforms
from trawl_ros.records.fields import FIELDS, WaterColumn
from trawl_ros.records.frames import DOOR_MOUNTS, echo_sounder_mount
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import Sample, WinchSample
from trawl_ros.records.towing_limits import LIMITS
from trawl_ros.sentences.assembly import SampleAssembly
from trawl_ros.sentences.codec import SentenceReader, Spoken
from trawl_ros.sentences.framing import Foreign, Frame, Unreadable, parse_line
from trawl_ros.sentences.links import LinkClock, Source, SourceArbiter, Tally
from trawl_ros.sentences.table import COMMANDS, load_tables

DRAIN_S = 0.05
LINES_AT_ONCE = 500
"""Lines of a link that are dealt with between two looks at everything else."""

WAIT_NS = SECOND
"""Time (ns) after which a part of a sample is given without the rest."""

WINCH = 'winch/joint_states'
ARRIVAL, SENTENCES = 'arrival', 'sentences'
SYSTEMS = ('marport', 'simrad', 'scanmar', 'simrad_iti', 'scantrol', 'ship')


class NmeaIn(TrawlNode):
    """Node that listens to several links at once and publishes the instrument topics.

    With ``commands`` it hears set points too, held to limits; once these fall silent the winches
    are commanded to hold what the counters show.
    """

    SPECS: ClassVar = (
        Names('links', 'Where sentences come from: udp://HOST:PORT (a group is joined by the '
              'interface ?interface=ADDRESS), tcp://HOST:PORT, tcp-listen://HOST:PORT, '
              'serial:/dev/PORT?baud=4800, pty:PATH. Without a host, this machine alone; '
              '0.0.0.0 opens a port to all networks.', ('udp://:10110',)),
        Names('systems', 'Who is understood: systems of config/sentences/, or YAML files like '
              'them.', SYSTEMS),
        Text('time', ARRIVAL, 'Stamps of readings: arrival takes the time of arrival; sentences '
             'takes tag blocks, or the clock of the link, by its sentences with date and time.',
             choices=(ARRIVAL, SENTENCES)),
        Number('water_density_kg_m3', 1025.0, 'kg/m3', 900.1, 1099.9, 'By which depths become '
               'pressures.'),
        Number('draught_m', 0.0, 'm', 0.0, 30.0, 'Depth of the echo sounder below the towing '
               'blocks, for /tf_static; 0 is that of the default instruments.'),
        Flag('commands', False, 'Pass on set points of the systems (such as set_points) to '
             'command/winch and command/vessel.'),
        Number('command_timeout_s', 10.0, 's', 0.5, 600.0, 'Silence of set points after which the '
               'winches must hold.'),
        replace(MAX_AGE, sentence='Largest difference between the tag block of a set point and the '
                'time of this node; others are refused; 0 takes any, and any without tag block.'),
        Number('min_length_m', 50.0, 'm', 0.0, LIMITS.warp_m[1],
               'Least warp that a set point may want.'),
        Number('max_length_m', 2000.0, 'm', 0.0, LIMITS.warp_m[1],
               'Most warp that a set point may want.'),
        Number('max_step_m', 50.0, 'm', 0.1, 5000.0, 'Furthest that a set point may be from the '
               'counter.'),
        Number('max_speed_m_s', 4.0, 'm/s', 0.0, LIMITS.speed_m_s[1],
               'Fastest ship that a set point may want.'),
        Number('max_turn_rad_s', 0.02, 'rad/s', 0.0, 0.2, 'Fastest turn that a set point may '
               'want.'),
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('nmea_in', **kwargs)
        given = self.parameters
        water = WaterColumn(density_kg_m3=given['water_density_kg_m3'])
        tables = load_tables(given['systems'])
        self._reader = SentenceReader(tables)
        self._ranks = {key: rank for rank, key in enumerate(self._reader.rows)}
        self._assembly = SampleAssembly(tables, water)
        self._tellers = SourceArbiter()
        self._tally = Tally()
        self._guard = SetPointGuard(
            SetPointLimits(
                given['min_length_m'],
                given['max_length_m'],
                given['max_step_m'],
                given['max_speed_m_s'],
                given['max_turn_rad_s'],
                round(given['command_timeout_s'] * SECOND),
            )
        )
        self._held = 0
        vessel = load_instruments('default').vessel
        datum = self.declare_specs(datum_specs(vessel))
        self._pose: ShipPose | None = None
        if self.frames['publish_tf'] and sends_transforms(self):
            origin = Datum(datum['datum_lat'], datum['datum_lon'])
            self._pose = ShipPose(origin, odom=bool(self.frames['odom_frame']))
        send_mounts(
            self, [echo_sounder_mount(given['draught_m'] or vessel.draught_m), *DOOR_MOUNTS]
        )
        self._clocks: dict[str, LinkClock] = {}
        self._tag_clocks: dict[str, LinkClock] = {}
        topics = {topic for row in self._reader.rows.values() for topic in row.topics}
        for topic in sorted(topics & FIELDS.keys()):
            self.advertise(topic)
        if given['commands']:
            if not topics & COMMANDS.keys():
                raise SentenceError(
                    'parameter commands: true, but no system commands; expected one such as '
                    'set_points among systems'
                )
            for topic in COMMANDS:
                self.advertise(topic)
            self.listen(WINCH, self._see_winches, CONSUMER)
        addresses = [parse_link(text) for text in given['links']]
        if not addresses:
            raise SentenceError('parameter links: found none, expected where sentences come from')
        self._line_sources = [LineSource(address) for address in addresses]
        self.every(DRAIN_S, self._drain)

    def statuses(self) -> list[Status]:
        """Return the status of each link, and of what was understood."""
        found = [self._link_status(source) for source in self._line_sources]
        tally = self._tally
        values = {
            'understood': str(tally.understood),
            'in no table': str(tally.foreign),
            'not understood': str(tally.refused),
        }
        values |= {f'not understood: {why}': str(n) for why, n in tally.reasons.most_common(20)}
        message = 'every line was understood'
        if tally.last is not None:
            line, reason = tally.last
            values['last line not understood'] = line
            message = f'{tally.refused} lines not understood, the last: {reason}'
        found.append(Status('sentences', WARN if tally.refused else OK, message, values))
        if self.parameters['commands']:
            state = 'set points are passed on' if self._guard.active else 'no set points'
            held = {'held after silence': str(self._held)}
            found.append(Status('set points', WARN if self._held else OK, state, held))
        return found

    def finish_work(self) -> None:
        """Close the links, and deal with what has come."""
        for source in self._line_sources:
            source.close()
        self._drain()
        self._publish(self._assembly.flush())

    def _link_status(self, source: LineSource) -> Status:
        values = {
            'lines': str(source.lines),
            'lines given up': str(source.lost),
            'lines too long': str(source.too_long),
            'opened': str(source.opened),
        }
        problems = [text for text in (source.state, source.turned_away) if text]
        if source.lost:
            problems.append(f'{source.lost} lines came faster than they can be read')
        message = '; '.join(problems) or 'open'
        return Status(f'link {source.address.text}', WARN if problems else OK, message, values)

    def _drain(self) -> None:
        for source in self._line_sources:
            for line, sender in source.take(LINES_AT_ONCE):
                try:
                    self._hear(line, source.address.text, sender)
                except Foreign:
                    self._tally.foreign += 1
                except Unreadable as reason:
                    self._tally.refuse(str(reason), line)
                except Exception as reason:
                    # It costs its line, and not those that came with it.
                    self._tally.refuse(error_of_program(reason), line)
        if self.parameters['time'] == ARRIVAL:
            self._publish(self._assembly.flush(self.now() - WAIT_NS))
        if (held := self._guard.silence(time.monotonic_ns())) is not None:
            self._held += 1
            if not all(map(math.isnan, held)):
                self.send(*winch_command(self.now(), *held))

    def _hear(self, line: bytes, link: str, sender: str) -> None:
        frame = parse_line(line)
        spoken = self._reader.read(frame)
        row = self._reader.rows[spoken.system, spoken.name]
        if row.is_clock:
            if spoken.time is not None and (said := spoken.time.stamp(None)) is not None:
                # The newest stands last, for links that have no clock of their own.
                self._believe(said, link, self._clocks)
                self._clocks[link] = self._clocks.pop(link)
            self._tally.understood += 1
            return
        if not row.topics:
            self._tally.understood += 1
            return
        via = f'{link} from {sender}' if sender else link
        rank = self._ranks[spoken.system, spoken.name]
        source = Source(via, spoken.system, spoken.talker, row.form, rank)
        spoken, rival = self._tellers.believed(spoken, source, time.monotonic_ns())
        if rival and not spoken.readings:
            raise Unreadable(
                f'a reading of {row.topics[0]} by {via}, which another source gives: {rival}'
            )
        if any(topic in COMMANDS for topic in row.topics):
            self._command(spoken, frame.tag_time)
        elif spoken.readings:
            stamp = self._stamp(frame, spoken, link)
            self._publish(self._assembly.take(spoken, stamp, link))
        self._tally.understood += 1

    def _stamp(self, frame: Frame, spoken: Spoken, link: str) -> int:
        if self.parameters['time'] == ARRIVAL:
            return self.now()
        if frame.tag_time is not None:
            self._believe(frame.tag_time, link, self._tag_clocks)
            return frame.tag_time
        clock = self._clocks.get(link) or next(reversed(self._clocks.values()), None)
        if clock and (stamp := clock.stamp(time.monotonic_ns())) is not None:
            return stamp
        own = spoken.time.stamp(None) if spoken.time else None
        if own is None:
            raise Unreadable('a reading before the first time with a date')
        self._believe(own, f'{link} {spoken.system}', self._tag_clocks)
        return own

    @staticmethod
    def _believe(stamp: int, source: str, clocks: dict[str, LinkClock]) -> None:
        """Take the time (ns) that a source says, unless it cannot be, or leaps for a moment."""
        if why := impossible_time(stamp):
            raise Unreadable(f'a time that cannot be: {why}')
        if not clocks.setdefault(source, LinkClock()).hear(stamp, time.monotonic_ns()):
            raise Unreadable('a time that leaps, and only for a moment')

    def _publish(self, samples: Sequence[Sample]) -> None:
        for sample in samples:
            if why := impossible(sample):
                self._tally.refuse(f'a reading that cannot be: {why}', b'')
                continue
            self.send(*sample_message(sample))
            if self._pose and (transform := self._pose.take(sample)):
                self.send(*transform)

    def _command(self, spoken: Spoken, tag_time: int | None) -> None:
        if not self.parameters['commands']:
            raise Unreadable('a set point, while parameter commands is false')
        try:
            most_s = self.parameters['max_command_age_s']
            CommandWatch('a set point').take(tag_time or 0, self.now(), 0.0, most_s)
        except MessageError as reason:
            raise Unreadable(str(reason)) from None
        told = {topic for topic, _ in spoken.readings}
        try:
            if VESSEL_COMMAND in told:
                # A sentence that lacks one of them is refused.
                speed, turn = _said(spoken, VESSEL_COMMAND)
                self.send(*vessel_command(self.now(), *self._guard.ship(speed, turn)))
            if WINCH_COMMAND in told:
                port, starboard = _said(spoken, WINCH_COMMAND)
                lengths = self._guard.warps((port, starboard), time.monotonic_ns())
                self.send(*winch_command(self.now(), *lengths))
        except ValueError as reason:
            raise Unreadable(f'a set point that is refused: {reason}') from None

    def _see_winches(self, message: Any) -> None:
        sample = possible_sample(WINCH, message)
        if not isinstance(sample, WinchSample):
            raise MessageError(f'{WINCH}: expected counters and load cells')
        self._guard.see(sample.lengths)


def _said(spoken: Spoken, topic: str) -> list[float]:
    """Values of all fields of a command, NaN for those that a sentence leaves out."""
    return [spoken.readings.get((topic, name), math.nan) for name in COMMANDS[topic]]


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(NmeaIn, args)
