# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Links for sentences: serial ports, pseudo-terminals, UDP and TCP, each opened again when lost.

An address is a text: ``udp://HOST:PORT``, ``tcp://HOST:PORT``, ``tcp-listen://HOST:PORT``,
``serial:/dev/ttyUSB0?baud=4800`` or ``pty:PATH``, which makes a pseudo-terminal and a link to it.
Without a host it is this machine alone.
"""

import ipaddress
import math
import os
import pty
import select
import socket
import struct
import termios
import time
import tty
from abc import ABC, abstractmethod
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from urllib.parse import parse_qsl

from trawl_ros.core.errors import SentenceError
from trawl_ros.core.network import THIS_MACHINE

KINDS = ('udp', 'tcp', 'tcp-listen', 'serial', 'pty')
MOST_CLIENTS = 8
SPEAKS_S = 10.0
"""A client that said nothing for this long makes room for another one."""

READ_BYTES = 65_536
RECEIVE_BUFFER = 4 << 20
CONNECT_S = 3.0
WRITE_S = 0.5
"""Time (s) that a reader at the other end may take; after it a sentence is given up."""


@dataclass(frozen=True)
class LinkAddress:
    """Address of a link.

    ``interface`` is that of this machine by which multicast goes; ``broadcast`` allows an address
    that all hear.
    """

    text: str
    kind: str
    host: str = THIS_MACHINE
    port: int = 0
    path: Path = Path()
    baud: int = 4800
    interface: str = THIS_MACHINE
    broadcast: bool = False

    @property
    def is_multicast(self) -> bool:
        """True if the host is a group that is to be joined."""
        with suppress(ValueError):
            return ipaddress.ip_address(self.host).is_multicast
        return False


def parse_link(text: str) -> LinkAddress:
    """Read the address of a link.

    Raises
    ------
    SentenceError
        If it is none; says what was found and expected.
    """
    kind, colon, rest = text.partition(':')
    place, _, query = rest.partition('?')
    options = dict(parse_qsl(query, keep_blank_values=True))
    known = {'serial': {'baud'}, 'udp': {'interface', 'broadcast'}}.get(kind, set())
    if kind not in KINDS or not colon:
        raise SentenceError(
            f'link {text!r}: expected one of udp://HOST:PORT, tcp://HOST:PORT, '
            'tcp-listen://HOST:PORT, serial:/dev/PORT?baud=4800, pty:PATH'
        )
    if strange := sorted(options.keys() - known):
        raise SentenceError(
            f'link {text!r}: found option {strange[0]!r}, expected '
            f'{" or ".join(sorted(known)) or "none"}'
        )
    if kind in ('serial', 'pty'):
        if not place:
            raise SentenceError(f'link {text!r}: no path, expected as {kind}:/dev/NAME')
        return LinkAddress(text, kind, path=Path(place), baud=_baud(text, options))
    host, _, port = place.removeprefix('//').rpartition(':')
    if not place.startswith('//') or not (port.isascii() and port.isdigit()):
        raise SentenceError(f'link {text!r}: expected as {kind}://HOST:PORT')
    if not 1 <= int(port) <= 65_535:
        raise SentenceError(f'link {text!r}: found port {port}, expected 1 to 65535')
    interface = options.get('interface', THIS_MACHINE)
    return LinkAddress(
        text, kind, host or THIS_MACHINE, int(port), interface=interface,
        broadcast='broadcast' in options,
    )  # fmt: skip


def _baud(text: str, options: dict[str, str]) -> int:
    baud = options.get('baud', '4800')
    if not hasattr(termios, f'B{baud}'):
        raise SentenceError(f'link {text!r}: found baud {baud!r}, expected as 4800 or 115200')
    return int(baud)


class Received(NamedTuple):
    """Bytes of one source of a channel, empty where it ended; sender is the host, where known."""

    source: int
    data: bytes
    sender: str = ''


class Channel(ABC):
    """Open link: bytes in and out, none of which waits for longer than its timeout."""

    datagrams = False
    turned_away = 0
    """Clients that found all places taken, or lost theirs to another."""

    @abstractmethod
    def poll(self, timeout_s: float) -> list[Received]:
        """Wait for bytes, and give them.

        Raises
        ------
        OSError
            If the link is lost.
        """

    @abstractmethod
    def send(self, data: bytes) -> bool:
        """Send bytes; false if nobody took them.

        Raises
        ------
        OSError
            If the link is lost.
        """

    @abstractmethod
    def close(self) -> None:
        """Close the link."""


class _Udp(Channel):
    datagrams = True

    def __init__(self, address: LinkAddress, *, listens: bool) -> None:
        self._to = (address.host, address.port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            interface = socket.inet_aton(address.interface)
            if address.broadcast:
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            if address.is_multicast:
                self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
                self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
            if listens:
                # Several programs of a ship listen to the same sentences.
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
                self._socket.bind(self._to)
                if address.is_multicast:
                    group = struct.pack('4s4s', socket.inet_aton(address.host), interface)
                    self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        except OSError:
            self._socket.close()
            raise
        self._socket.setblocking(False)

    def poll(self, timeout_s: float) -> list[Received]:
        found: list[Received] = []
        if select.select([self._socket], [], [], timeout_s)[0]:
            with suppress(BlockingIOError):
                # One source for all senders: a datagram is whole. The host says who speaks; a
                # port does not, for some open another for each sentence.
                while len(found) < 200:
                    data, (host, _) = self._socket.recvfrom(READ_BYTES)
                    found.append(Received(0, data, host))
        return [item for item in found if item.data]

    def send(self, data: bytes) -> bool:
        try:
            self._socket.sendto(data, self._to)
        except (BlockingIOError, ConnectionRefusedError):
            return False
        return True

    def close(self) -> None:
        self._socket.close()


class _Stream(Channel):
    """File descriptor of bytes in a row: a serial port, a pseudo-terminal, a TCP connection."""

    def __init__(self, number: int, also: int = -1, link: Path | None = None) -> None:
        self._number = number
        self._also = also
        self._link = link
        os.set_blocking(number, False)

    def poll(self, timeout_s: float) -> list[Received]:
        if not select.select([self._number], [], [], timeout_s)[0]:
            return []
        data = os.read(self._number, READ_BYTES)
        if not data:
            raise OSError(0, 'closed by the other end')
        return [Received(0, data)]

    def send(self, data: bytes) -> bool:
        while data:
            if not select.select([], [self._number], [], WRITE_S)[1]:
                return False
            with suppress(BlockingIOError):
                data = data[os.write(self._number, data) :]
        return True

    def close(self) -> None:
        if self._link is not None:
            with suppress(OSError):
                # Another link may have taken its place.
                if str(self._link.readlink()) == os.ttyname(self._also):
                    self._link.unlink()
        for number in (self._number, self._also):
            if number >= 0:
                os.close(number)


class _Server(Channel):
    """TCP server: what comes from any client, and the same to all of them.

    Where it ``listens``, clients that say nothing lock nobody out.
    """

    def __init__(self, address: LinkAddress, *, listens: bool) -> None:
        self._listens = listens
        self._heard: dict[int, float] = {}
        self._listener = socket.create_server((address.host, address.port))
        self._listener.setblocking(False)
        self._clients: dict[int, socket.socket] = {}
        self._next = 1

    def poll(self, timeout_s: float) -> list[Received]:
        ready = select.select([self._listener, *self._clients.values()], [], [], timeout_s)[0]
        found = []
        if self._listener in ready:
            with suppress(OSError):
                client = self._listener.accept()[0]
                client.setblocking(False)
                if (silent := self._make_room()) is not None:
                    found.append(Received(silent, b''))
                if len(self._clients) < MOST_CLIENTS:
                    self._clients[self._next] = client
                    self._next += 1
                else:
                    client.close()
        for number, client in list(self._clients.items()):
            if client in ready:
                try:
                    host = client.getpeername()[0]
                    data = client.recv(READ_BYTES)
                except OSError:
                    host, data = '', b''
                found.append(Received(number, data, host))
                self._heard[number] = time.monotonic()
                if not data:
                    self._drop(number)
        return found

    def _make_room(self) -> int | None:
        """Drop the longest silent client if all places are taken."""
        # A client that never sent anything counts as silent for ever.
        if len(self._clients) < MOST_CLIENTS:
            return None
        self.turned_away += 1
        number = min(self._clients, key=lambda one: self._heard.get(one, -math.inf))
        silent = time.monotonic() - self._heard.get(number, -math.inf) > SPEAKS_S
        if not self._listens or not silent:
            return None
        self._drop(number)
        return number

    def send(self, data: bytes) -> bool:
        self.poll(0.0)
        for number, client in list(self._clients.items()):
            # A client that takes only a part would get half sentences from now on.
            try:
                whole = client.send(data) == len(data)
            except OSError:
                whole = False
            if not whole:
                self._drop(number)
        return bool(self._clients)

    def close(self) -> None:
        for number in list(self._clients):
            self._drop(number)
        self._listener.close()

    def _drop(self, number: int) -> None:
        self._clients.pop(number).close()
        self._heard.pop(number, None)


def open_channel(address: LinkAddress, *, listens: bool) -> Channel:
    """Open a link.

    Parameters
    ----------
    address
        Of the link.
    listens
        True if sentences are to come in by it.

    Raises
    ------
    OSError
        If it cannot be opened now.
    """
    match address.kind:
        case 'udp':
            return _Udp(address, listens=listens)
        case 'tcp':
            joined = socket.create_connection((address.host, address.port), CONNECT_S)
            return _Stream(joined.detach())
        case 'tcp-listen':
            return _Server(address, listens=listens)
        case 'serial':
            return _Stream(_open_serial(address))
    return _open_pty(address.path)


def _open_serial(address: LinkAddress) -> int:
    number = os.open(address.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        tty.setraw(number)
        settings = termios.tcgetattr(number)
        speed = getattr(termios, f'B{address.baud}')
        settings[2] |= termios.CLOCAL | termios.CREAD
        settings[4] = settings[5] = speed
        termios.tcsetattr(number, termios.TCSANOW, settings)
    except termios.error as reason:
        os.close(number)
        raise OSError(0, f'no serial port ({reason.args[-1]})') from None
    return number


def _open_pty(path: Path) -> Channel:
    master, slave = pty.openpty()
    try:
        # Kept open on both ends, so that a reader may come and go.
        tty.setraw(slave)
        name = os.ttyname(slave)
        if os.path.lexists(path) and not _is_left_over(path, name):
            raise OSError(0, 'there is something already, expected a new path')
        path.unlink(missing_ok=True)
        path.symlink_to(name)
    except OSError:
        os.close(master)
        os.close(slave)
        raise
    return _Stream(master, slave, path)


def _is_left_over(path: Path, name: str) -> bool:
    """Return whether a link is that of a pseudo-terminal that is gone, as after a kill.

    Its number is free, or is given again to the terminal called ``name``.
    """
    if not path.is_symlink():
        return False
    target = path.readlink()
    left = str(target) == name or not target.exists()
    return left and target.parent == Path('/dev/pts')
