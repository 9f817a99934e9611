# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`nmea_out`: speaks as a chosen ship's instruments do, over serial lines, UDP and TCP."""

from collections.abc import Sequence
from typing import Any, ClassVar

from trawl_ros.core.errors import SentenceError
from trawl_ros.core.time import SECOND
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.nodes.links.channels import parse_link
from trawl_ros.nodes.links.threads import SentenceSink
from trawl_ros.nodes.runtime.credit import ConsumerProgress
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Flag, Names, Number
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.fields import WaterColumn
from trawl_ros.sentences.framing import HEADER, tag_block
from trawl_ros.sentences.plotter import TOPICS, PlotterWriter
from trawl_ros.sentences.table import load_table, load_tables
from trawl_ros.sentences.writer import SentenceWriter

CLOCK = 'ship'
LINE_END = b'\r\n'


class NmeaOut(TrawlNode):
    """Node that sends what the instruments publish as sentences of ships' systems."""

    SPECS: ClassVar = (
        Names('links', 'Where sentences go: udp://HOST:PORT (?broadcast, ?interface=ADDRESS for '
              'multicast), tcp://HOST:PORT, tcp-listen://HOST:PORT, serial:/dev/PORT?baud=4800, '
              'pty:PATH. Without a host, this machine alone.', ('udp://:10110',)),
        Names('systems', 'Who speaks: systems of config/sentences/, or YAML files like them.',
              ('marport', 'scantrol', 'ship')),
        Number('clock_interval_s', 1.0, 's', 0.0, 60.0, 'Data time between two sentences with date '
               'and time; 0 sends one in front of each instant.'),
        Flag('every_reading', False, 'Send each reading, also where the system sends them more '
             'seldom.'),
        Flag('tag_blocks', False, 'Put the time in front of each sentence, as a tag block of NMEA '
             '0183 version 4.'),
        Flag('iec_61162_450', False, 'Put UdPbC in front of each datagram, as IEC 61162-450 has '
             'it.'),
        Flag('plotter', False, 'Send the positions of doors and net to a chart plotter (TTM, TPR, '
             'TPT), with each reading of the winches.'),
        Number('net_behind_m', 100.0, 'm', 0.0, 2000.0, 'Length of bridles and sweeps between '
               'doors and headrope, for these positions.'),
        Number('water_density_kg_m3', 1025.0, 'kg/m3', 900.1, 1099.9, 'By which pressures become '
               'depths.'),
    )  # fmt: skip

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('nmea_out', **kwargs)
        water = WaterColumn(density_kg_m3=self.parameters['water_density_kg_m3'])
        tables = load_tables(self.parameters['systems'])
        every_reading = self.parameters['every_reading']
        self._writer = SentenceWriter(tables, water, every_reading=every_reading)
        self._plotter: PlotterWriter | None = None
        if self.parameters['plotter']:
            self._plotter = PlotterWriter(water, self.parameters['net_behind_m'])
        self._ship_clock = SentenceWriter([load_table(CLOCK)], water)
        self._next_clock: int | None = None
        self._interval = round(self.parameters['clock_interval_s'] * SECOND)
        topics = [topic for topic in self._writer.topics if not topic.startswith('command/')]
        if not topics:
            raise SentenceError('parameter systems: they tell no reading of an instrument')
        addresses = [parse_link(text) for text in self.parameters['links']]
        if not addresses:
            raise SentenceError('parameter links: found none, expected where sentences go')
        self._sinks = [SentenceSink(address) for address in addresses]
        self._progress = ConsumerProgress(self, idle=lambda: True)
        for topic in dict.fromkeys((*topics, *(TOPICS if self._plotter else ()))):
            self._listen_to(topic)

    def statuses(self) -> list[Status]:
        """Return the status of each link."""
        found = []
        for sink in self._sinks:
            values = {
                'sentences sent': str(sink.lines),
                'sentences given up': str(sink.lost),
                'opened': str(sink.opened),
            }
            problem = '; '.join(text for text in (sink.state, sink.turned_away) if text)
            level, message = (WARN, problem) if problem else (OK, 'sends')
            found.append(Status(f'link {sink.address.text}', level, message, values))
        return found

    def finish_work(self) -> None:
        """Close the links."""
        for sink in self._sinks:
            sink.close()

    def _listen_to(self, topic: str) -> None:
        def take(message: Any) -> None:
            sample = to_sample(topic, message)
            texts = self._writer.write(sample)
            if self._plotter is not None:
                texts += self._plotter.write(sample)
            if texts:
                texts = [*self._time(sample.stamp), *texts]
            for text in texts:
                self._send(text, sample.stamp)
            self._progress.done(sample.stamp)

        self.listen(topic, take, CONSUMER)

    def _time(self, stamp: int) -> list[str]:
        due = self._next_clock
        # A stamp far back is that of a tow that has begun again.
        since = None if due is None else stamp - due + self._interval
        if since == 0 or (since is not None and -self._interval < since < self._interval):
            return []
        self._next_clock = stamp + self._interval
        return self._ship_clock.write_clock(stamp)

    def _send(self, text: str, stamp: int) -> None:
        data = text.encode('ascii') + LINE_END
        if self.parameters['tag_blocks']:
            data = tag_block(stamp).encode('ascii') + data
        for sink in self._sinks:
            header = self.parameters['iec_61162_450'] and sink.address.kind == 'udp'
            sink.put(HEADER + data if header else data)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(NmeaOut, args)
