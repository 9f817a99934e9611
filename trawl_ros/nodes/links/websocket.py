"""WebSocket server for viewers by Foxglove's protocol, kept by the threads of its library."""

from collections import defaultdict
from dataclasses import dataclass
from threading import Lock
from typing import Any

from foxglove import Channel, Context, Schema, start_server
from foxglove.websocket import Capability, ServerListener

from trawl_ros.bags.storage.stored import describe
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.foreign import short


@dataclass(frozen=True)
class Wish:
    """Wish of a viewer: a topic, and whether it is wanted from now on or no longer."""

    viewer: int
    topic: str
    wanted: bool


class _Wishes(ServerListener):
    """Listener that notes who wants what; the library's threads call it."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._waiting: list[Wish] = []

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """Note that a viewer wants a topic."""
        self._note(Wish(client.id, channel.topic, True))

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """Note that a viewer, also one that has gone, wants a topic no more."""
        self._note(Wish(client.id, channel.topic, False))

    def take(self) -> list[Wish]:
        """Take the wishes since the last call, in their order."""
        with self._lock:
            waiting, self._waiting = self._waiting, []
        return waiting

    def _note(self, wish: Wish) -> None:
        with self._lock:
            self._waiting.append(wish)


class ViewerServer:
    """Server that viewers connect to, Foxglove or Lichtblick.

    Messages are passed on as they are. For each viewer a bounded number of them waits, and the
    oldest are given up by the library: nobody is held up by a slow one. Viewers may not publish,
    call services or set parameters.

    Parameters
    ----------
    host, port
        Address of this machine that it listens at.
    name
        By which viewers show it.
    backlog
        Messages that wait at most for each viewer.
    tells_time
        True if viewers are to go by the time that `tell_time` gives.

    Raises
    ------
    TrawlError
        If it cannot listen there.
    """

    def __init__(self, host: str, port: int, name: str, backlog: int, *, tells_time: bool) -> None:
        self._context = Context()
        self._wishes = _Wishes()
        self._channels: dict[str, Channel] = {}
        self._viewers: dict[str, set[int]] = defaultdict(set)
        try:
            self._server = start_server(
                name=name,
                host=host,
                port=port,
                capabilities=[Capability.Time] if tells_time else [],
                server_listener=self._wishes,
                context=self._context,
                message_backlog_size=backlog,
            )
        # The library's own error is one of these.
        except RuntimeError as reason:
            raise TrawlError(
                f'parameters host and port: {host}:{port} cannot be listened to '
                f'({short(reason)}); expected an address of this machine with a free port'
            ) from None

    def offer(self, topic: str, type_name: str) -> None:
        """Advertise a topic with the definition of its type."""
        definition = describe(type_name, '')
        self._channels[topic] = Channel(
            topic,
            message_encoding=definition.message_encoding,
            schema=Schema(
                name=type_name, encoding=definition.schema_encoding, data=definition.text
            ),
            context=self._context,
        )

    @property
    def viewers(self) -> int:
        """Number of viewers that want anything."""
        return len(set().union(*self._viewers.values()))

    @property
    def wanted(self) -> set[str]:
        """Topics that anybody wants."""
        return {topic for topic, viewers in self._viewers.items() if viewers}

    def new_wishes(self) -> list[Wish]:
        """Take the wishes since the last call into account, and give them."""
        wishes = self._wishes.take()
        for wish in wishes:
            viewers = self._viewers[wish.topic]
            (viewers.add if wish.wanted else viewers.discard)(wish.viewer)
        return wishes

    def pass_on(self, topic: str, data: bytes, stamp: int) -> None:
        """Pass a serialized message on to all viewers that want its topic; ``stamp`` in ns."""
        self._channels[topic].log(data, log_time=max(stamp, 0))

    def tell_time(self, stamp: int) -> None:
        """Tell viewers the time (ns)."""
        self._server.broadcast_time(max(stamp, 0))

    def close(self) -> None:
        """Let the viewers go, and stop listening."""
        self._server.stop()
