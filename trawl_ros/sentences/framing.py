"""Frame of a sentence: start, checksum, tag block and IEC 61162-450 header.

NMEA 0183 has ``$``, AIS ``!``, Simrad and Rapp ``@``, Marelec ``#``. A tag block (NMEA 0183
version 4) and the header ``UdPbC`` of IEC 61162-450 may stand in front.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from pynmeagps.nmeahelpers import calc_checksum

STARTS = '$!@'
HASH = b'#'
HEADER = b'UdPbC\x00'
LONGEST_LINE = 1024
"""Bytes of a line; a sentence has 82 at most, tag blocks and a recorder's mark some more."""

_CHECKSUM = re.compile(r'\*([0-9A-Fa-f]{2})$')
_TAG_BLOCK = re.compile(r'\\([^\\]*)\*([0-9A-Fa-f]{2})\\')
_TAG_TIME = re.compile(r'(?:^|,)c:(\d{1,15})(?:,|$)')


class Unreadable(ValueError):
    """Line that gives no reading; the text is the reason, the same for all such lines."""


class Foreign(Unreadable):
    """Sentence that is whole, and of an address that no table has."""


@dataclass(frozen=True)
class Frame:
    """Frame of one sentence.

    Attributes
    ----------
    start
        ``$``, ``!``, ``@`` or ``#``.
    body
        Text between start and checksum.
    checked
        True if a checksum stood there, and was right.
    front
        Text before the sentence, such as a recorder's time; without tag block.
    tag_time
        UNIX time (ns) of its tag block; None without one.
    """

    start: str
    body: str
    checked: bool
    front: str = ''
    tag_time: int | None = None


def parse_line(line: bytes) -> Frame:
    """Find the sentence in a line.

    Parameters
    ----------
    line
        With or without its end. Where a sentence was cut short by the next one, the next counts.

    Raises
    ------
    Unreadable
        If there is none, or a checksum is wrong.
    """
    raw = line.strip(b' \t\r\n\x00').replace(HEADER, b'')
    if not raw.isascii():
        raise Unreadable('a line that is no text')
    text = raw.decode('ascii')
    tag_time = None
    tags = list(_TAG_BLOCK.finditer(text))
    if tags:
        content, checksum = tags[-1].groups()
        if calc_checksum(content) != checksum.upper():
            raise Unreadable('a tag block whose checksum is wrong')
        if said := _TAG_TIME.search(content):
            tag_time = _unix_ns(said[1])
        text = _TAG_BLOCK.sub('', text)
    at = max(text.rfind(start) for start in STARTS)
    if at < 0:
        if not raw.startswith(HASH):
            raise Unreadable('a line without a sentence ($…)')
        at = 0
    front, start, rest = text[:at], text[at], text[at + 1 :]
    found = _CHECKSUM.search(rest)
    if found is None:
        return Frame(start, rest, False, front, tag_time)
    body = rest[: found.start()]
    if calc_checksum(body) != found[1].upper():
        raise Unreadable('a sentence whose checksum is wrong')
    return Frame(start, body, True, front, tag_time)


def framed(start: str, body: str, *, checksum: bool) -> str:
    """Give a sentence as it goes over the line, without its end."""
    return f'{start}{body}*{calc_checksum(body)}' if checksum else f'{start}{body}'


def tag_block(stamp: int) -> str:
    """Give the tag block that says a UNIX time (ns), in milliseconds of thirteen digits."""
    content = f'c:{stamp // 1_000_000:013d}'
    return f'\\{content}*{calc_checksum(content)}\\'


def _unix_ns(digits: str) -> int:
    """Convert UNIX time in seconds or, with more than ten digits, in milliseconds."""
    return int(digits) * (1_000_000 if len(digits) > 10 else 1_000_000_000)


class LineSplitter:
    """Splitter of a stream of bytes into lines, in bounded memory.

    Attributes
    ----------
    too_long
        Lines that had more than `LONGEST_LINE` bytes, and were left out.
    """

    def __init__(self) -> None:
        self.too_long = 0
        self._rest = b''
        self._skipping = False

    def feed(self, data: bytes) -> Iterator[bytes]:
        """Yield the lines that are whole after these bytes came."""
        *lines, rest = (self._rest + data).replace(b'\r', b'\n').split(b'\n')
        for line in lines:
            if self._skipping:
                self._skipping = False
            elif len(line) > LONGEST_LINE:
                self.too_long += 1
            elif line:
                yield line
        if len(rest) > LONGEST_LINE:
            self.too_long += not self._skipping
            self._skipping = True
            rest = b''
        self._rest = b'' if self._skipping else rest

    def datagram(self, data: bytes) -> Iterator[bytes]:
        """Yield the lines of a datagram, whose last one may lack its end."""
        yield from self.feed(data + b'\n')
