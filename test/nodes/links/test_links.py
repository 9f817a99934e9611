"""Links are opened again when they are lost, and hold a bounded number of lines."""

import os
import pty
import socket
import time
import tty

import pytest

from trawl_ros.core.errors import SentenceError
from trawl_ros.core.network import THIS_MACHINE
from trawl_ros.nodes.links import threads
from trawl_ros.nodes.links.channels import MOST_CLIENTS, parse_link
from trawl_ros.nodes.links.threads import WAITING_LINES, Line, LineSource, SentenceSink

LINE = b'$SCWTP,4.25,T*00'


@pytest.fixture(autouse=True)
def soon(monkeypatch):
    monkeypatch.setattr(threads, 'RETRY_S', 0.05)


@pytest.fixture
def opened():
    """Open links that are closed at the end."""
    links = []

    def open_link(kind, text):
        links.append(kind(parse_link(text)))
        return links[-1]

    yield open_link
    for link in links:
        link.close()


def until(condition):
    end = time.monotonic() + 20.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def free_port():
    with socket.socket() as probe:
        probe.bind((THIS_MACHINE, 0))
        return probe.getsockname()[1]


def arrive(sink, source, count=3):
    """Send until lines arrive, and give the first of them."""
    lines = []

    def come():
        sink.put(LINE + b'\r\n')
        lines.extend(line.text for line in source.take(100))
        return len(lines) >= count

    until(come)
    return lines[0]


def test_without_a_host_it_is_this_machine_alone():
    assert parse_link('udp://:10110').host == THIS_MACHINE
    assert parse_link('tcp-listen://:10110').host == THIS_MACHINE
    assert parse_link('udp://239.192.0.1:60001').is_multicast


@pytest.mark.parametrize(
    ('text', 'complaint'),
    [
        ('10110', 'expected one of udp://'),
        ('udp:10110', 'expected as udp://HOST:PORT'),
        ('udp://:70000', 'found port 70000'),
        ('udp://:x', 'expected as udp://HOST:PORT'),
        ('tcp://:1?baud=4800', "option 'baud', expected none"),
        ('serial:', 'no path'),
        ('serial:/dev/ttyS0?baud=4801', "baud '4801'"),
    ],
)
def test_an_address_that_is_none_is_refused_with_what_was_found(text, complaint):
    with pytest.raises(SentenceError, match=complaint):
        parse_link(text)


@pytest.mark.parametrize(
    ('listens', 'sends'),
    [
        ('udp://:{port}', 'udp://:{port}'),
        ('udp://239.192.0.7:{port}', 'udp://239.192.0.7:{port}'),
        ('udp://127.255.255.255:{port}', 'udp://127.255.255.255:{port}?broadcast'),
        ('tcp-listen://:{port}', 'tcp://:{port}'),
        ('tcp://:{port}', 'tcp-listen://:{port}'),
        ('serial:{path}', 'pty:{path}'),
        ('pty:{path}', 'serial:{path}?baud=115200'),
    ],
)
def test_lines_go_from_one_end_to_the_other(listens, sends, opened, tmp_path):
    place = {'port': free_port(), 'path': tmp_path / 'tty'}
    source = opened(LineSource, listens.format(**place))
    sink = opened(SentenceSink, sends.format(**place))
    assert arrive(sink, source) == LINE
    assert (source.state, sink.state) == ('', '')


def test_a_connection_that_breaks_is_made_again(opened):
    port = free_port()
    sink = opened(SentenceSink, f'tcp-listen://:{port}')
    source = opened(LineSource, f'tcp://:{port}')
    arrive(sink, source)
    sink.close()
    until(lambda: source.state)
    assert 'refused' in source.state.lower() or 'closed' in source.state
    again = opened(SentenceSink, f'tcp-listen://:{port}')
    arrive(again, source)
    assert source.opened >= 2


def test_a_serial_port_that_vanishes_is_opened_when_it_is_back(opened, tmp_path):
    path = tmp_path / 'tty'
    source = opened(LineSource, f'serial:{path}')
    until(lambda: source.state == 'No such file or directory')
    for _ in range(2):
        sink = SentenceSink(parse_link(f'pty:{path}'))
        arrive(sink, source)
        sink.close()
        until(lambda: source.state)


def test_a_flood_is_given_up_in_part_and_counted(opened):
    port = free_port()
    source = opened(LineSource, f'tcp-listen://:{port}')
    until(lambda: source.state == '')
    block, blocks = (LINE + b'\r\n') * 10_000, 100
    with socket.create_connection((THIS_MACHINE, port)) as client:
        for _ in range(blocks):
            client.sendall(block)
        client.sendall(b'x' * 5000 + b'\n')
        until(lambda: source.too_long == 1)
        assert source.lines == 1_000_000
        assert source.lost == 1_000_000 - WAITING_LINES
        assert len(source.take(10**6)) == WAITING_LINES
        client.sendall(LINE + b'\r\n')
        until(lambda: source.lines == 1_000_001)
    assert source.take(10) == [Line(LINE, THIS_MACHINE)]


def test_a_flood_of_datagrams_is_outlived(opened):
    """What a socket's buffer does not hold is lost before it is heard of."""
    port = free_port()
    source = opened(LineSource, f'udp://:{port}')
    until(lambda: source.state == '')
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for _ in range(20_000):
            sender.sendto((LINE + b'\r\n') * 50, (THIS_MACHINE, port))
        until(lambda: source.lines > WAITING_LINES)
        assert len(source.take(10**6)) <= WAITING_LINES

        def heard():
            sender.sendto(b'$SCWTP,9,T\r\n', (THIS_MACHINE, port))
            return Line(b'$SCWTP,9,T', THIS_MACHINE) in source.take(10**6)

        until(heard)


def test_a_reader_that_stands_still_holds_nobody_up(opened, tmp_path):
    """A pseudo-terminal that nobody reads is full after some kilobytes."""
    sink = opened(SentenceSink, f'pty:{tmp_path / "tty"}')
    until(lambda: sink.state == '')
    for _ in range(3 * WAITING_LINES):
        sink.put(LINE + b'\r\n')
    assert sink.lost >= WAITING_LINES


def test_a_file_in_the_place_of_a_pseudo_terminal_stays(opened, tmp_path):
    path = tmp_path / 'notes'
    path.write_text('mine')
    sink = opened(SentenceSink, f'pty:{path}')
    until(lambda: 'something already' in sink.state)
    assert path.read_text() == 'mine'


def _joined(port, number):
    return [socket.create_connection((THIS_MACHINE, port)) for _ in range(number)]


def test_silent_clients_lock_nobody_out(opened):
    port = free_port()
    source = opened(LineSource, f'tcp-listen://:{port}')
    until(lambda: source.state == '')
    silent = _joined(port, MOST_CLIENTS)
    until(lambda: len(source._channel._clients) == MOST_CLIENTS)
    for spoken in range(1, 4):
        with socket.create_connection((THIS_MACHINE, port)) as client:
            client.sendall(LINE + b'\r\n')
            until(lambda spoken=spoken: source.lines == spoken)
    assert 'too many' in source.turned_away
    for client in silent:
        client.close()


def test_clients_that_speak_keep_their_places(opened):
    port = free_port()
    source = opened(LineSource, f'tcp-listen://:{port}')
    until(lambda: source.state == '')
    speaking = _joined(port, MOST_CLIENTS)
    for client in speaking:
        client.sendall(LINE + b'\r\n')
    until(lambda: source.lines == MOST_CLIENTS)
    (late,) = _joined(port, 1)
    until(lambda: source.turned_away)
    for client in speaking:
        client.sendall(LINE + b'\r\n')
    until(lambda: source.lines == 2 * MOST_CLIENTS)
    for client in (late, *speaking):
        client.close()


def test_listeners_keep_their_places(opened):
    port = free_port()
    sink = opened(SentenceSink, f'tcp-listen://:{port}')
    until(lambda: sink.state == '')
    first = _joined(port, MOST_CLIENTS)
    (late,) = _joined(port, 1)
    until(lambda: sink.turned_away)
    sink.put(LINE + b'\r\n')
    assert all(client.recv(100) == LINE + b'\r\n' for client in first)
    for client in (late, *first):
        client.close()


@pytest.mark.parametrize('target', ['notes', 'nowhere', '/dev/null'])
def test_a_link_of_somebody_else_in_the_place_of_a_pseudo_terminal_stays(opened, tmp_path, target):
    (tmp_path / 'notes').write_text('mine')
    link = tmp_path / 'link'
    link.symlink_to(target)
    sink = opened(SentenceSink, f'pty:{link}')
    until(lambda: 'something already' in sink.state)
    assert str(link.readlink()) == target


def test_a_pseudo_terminal_in_use_keeps_its_link(opened, tmp_path):
    path = tmp_path / 'tty'
    first = opened(SentenceSink, f'pty:{path}')
    until(lambda: first.state == '')
    name = path.readlink()
    second = opened(SentenceSink, f'pty:{path}')
    until(lambda: 'something already' in second.state)
    assert path.readlink() == name


def test_the_link_that_a_kill_left_is_replaced(opened, tmp_path):
    path = tmp_path / 'tty'
    master, slave = pty.openpty()
    path.symlink_to(os.ttyname(slave))
    os.close(master)
    os.close(slave)
    sink = opened(SentenceSink, f'pty:{path}')
    until(lambda: sink.state == '')


def test_half_lines_of_a_port_are_put_together(opened):
    master, slave = pty.openpty()
    tty.setraw(slave)
    source = opened(LineSource, f'serial:{os.ttyname(slave)}')
    until(lambda: source.state == '')
    lines = []
    for piece in (LINE[:5], LINE[5:] + b'\r', b'\n' + LINE[:1], LINE[1:] + b'\r\n'):
        os.write(master, piece)
        time.sleep(0.01)
    until(lambda: lines.extend(line.text for line in source.take(9)) or len(lines) == 2)
    assert lines == [LINE, LINE]
    os.close(master)
    until(lambda: source.state)
    os.close(slave)
