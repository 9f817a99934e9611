# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""WebSocket server for viewers by Foxglove's protocol, in a thread of its own.

Protocol: https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md
"""

import asyncio
import json
import socket
import struct
from collections import defaultdict, deque
from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass, field
from http import HTTPStatus
from threading import Lock, Thread
from typing import Any

from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from trawl_ros.bags.storage.stored import describe
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.foreign import one_line, parse_json, short
from trawl_ros.core.limits import MESSAGE_BYTES, SENTENCE, SUBSCRIPTIONS, VIEWERS
from trawl_ros.core.network import is_own_name, is_own_origin

PROTOCOLS = [Subprotocol('foxglove.sdk.v1'), Subprotocol('foxglove.websocket.v1')]
DATA, TIME = struct.Struct('<BIQ'), struct.Struct('<BQ')
DATA_CODE, TIME_CODE = 1, 2
"""First bytes of a message and of a time."""

CLOSE_S = 1.0


@dataclass(frozen=True)
class SubscriptionRequest:
    """Request of a viewer to begin a subscription, or to end it where ``wanted`` is False."""

    viewer: int
    topic: str
    wanted: bool


@dataclass(eq=False)
class _Viewer:
    """Viewer: its topics by the numbers of its subscriptions, and what waits for it."""

    number: int
    waiting: deque[bytes]
    topics: dict[int, str] = field(default_factory=dict)
    time: bytes | None = None
    ready: asyncio.Event = field(default_factory=asyncio.Event)

    async def send_to(self, connection: ServerConnection) -> None:
        while True:
            await self.ready.wait()
            self.ready.clear()
            while True:
                if (time := self.time) is not None:
                    self.time = None
                    await connection.send(time)
                try:
                    packet = self.waiting.popleft()
                except IndexError:
                    break
                await connection.send(packet)


class ViewerServer:
    """Server that viewers connect to, Foxglove or Lichtblick.

    Messages are passed on as they are. For each viewer a bounded number of them waits, and the
    oldest are given up: nobody is held up by a slow one. Viewers may not publish, call services or
    set parameters. Pages of the web are refused, unless they are of this machine or allowed: a
    browser would let any page read all topics.

    Parameters
    ----------
    host, port
        Address of this machine that it listens at.
    name
        By which viewers show it.
    backlog
        Messages that wait at most for each viewer.
    origins
        Origins of pages that may connect, as well as those of this machine.
    tells_time
        True if viewers are to go by the time that `tell_time` gives.

    Attributes
    ----------
    refused : str
        The last refusal, with its reason; empty before.

    Raises
    ------
    TrawlError
        If it cannot listen there.
    """

    def __init__(
        self,
        host: str,
        port: int,
        name: str,
        backlog: int,
        origins: Collection[str] = (),
        *,
        tells_time: bool,
    ) -> None:
        self.refused = ''
        self._host, self._name, self._backlog = host, name, backlog
        self._origins = frozenset(origins)
        self._tells_time = tells_time
        self._lock = Lock()
        self._channels: list[dict[str, object]] = []
        self._open: list[_Viewer] = []
        self._requests: list[SubscriptionRequest] = []
        self._wanting: dict[str, set[int]] = defaultdict(set)
        self._made = 0
        try:
            listener = socket.create_server((host, port))
        except (OSError, UnicodeError) as reason:
            raise TrawlError(
                f'parameters host and port: {host}:{port} cannot be listened to '
                f'({short(reason)}); expected an address of this machine with a free port'
            ) from None
        self._loop = asyncio.new_event_loop()
        self._ended = asyncio.Event()
        self._thread = Thread(target=self._run, args=(listener,), name=name, daemon=True)
        self._thread.start()

    def offer(self, topic: str, type_name: str) -> None:
        """Advertise a topic with the definition of its type, to viewers that come from now on."""
        definition = describe(type_name, '')
        self._channels.append(
            {
                'id': len(self._channels) + 1,
                'topic': topic,
                'encoding': definition.message_encoding,
                'schemaName': type_name,
                'schemaEncoding': definition.schema_encoding,
                'schema': definition.text.decode(),
            }
        )

    @property
    def viewers(self) -> int:
        """Number of viewers that want anything."""
        return len(set().union(*self._wanting.values()))

    @property
    def wanted(self) -> set[str]:
        """Topics that anybody wants."""
        return {topic for topic, viewers in self._wanting.items() if viewers}

    def new_requests(self) -> list[SubscriptionRequest]:
        """Take the requests since the last call into account, and give them."""
        with self._lock:
            requests, self._requests = self._requests, []
        for wish in requests:
            viewers = self._wanting[wish.topic]
            (viewers.add if wish.wanted else viewers.discard)(wish.viewer)
        return requests

    def pass_on(self, topic: str, data: bytes, stamp: int) -> None:
        """Pass a serialized message on to all viewers that want its topic; ``stamp`` in ns."""
        with self._lock:
            wanting = [
                (viewer, number)
                for viewer in self._open
                for number, wanted in viewer.topics.items()
                if wanted == topic
            ]
        for viewer, number in wanting:
            viewer.waiting.append(DATA.pack(DATA_CODE, number, max(stamp, 0)) + data)
        self._wake([viewer for viewer, _ in wanting])

    def tell_time(self, stamp: int) -> None:
        """Tell viewers the time (ns)."""
        with self._lock:
            viewers = list(self._open)
        for viewer in viewers:
            viewer.time = TIME.pack(TIME_CODE, max(stamp, 0))
        self._wake(viewers)

    def close(self) -> None:
        """Let the viewers go, and stop listening."""
        with suppress(RuntimeError):  # the loop has ended already
            self._loop.call_soon_threadsafe(self._ended.set)
        self._thread.join(5.0)

    def _wake(self, viewers: list[_Viewer]) -> None:
        def wake() -> None:
            for viewer in viewers:
                viewer.ready.set()

        if viewers:
            with suppress(RuntimeError):
                self._loop.call_soon_threadsafe(wake)

    def _run(self, listener: socket.socket) -> None:
        try:
            self._loop.run_until_complete(self._serve(listener))
        finally:
            self._loop.close()

    async def _serve(self, listener: socket.socket) -> None:
        async with serve(
            self._attend,
            sock=listener,
            subprotocols=PROTOCOLS,
            process_request=self._check,
            compression=None,
            max_size=MESSAGE_BYTES.value,
            close_timeout=CLOSE_S,
        ):
            await self._ended.wait()

    def _check(self, connection: ServerConnection, request: Request) -> Response | None:
        """Refuse pages of the web, names of this machine that are not its own, and too many."""
        host, origin = request.headers.get('Host', ''), request.headers.get('Origin')
        reason = ''
        if not is_own_name(host, self._host):
            reason = f'Host {host}; expected an address or the name of this machine'
        elif origin is not None and origin not in self._origins and not is_own_origin(origin):
            reason = f'Origin {origin}; expected one of this machine or of the parameter origins'
        elif len(self._open) >= VIEWERS.value:
            reason = f'one viewer more; expected at most {VIEWERS}'
        if not reason:
            return None
        self.refused = one_line(reason, SENTENCE.value)
        return connection.respond(HTTPStatus.FORBIDDEN, f'{self.refused}\n')

    async def _attend(self, connection: ServerConnection) -> None:
        if connection.subprotocol is None:
            await connection.close(1002, f'expected the subprotocol {PROTOCOLS[0]}')
            return
        self._made += 1
        viewer = _Viewer(self._made, deque(maxlen=self._backlog))
        with self._lock:
            self._open.append(viewer)
        sending = None
        try:
            for said in self._greetings():
                await connection.send(json.dumps(said))
            sending = asyncio.create_task(viewer.send_to(connection))
            async for packet in connection:
                self._take(viewer, packet)
        except ConnectionClosed:
            pass
        finally:
            if sending is not None:
                sending.cancel()
            with self._lock:
                self._open.remove(viewer)
                for topic in set(viewer.topics.values()):
                    self._requests.append(SubscriptionRequest(viewer.number, topic, False))

    def _greetings(self) -> list[dict[str, object]]:
        capabilities = ['time'] if self._tells_time else []
        return [
            {'op': 'serverInfo', 'name': self._name, 'capabilities': capabilities},
            {'op': 'advertise', 'channels': self._channels},
        ]

    def _take(self, viewer: _Viewer, packet: str | bytes) -> None:
        """Note what a viewer wants; what it may not say, or what is nonsense, is left out."""
        try:
            said: Any = parse_json(packet.encode() if isinstance(packet, str) else b'null')
            wanted = [
                (wish['id'], self._channels[wish['channelId'] - 1]['topic'])
                for wish in said.get('subscriptions', ())
                if wish['channelId'] > 0 and 0 <= wish['id'] < 2**32
            ]
            unwanted = list(said.get('subscriptionIds', ()))
            operation = said.get('op')
        except (ValueError, LookupError, TypeError, AttributeError):
            return
        with self._lock:
            before = set(viewer.topics.values())
            for number, topic in wanted if operation == 'subscribe' else ():
                if len(viewer.topics) < SUBSCRIPTIONS.value:
                    viewer.topics[number] = str(topic)
            for number in unwanted if operation == 'unsubscribe' else ():
                if isinstance(number, int):
                    viewer.topics.pop(number, None)
            after = set(viewer.topics.values())
            self._requests += [
                SubscriptionRequest(viewer.number, topic, True) for topic in after - before
            ]
            self._requests += [
                SubscriptionRequest(viewer.number, topic, False) for topic in before - after
            ]
