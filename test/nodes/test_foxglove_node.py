"""Viewers get what is published, byte for byte, by a WebSocket client that knows the protocol."""

import json
import re
import socket
import struct
import sys
import threading
from contextlib import ExitStack, suppress

import psutil
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
pytest.importorskip('websockets', reason='needs websockets, from the extra `view`')

from websockets.exceptions import ConnectionClosed, InvalidStatus  # noqa: E402
from websockets.sync.client import connect  # noqa: E402

from trawl_ros.core.limits import Limit  # noqa: E402
from trawl_ros.core.resources import share_path  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.diagnostics import read_statuses  # noqa: E402
from trawl_ros.messages.estimates import ESTIMATE, estimate_message  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.foxglove_node import FoxgloveNode, main  # noqa: E402
from trawl_ros.nodes.links import websocket  # noqa: E402
from trawl_ros.nodes.runtime.incoming import installed  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.records.samples import RangeSample, WinchSample  # noqa: E402
from trawl_ros.records.topics import TOPICS, absolute  # noqa: E402

pytestmark = pytest.mark.ros

LOCAL = '127.0.0.1'
PROTOCOL = 'foxglove.sdk.v1'
BACKLOG = 20
MESSAGE = 1
"""First byte of a message, before the number of the subscription and the time."""

WINCH = absolute('winch/joint_states')
SPREAD = absolute('door/spread')
STATUS = absolute(ESTIMATE)


def joined(port, **options):
    return connect(f'ws://{LOCAL}:{port}', subprotocols=[PROTOCOL], **options)


class Viewer:
    """Client as Foxglove and Lichtblick are; a thread of its own takes what comes."""

    def __init__(self, port):
        self._stack = ExitStack()
        self.line = self._stack.enter_context(joined(port, max_size=None))
        self.channels, self.messages, self.said = {}, [], []
        self._wanted = {}
        self._thread = threading.Thread(target=self._take, daemon=True)
        self._thread.start()

    def want(self, *topics):
        wishes = []
        for topic in topics:
            number = len(self._wanted)
            self._wanted[number] = topic
            wishes.append({'id': number, 'channelId': self.channels[topic]['id']})
        self.line.send(json.dumps({'op': 'subscribe', 'subscriptions': wishes}))

    def leave(self, topic):
        numbers = [number for number, wanted in self._wanted.items() if wanted == topic]
        self.line.send(json.dumps({'op': 'unsubscribe', 'subscriptionIds': numbers}))

    def of(self, topic):
        return [data for about, data in self.messages if about == topic]

    def close(self):
        self._stack.close()
        self._thread.join(10.0)

    def _take(self):
        with suppress(ConnectionClosed):
            for packet in self.line:
                if isinstance(packet, bytes):
                    kind, number, _ = struct.unpack_from('<BIQ', packet)
                    assert kind == MESSAGE
                    self.messages.append((self._wanted[number], packet[13:]))
                    continue
                said = json.loads(packet)
                self.said.append(said)
                for channel in said.get('channels', ()) if said['op'] == 'advertise' else ():
                    self.channels[channel['topic']] = channel


@pytest.fixture
def port():
    with socket.socket() as probe:
        probe.bind((LOCAL, 0))
        return probe.getsockname()[1]


@pytest.fixture
def node(graph, port):
    return graph.add(FoxgloveNode, port=port, backlog=BACKLOG)


@pytest.fixture
def look(graph, node, port):
    """Make a viewer that has been told all topics."""
    viewers = []

    def look():
        viewer = Viewer(port)
        viewers.append(viewer)
        graph.until(lambda: len(viewer.channels) == len(node._topics))
        return viewer

    yield look
    for viewer in viewers:
        viewer.close()


@pytest.fixture
def ship(graph):
    ship = graph.add(lambda **given: TrawlNode('ship', **given))
    for topic in (WINCH, SPREAD, STATUS):
        ship.advertise(topic)
    return ship


def heard(graph, ship, *topics):
    """Wait until somebody listens to topics, and knows whom it listens to."""
    graph.until(lambda: all(ship._senders[topic].get_subscription_count() for topic in topics))
    full = {ship.full_name(topic) for topic in topics}
    ears = [
        ear for node in graph.executor.get_nodes() for ear in node.subscriptions
        if ear.topic_name in full
    ]  # fmt: skip
    graph.until(lambda: all(ear.get_publisher_count() for ear in ears))


def winches(second):
    lengths = 400.0 + second, 401.0
    return sample_message(WinchSample(second * 10**9, lengths, (0.5, 0.0), (1e5, 2e5)))[1]


def as_viewers_decode(channel, data):
    """Decode a message by nothing but what was advertised."""
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(channel['schema'], channel['schemaName']))
    return store.deserialize_cdr(data, channel['schemaName'])


def test_every_topic_is_offered_with_its_definition(look, node):
    channels = look().channels
    layout = share_path('config', 'foxglove', 'trawl.json').read_text()
    assert set(re.findall(r'"(/(?:trawl/[a-z_/]+|diagnostics))', layout)) <= set(channels)
    there = {absolute(name) for name, topic in TOPICS.items() if installed(topic.type)}
    assert there <= set(channels)
    for topic in there:
        channel = channels[topic]
        assert channel['schemaName'] == node._topics[topic].type
        assert (channel['encoding'], channel['schemaEncoding']) == ('cdr', 'ros2msg')
        assert get_types_from_msg(channel['schema'], channel['schemaName'])


def test_messages_come_as_they_were_published_and_in_their_order(graph, look, ship):
    viewer = look()
    viewer.want(WINCH, SPREAD)
    heard(graph, ship, WINCH, SPREAD)
    sent = [winches(second) for second in range(1, 51)]
    for number, message in enumerate(sent):
        ship.send(WINCH, message)
        # A viewer that is slower, for want of processor, would lose some.
        graph.until(lambda before=number - BACKLOG // 2: len(viewer.messages) > before)
    _, spread = sample_message(RangeSample(10**9, 'spread', 84.5, 0.1, 1.0, 400.0))
    ship.send(SPREAD, spread)
    graph.until(lambda: len(viewer.messages) == 51)
    assert viewer.of(WINCH) == [serialize(message) for message in sent]
    back = as_viewers_decode(viewer.channels[WINCH], viewer.of(WINCH)[7])
    assert list(back.name) == ['port_warp', 'starboard_warp']
    assert (list(back.position), list(back.effort)) == ([408.0, 401.0], [1e5, 2e5])
    back = as_viewers_decode(viewer.channels[SPREAD], viewer.of(SPREAD)[0])
    assert back.range == pytest.approx(84.5)


def test_a_topic_is_listened_to_only_while_it_is_wanted(graph, look, ship, node):
    first, second = look(), look()
    graph.rest(0.3)
    assert ship._senders[WINCH].get_subscription_count() == 0
    first.want(WINCH)
    second.want(WINCH)
    heard(graph, ship, WINCH)
    assert ship._senders[SPREAD].get_subscription_count() == 0
    first.leave(WINCH)
    graph.rest(0.3)
    assert ship._senders[WINCH].get_subscription_count() == 1
    # Who goes without a word wants nothing any more.
    second.line.socket.shutdown(socket.SHUT_RDWR)
    graph.until(lambda: ship._senders[WINCH].get_subscription_count() == 0)
    assert node._server.viewers == 0
    first.want(WINCH)
    heard(graph, ship, WINCH)


def test_whoever_comes_late_gets_the_last_of_what_is_latched(graph, look, ship):
    message = estimate_message(range(12))[1]
    ship.send(STATUS, message)
    ship.send(WINCH, winches(1))
    for number in (1, 2):
        viewer = look()
        viewer.want(STATUS, WINCH)
        graph.until(lambda viewer=viewer: viewer.of(STATUS))
        graph.rest(0.2)
        assert viewer.of(STATUS) == [serialize(message)], number
        # What is not latched has gone by.
        assert viewer.of(WINCH) == []


NONSENSE = (
    'nonsense',
    '{',
    '[]',
    '{"op": "subscribe"}',
    '{"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 99999999999}]}',
    '{"op": "unsubscribe", "subscriptionIds": [7]}',
    '{"op": "advertise", "channels": [{"id": 1, "topic": "/trawl/command/winch", '
    '"encoding": "cdr", "schemaName": "sensor_msgs/msg/JointState"}]}',
    '{"op": "setParameters", "parameters": [{"name": "port", "value": 1}]}',
    b'',
    b'\x01',
    b'\xff' * 1000,
    b'\x01' + bytes(200_000),
)


def test_nonsense_does_no_harm_and_nobody_may_command(graph, look, ship, node, port):
    viewer = look()
    viewer.want(WINCH)
    heard(graph, ship, WINCH)
    commands = []
    ship.listen('command/winch', commands.append, CONSUMER)
    for nonsense in NONSENSE:
        stranger = Viewer(port)
        for _ in range(3):
            with suppress(ConnectionClosed):
                stranger.line.send(nonsense)
        graph.rest(0.02)
        stranger.close()
    with socket.create_connection((LOCAL, port)) as raw, suppress(OSError):
        raw.sendall(b'\x00\xff' * 5000)
    with pytest.raises(Exception, match=r'.'), connect(f'ws://{LOCAL}:{port}'):
        pass
    ship.send(WINCH, winches(5))
    graph.until(lambda: viewer.of(WINCH))
    assert viewer.of(WINCH) == [serialize(winches(5))]
    assert commands == []
    assert node.exit_code is None


@pytest.mark.parametrize(
    ('origin', 'host'),
    [
        ('https://evil.example', None),
        ('http://localhost.evil.example', None),
        ('https://app.foxglove.dev.evil.example', None),
        ('null', None),
        ('', None),
        ('http://[', None),
        (None, 'evil.example'),
        ('http://localhost:8080', 'evil.example:8765'),
        (None, '127.0.0.1.evil.example'),
        (None, ''),
    ],
)
def test_pages_of_the_web_are_refused(graph, node, port, origin, host):
    lines = [f'Host: {host if host is not None else f"{LOCAL}:{port}"}']
    lines += [] if origin is None else [f'Origin: {origin}']
    assert b' 403 ' in _answer(port, lines)
    assert node.statuses()[0].values['last refused']


@pytest.mark.parametrize(
    ('origin', 'host'),
    [
        ('http://localhost:8080', 'localhost'),
        ('http://127.0.0.1', '127.0.0.1'),
        ('http://[::1]:8080', '192.168.7.5:8765'),
        ('https://app.foxglove.dev', '[::1]:8765'),
        ('file://', socket.gethostname()),
        (None, LOCAL),
    ],
)
def test_viewers_of_this_machine_may_connect(node, port, origin, host):
    lines = [f'Host: {host}'] + ([] if origin is None else [f'Origin: {origin}'])
    assert b' 101 ' in _answer(port, lines)


def _answer(port, lines):
    """First line of the answer to a handshake with these headers."""
    lines = [
        'GET / HTTP/1.1', *lines, 'Upgrade: websocket', 'Connection: Upgrade',
        'Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==', 'Sec-WebSocket-Version: 13',
        f'Sec-WebSocket-Protocol: {PROTOCOL}', '', '',
    ]  # fmt: skip
    with socket.create_connection((LOCAL, port), 5.0) as line:
        line.sendall('\r\n'.join(lines).encode())
        return line.recv(1000).split(b'\r\n')[0] + b' '


def test_viewers_are_no_more_than_allowed(monkeypatch, look, node, port):
    monkeypatch.setattr(websocket, 'VIEWERS', Limit(2, '', ''))
    look(), look()
    with pytest.raises(InvalidStatus, match='403'):
        joined(port)


def test_a_viewer_that_stands_still_holds_up_nobody_and_costs_bounded_memory(
    graph, look, ship, node, port
):
    """Its lines are full after some megabytes, and of the rest as many messages wait as may."""
    image, size = absolute('sonar/image'), 400_000
    ship.advertise(image)
    blank = bytes(size)
    viewer = look()
    wish = {'id': 1, 'channelId': viewer.channels[image]['id']}
    with joined(port, max_queue=1, close_timeout=0.1) as slow:
        slow.send(json.dumps({'op': 'subscribe', 'subscriptions': [wish]}))
        viewer.want(WINCH)
        heard(graph, ship, image, WINCH)
        before = psutil.Process().memory_info().rss
        for second in range(1, 151):
            ship.send_bytes(image, blank)
            ship.send(WINCH, winches(second))
            graph.until(lambda second=second: node._passed[WINCH] == node._passed[image] == second)
            # The other viewer loses none: it gets as much of the processor as it needs.
            graph.until(lambda least=second - BACKLOG // 2: len(viewer.of(WINCH)) > least)
        graph.until(lambda: len(viewer.of(WINCH)) == 150)
        grown = psutil.Process().memory_info().rss - before
        # All of them are 60 MB; besides those that may wait some lie in the line's own buffers.
        assert grown < 2 * BACKLOG * size


def test_diagnostics_count_viewers_and_messages(graph, look, ship):
    reports = {}
    ship.listen(
        '/diagnostics',
        lambda message: reports.update({s.name: s for s in read_statuses(message)}),
        CONSUMER,
    )
    viewer = look()
    viewer.want(WINCH)
    heard(graph, ship, WINCH)
    for second in range(3):
        ship.send(WINCH, winches(second))
    name = '/trawl/foxglove_node: viewers'
    graph.until(lambda: name in reports and reports[name].values.get(f'passed on {WINCH}') == '3')
    assert reports[name].message == '1 viewers'


@pytest.mark.parametrize(
    ('host', 'reason'), [(LOCAL, 'Address already in use'), ('203.0.113.7', 'assign'), ('x y', '')]
)
def test_where_it_cannot_listen_is_told_and_ends_the_node(host, reason, port, capfd):
    with socket.create_server((LOCAL, port)):
        words = ['-p', f'port:={port}', '-p', f'host:={host!r}']
        code = main(['/somewhere/foxglove_node', '--ros-args', *words])
    errors = capfd.readouterr().err
    assert code == 1
    beginning = f'foxglove_node: parameters host and port: {host}:{port} cannot be listened to ('
    assert errors.startswith(beginning)
    assert reason in errors
    assert len(errors.splitlines()) == 1


def test_without_its_library_it_says_what_to_install(monkeypatch, capfd):
    monkeypatch.setitem(sys.modules, 'websockets.asyncio.server', None)
    monkeypatch.delitem(sys.modules, 'trawl_ros.nodes.links.websocket', raising=False)
    assert main(['/somewhere/foxglove_node']) == 1
    assert "pip install 'trawl_ros[view]'" in capfd.readouterr().err
