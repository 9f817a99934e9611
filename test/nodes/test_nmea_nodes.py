"""Readings go out as sentences and come back as topics; noise and set points are dealt with."""

import math
import socket
import time

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

import numpy as np  # noqa: E402
from pynmeagps.nmeahelpers import calc_checksum  # noqa: E402

from trawl_ros.core.errors import SentenceError  # noqa: E402
from trawl_ros.core.network import THIS_MACHINE  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.commands import read_vessel_command, read_winch_command  # noqa: E402
from trawl_ros.messages.diagnostics import WARN, read_statuses  # noqa: E402
from trawl_ros.messages.from_messages import to_sample  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.nmea_in import NmeaIn  # noqa: E402
from trawl_ros.nodes.nmea_out import NmeaOut  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.records.samples import (  # noqa: E402
    AttitudeSample,
    PressureSample,
    RangeSample,
    WinchSample,
)
from trawl_ros.sentences import links  # noqa: E402
from trawl_ros.sentences.framing import NO_TEXT, framed  # noqa: E402
from trawl_ros.sentences.table import COMMANDS, load_table  # noqa: E402

pytestmark = pytest.mark.ros

TOPICS = (
    'winch/joint_states',
    'door/port/pressure',
    'door/port/attitude',
    'door/spread',
)


class Ship(TrawlNode):
    """Instruments of a ship in one namespace, and a listener to those of another."""

    def __init__(self, **kwargs):
        super().__init__('ship', **kwargs)
        self.samples, self.reports, self.commands = {}, {}, []
        for topic in TOPICS:
            self.advertise(topic)
            self.listen(
                f'/heard/{topic}', self._keeper(topic), CONSUMER, self._type_of(topic, None)
            )
        self.listen('/diagnostics', self._hear, CONSUMER)
        for topic, read in (('winch', read_winch_command), ('vessel', read_vessel_command)):
            kind = self._type_of(f'command/{topic}', None)
            take = self._command_keeper(read)
            self.listen(f'/heard/command/{topic}', take, CONSUMER, kind)

    def _keeper(self, topic):
        def keep(message):
            sample = to_sample(topic, message)
            assert (topic, sample.stamp) not in self.samples
            self.samples[topic, sample.stamp] = sample

        return keep

    def _command_keeper(self, read):
        return lambda message: self.commands.append(read(message))

    def _hear(self, message):
        self.reports.update({status.name: status for status in read_statuses(message)})

    def report(self, name):
        return self.reports.get(f'/heard/nmea_in: {name}')


@pytest.fixture
def port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind((THIS_MACHINE, 0))
        return probe.getsockname()[1]


@pytest.fixture
def ship(graph):
    return graph.add(Ship)


def heard(graph, **parameters):
    """Add the listening node in a namespace of its own."""
    return graph.add(lambda **given: NmeaIn(namespace='heard', **given), **parameters)


def opened(graph, ship, *links):
    """Wait until links are open."""
    for text in links:
        graph.until(lambda text=text: (s := ship.report(f'link {text}')) and s.message == 'open')


def say(port, *bodies, host=THIS_MACHINE):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.bind((host, 0))
        for body in bodies:
            data = body if isinstance(body, bytes) else framed('$', body, checksum=True).encode()
            line.sendto(data, (THIS_MACHINE, port))


def readings(second):
    """Samples of all topics at a second; draws are those of the second."""
    draws = np.random.default_rng(second)
    stamp = second * SECOND + 250_000_000
    length, tension, angle, depth = draws.uniform([200, 1e5, -0.2, 1], [900, 2e5, 0.2, 5])
    return [
        WinchSample(stamp, (length, length + 1), (0.5, -0.5), (tension, tension + 500)),
        PressureSample(stamp, 'port', 1e5 * depth, 100.0),
        AttitudeSample(stamp, 'port', angle, -angle, 0.01),
        RangeSample(stamp, 'spread', 20 * depth, 0.1, 1.0, 400.0),
    ]


def test_what_instruments_say_comes_back_by_udp_and_a_pseudo_terminal(graph, ship, port, tmp_path):
    links = [f'udp://:{port}', f'pty:{tmp_path / "tty"}']
    graph.add(
        NmeaOut, links=links, systems=['marport', 'scantrol'], tag_blocks=True, every_reading=True
    )
    links[1] = f'serial:{tmp_path / "tty"}'
    heard(graph, links=links, systems=['marport', 'scantrol', 'ship'], time='sentences')
    graph.until(lambda: all(ship.count_subscribers(ship.full_name(topic)) for topic in TOPICS))
    opened(graph, ship, *links)
    sent = {}
    for second in range(1, 21):
        for sample in readings(second):
            topic, message = sample_message(sample)
            sent[topic, sample.stamp] = sample
            ship.send(topic, message)
        graph.rest(0.02)
    graph.until(lambda: ship.samples.keys() == sent.keys())
    for key, sample in sent.items():
        back = ship.samples[key]
        match sample:
            case WinchSample():
                assert back.lengths == pytest.approx(sample.lengths, abs=0.0501)
                assert back.speeds == pytest.approx(sample.speeds, abs=0.00501)
                assert back.tensions == pytest.approx(sample.tensions, abs=50.0)
            case PressureSample():
                assert back.pressure == pytest.approx(sample.pressure, abs=0.005 * 1025 * 9.81)
            case AttitudeSample():
                assert (back.pitch, back.roll) == pytest.approx(
                    (sample.pitch, sample.roll), abs=math.radians(0.0501)
                )
            case RangeSample():
                assert back.distance == pytest.approx(sample.distance, abs=0.00501)
    # Each reading came twice, and one of the two links is believed.
    graph.until(lambda: ship.report('sentences').level == WARN)
    twice = [key for key in ship.report('sentences').values if 'which another source gives' in key]
    assert twice


def test_a_chart_plotter_hears_where_the_doors_are(graph, ship):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as plotter:
        plotter.bind((THIS_MACHINE, 0))
        plotter.settimeout(10.0)
        link = f'udp://{THIS_MACHINE}:{plotter.getsockname()[1]}'
        graph.add(NmeaOut, links=[link], systems=['marport'], plotter=True)
        graph.until(lambda: all(ship.count_subscribers(ship.full_name(topic)) for topic in TOPICS))
        for sample in reversed(readings(1)):
            ship.send(*sample_message(sample))
            graph.rest(0.1)
        graph.until(lambda: b'TTM,01' in plotter.recv(2000))


def test_noise_is_counted_by_reason_and_what_is_whole_still_comes(graph, ship, port):
    heard(graph, links=[f'udp://:{port}'], systems=['marport', 'ship'])
    opened(graph, ship, f'udp://:{port}')
    say(
        port,
        b'\xff\x00\x01',
        b'$MPMSD,T,PD,23,XST,m,84',
        b'$MPMSD,T,PD,23,XST,m,84.50*00',
        'MPMSD,T,PD,23,XST,ft,264.10',
        'MPMSD,T,PD,23,XST,m,-99999.00',
        b'y' * 2000,
        'MPMSD,T,PD,23,XST,m,84.50',
    )
    graph.until(lambda: [s for (t, _), s in ship.samples.items() if t == 'door/spread'])
    graph.until(lambda: ship.report('sentences').values.get('not understood') == '5')
    told = ' '.join(ship.report('sentences').values)
    for reason in (NO_TEXT, '$MPMSD: no checksum', 'checksum is wrong', "field 5 is 'ft'"):
        assert reason in told
    assert ship.report(f'link udp://:{port}').values['lines too long'] == '1'
    (sample,) = ship.samples.values()
    assert sample.distance == pytest.approx(84.5)


def test_of_two_senders_with_one_name_the_first_is_believed_until_it_is_silent(
    graph, ship, port, monkeypatch
):
    monkeypatch.setattr(links, 'SILENT_NS', 2 * SECOND)
    heard(graph, links=[f'udp://:{port}'], systems=['marport'])
    opened(graph, ship, f'udp://:{port}')
    other = '127.0.0.2'
    for number in range(3):
        say(port, f'MPMSD,T,PD,23,XST,m,{84.1 + number}')
        say(port, f'MPMSD,T,PD,23,XST,m,{20.1 + number}', host=other)
        graph.until(lambda n=number: len(ship.samples) == n + 1)
    assert [sample.distance for sample in ship.samples.values()] == pytest.approx(
        [84.1, 85.1, 86.1]
    )
    graph.until(lambda: ship.report('sentences').values.get('not understood') == '3')
    (told,) = [key for key in ship.report('sentences').values if 'another source' in key]
    link = f'udp://:{port} from'
    assert f'door/spread by {link} {other}' in told
    assert f'another source gives: {link} {THIS_MACHINE} marport' in told

    def believed():
        say(port, 'MPMSD,T,PD,23,XST,m,25.1', host=other)
        graph.rest(0.2)
        return 25.1 in [round(sample.distance, 3) for sample in ship.samples.values()]

    graph.until(believed)


def test_each_link_goes_by_its_own_clock(graph, ship, port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind((THIS_MACHINE, 0))
        other = probe.getsockname()[1]
    links = [f'udp://:{port}', f'udp://:{other}']
    heard(graph, links=links, systems=['marport', 'scantrol', 'ship'], time='sentences')
    opened(graph, ship, *links)
    say(port, 'GPZDA,120000.00,01,08,2026,00,00')
    say(other, 'GPZDA,130000.00,01,08,2026,00,00', 'SCWTP,17.18,T')
    # The parts of a sample that another follows are given without the rest.
    for spread in (84.5, 84.6):
        say(port, f'MPMSD,T,PD,23,XST,m,{spread}')
        say(other, 'SCWTP,17.20,T')
    graph.until(lambda: len(ship.samples) == 4)
    noon = 1_785_585_600 * SECOND
    hours = {topic: (stamp - noon) // SECOND for topic, stamp in ship.samples}
    assert hours == {'door/spread': 0, 'winch/joint_states': 3600}


def test_a_time_that_cannot_be_costs_its_line_and_no_other(graph, ship, port):
    heard(graph, links=[f'udp://:{port}'], systems=['marport', 'ship'], time='sentences')
    opened(graph, ship, f'udp://:{port}')
    say(
        port,
        'GPZDA,120000.00,01,08,2026,00,00',
        b'\\c:9999999999*59\\' + framed('$', 'MPMSD,T,PD,23,XST,m,84.1', checksum=True).encode(),
        'GPZDA,120000.00,31,12,9999,00,00',
        'GPZDA,120000.00,31,12,2036,00,00',
        'GPZDA,120000.00,05,05,2005,00,00',
        # Two sentences in one datagram are two.
        framed('$', 'GPZDA,120001.00,01,08,2026,00,00', checksum=True).encode()
        + framed('$', 'MPMSD,T,PD,23,XST,m,84.5', checksum=True).encode(),
    )
    graph.until(lambda: ship.samples)
    ((topic, stamp),) = ship.samples
    assert (topic, stamp // SECOND) == ('door/spread', 1_785_585_601)
    graph.until(lambda: ship.report('sentences').values.get('not understood') == '4')


def test_set_points_drive_the_winches_within_limits_and_hold_when_they_cease(graph, ship, port):
    node = heard(graph, links=[f'udp://:{port}'], systems=['set_points'], commands=True,
                 command_timeout_s=0.5, max_length_m=600.0)  # fmt: skip
    counters = sample_message(WinchSample(SECOND, (400.0, 401.0), (0.0, 0.0), (1e5, 1e5)))
    opened(graph, ship, f'udp://:{port}')
    say(port, 'PTRWL,410.0,M,411.0,M')
    refused = 'not understood: a set point that is refused: '
    unknown = f'{refused}port warp: expected a reading of its counter first'
    graph.until(lambda: unknown in ship.report('sentences').values)
    # The counters are those of the ship that is commanded.
    winches = graph.add(lambda **given: TrawlNode('winches', namespace='heard', **given))
    winches.advertise('winch/joint_states')
    graph.until(lambda: winches.count_subscribers('/heard/winch/joint_states') == 2)
    winches.send(*counters)
    graph.until(lambda: node._guard._counters == (400.0, 401.0))
    assert ship.commands == []
    say(port, 'PTRWL,410.0,M,411.0,M', 'PTRVS,4.00,N,0.0,D')
    graph.until(lambda: len(ship.commands) >= 2)
    assert (410.0, 411.0) in ship.commands
    assert any(speed == pytest.approx(4 * 1852 / 3600) for speed, _ in ship.commands)
    # After the silence the warps are to be held as the counters show, once.
    graph.until(lambda: (400.0, 401.0) in ship.commands)
    say(port, 'PTRWL,700.0,M,411.0,M', 'PTRWL,500.0,M,411.0,M', 'PTRVS,20.00,N,0.0,D')
    graph.until(
        lambda: sum(key.startswith(refused) for key in ship.report('sentences').values) == 4
    )
    assert len(ship.commands) == 3


def test_set_points_are_not_passed_on_unasked(graph, ship, port):
    heard(graph, links=[f'udp://:{port}'], systems=['set_points'])
    opened(graph, ship, f'udp://:{port}')
    say(port, 'PTRVS,4.00,N,0.0,D')
    graph.until(lambda: ship.report('sentences').level == WARN)
    assert 'parameter commands' in ship.report('sentences').message
    assert ship.commands == []


@pytest.mark.parametrize(('age_s', 'taken'), [(0, True), (600, False)])
def test_set_points_of_another_time_are_refused_where_asked(graph, ship, port, age_s, taken):
    heard(graph, links=[f'udp://:{port}'], systems=['set_points'], commands=True,
          max_command_age_s=60.0)  # fmt: skip
    opened(graph, ship, f'udp://:{port}')
    tag = f'c:{int(time.time()) - age_s}'
    sentence = framed('$', 'PTRVS,4.00,N,0.0,D', checksum=True)
    say(port, f'\\{tag}*{calc_checksum(tag)}\\{sentence}'.encode())
    if taken:
        graph.until(lambda: ship.commands)
    else:
        graph.until(lambda: 'max_command_age_s' in ship.report('sentences').message)
        assert ship.commands == []


PARTLY = """\
system: partly
title: Set points that leave something out
sentences:
  speed:
    address: PXYZS
    fields: [{reading: command/vessel speed, unit: kn, decimals: 1}]
    source: its manual
  turn:
    address: PXYZR
    fields: [{reading: command/vessel turn_to_port, unit: deg/min, decimals: 1}]
    source: its manual
"""


def test_set_points_that_leave_something_out_are_refused_and_the_node_goes_on(
    graph, ship, port, tmp_path
):
    path = tmp_path / 'partly.yaml'
    path.write_text(PARTLY)
    heard(graph, links=[f'udp://:{port}'], systems=[str(path)], commands=True)
    opened(graph, ship, f'udp://:{port}')
    say(port, 'PXYZS,4.0', 'PXYZR,1.0')
    refused = 'not understood: a set point that is refused: '
    reasons = {
        f'{refused}rate of turn: expected at most 0.02 rad/s',
        f'{refused}speed: expected 0 to 4 m/s',
    }
    graph.until(lambda: reasons <= ship.report('sentences').values.keys())
    assert ship.commands == []


@pytest.mark.parametrize(
    ('kind', 'parameters', 'complaint'),
    [
        (NmeaIn, {'links': ['udp://:0']}, 'found port 0'),
        (NmeaIn, {'systems': ['marpot']}, 'marpot'),
        (NmeaIn, {'commands': True}, 'no system commands'),
        (NmeaOut, {'systems': ['set_points']}, 'they tell no reading'),
    ],
)
def test_what_cannot_be_is_refused_at_the_start(graph, kind, parameters, complaint):
    with pytest.raises(SentenceError, match=complaint):
        graph.add(kind, **parameters)


def test_the_sentences_of_set_points_command_and_nothing_else():
    for system, command in (('set_points', True), ('ship', False)):
        rows = load_table(system).sentences.values()
        assert {topic in COMMANDS for row in rows for topic in row.topics} == {command}
