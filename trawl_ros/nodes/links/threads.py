# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Threads of a node that keep links open: lines in, sentences out, in bounded memory."""

import time
from abc import ABC, abstractmethod
from collections import deque
from threading import Event, Lock, Thread
from typing import NamedTuple

from trawl_ros.core.foreign import short
from trawl_ros.nodes.links.channels import MOST_CLIENTS, Channel, LinkAddress, open_channel
from trawl_ros.sentences.framing import SentenceSplitter

WAITING_LINES = 5000
"""Lines that wait at most, in or out; older ones are given up and counted."""

POLL_S = 0.1
RETRY_S = 1.0


class Line(NamedTuple):
    """Line of a link, or a sentence for it; sender is the host it came from, where known."""

    text: bytes
    sender: str = ''


class LinkThread(ABC):
    """Thread that opens a link, and again whenever it is lost.

    Attributes
    ----------
    address : LinkAddress
        Of the link.
    state : str
        Empty while it is open, else why it is not.
    opened : int
        Times that it was opened.
    lines, lost : int
        Lines that came or went, and those given up.
    """

    LISTENS = True

    def __init__(self, address: LinkAddress) -> None:
        self.address = address
        self.state = 'not open yet'
        self.opened = 0
        self.lines = 0
        self.lost = 0
        self._channel: Channel | None = None
        self._lock = Lock()
        self._waiting: deque[Line] = deque()
        self._stop = Event()
        self._thread = Thread(target=self._run, name=address.text, daemon=True)
        self._thread.start()

    @property
    def turned_away(self) -> str:
        """Sentence on clients that found all places of a server taken; empty without any."""
        number = 0 if self._channel is None else self._channel.turned_away
        return f'{number} clients too many, expected at most {MOST_CLIENTS}' if number else ''

    def close(self) -> None:
        """End the thread, and wait until it has."""
        self._stop.set()
        self._thread.join(5.0)

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                channel = open_channel(self.address, listens=self.LISTENS)
            except OSError as reason:
                self.state = short(reason)
                self._stop.wait(RETRY_S)
                continue
            self.state = ''
            self.opened += 1
            try:
                self._channel = channel
                self._work(channel)
            except OSError as reason:
                self.state = short(reason)
            finally:
                channel.close()
            self._stop.wait(0.0 if self._stop.is_set() else RETRY_S)

    @abstractmethod
    def _work(self, channel: Channel) -> None:
        """Use an open link until it is lost or the thread is to end."""

    def _put(self, line: Line) -> None:
        with self._lock:
            self._waiting.append(line)
            if len(self._waiting) > WAITING_LINES:
                self._waiting.popleft()
                self.lost += 1

    def _take(self, most: int) -> list[Line]:
        with self._lock:
            count = min(most, len(self._waiting))
            return [self._waiting.popleft() for _ in range(count)]


class LineSource(LinkThread):
    """Source of lines from a link.

    ``too_long`` counts lines that were longer than any sentence.
    """

    def __init__(self, address: LinkAddress) -> None:
        self.too_long = 0
        super().__init__(address)

    def take(self, most: int) -> list[Line]:
        """Take the lines that wait, the oldest first."""
        return self._take(most)

    def _work(self, channel: Channel) -> None:
        splitters: dict[int, SentenceSplitter] = {}
        while not self._stop.is_set():
            for source, data, sender in channel.poll(POLL_S):
                splitter = splitters.setdefault(source, SentenceSplitter())
                before = splitter.too_long
                feed = splitter.datagram if channel.datagrams else splitter.feed
                for line in feed(data):
                    self.lines += 1
                    self._put(Line(line, sender))
                self.too_long += splitter.too_long - before
                if not data:
                    del splitters[source]


class SentenceSink(LinkThread):
    """Sink of sentences to a link; those that nobody takes are given up."""

    LISTENS = False

    def put(self, text: bytes) -> None:
        """Hand a sentence over, with its end."""
        self._put(Line(text))

    def _work(self, channel: Channel) -> None:
        while not self._stop.is_set():
            # Bytes that come back are thrown away: a pseudo-terminal would fill.
            if not channel.datagrams:
                channel.poll(0.0)
            texts = [line.text for line in self._take(100)]
            if not texts:
                time.sleep(0.01)
            for text in texts:
                if self._stop.is_set():
                    break
                if channel.send(text):
                    self.lines += 1
                else:
                    self.lost += 1
