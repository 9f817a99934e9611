# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
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
"""Longest line, bytes: a sentence has at most 82, tag blocks and a recorder's mark add some."""

LONGEST_FRONT = 256
"""Characters ahead of a sentence that are searched for a recorder's time or a tag block."""

NO_TEXT = 'a line that is not text'
CUT_SHORT = 'a sentence that was cut short by the next one'

_START = re.compile(r'[$!@](?=[A-Z][A-Z0-9]{2,9},)')
_CHECKSUM = re.compile(r'\*([0-9A-Fa-f]{2})(?![0-9A-Za-z])')
_TAG_BLOCK = re.compile(r'\\([^\\]*)\*([0-9A-Fa-f]{2})\\')
_TAG_TIME = re.compile(r'(?:^|,)c:(\d{1,15})(?:,|$)')


class Unreadable(ValueError):
    """Line without a reading; the text is the reason, the same for all lines of that kind."""


class Foreign(Unreadable):
    """Complete sentence whose address is in no table."""


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
    tag_time, tag_text
        UNIX time (ns) of its tag block, and the same as it stands there; None and '' without one.
    """

    start: str
    body: str
    checked: bool
    front: str = ''
    tag_time: int | None = None
    tag_text: str = ''


def parse_line(line: bytes) -> Frame:
    """Find the sentence in a line.

    Parameters
    ----------
    line
        With or without its end. Where a sentence was cut short by the next one, the next counts.
        Noise and a recorder's mark may stand in front, quotes and marks behind a checksum.

    Raises
    ------
    Unreadable
        If there is none, it was cut short, or a checksum is wrong.
    """
    raw = line.replace(b'\x00', b'').replace(HEADER[:-1], b'').strip(b' \t\r\n')
    text = raw.decode('latin-1')
    tag_time, tag_text = None, ''
    tags = list(_TAG_BLOCK.finditer(text))
    if tags:
        content, checksum = tags[-1].groups()
        if calc_checksum(content) != checksum.upper():
            raise Unreadable('a tag block whose checksum is wrong')
        if said := _TAG_TIME.search(content):
            tag_time, tag_text = _unix_ns(said[1]), said[1]
        text = _TAG_BLOCK.sub('', text)
    begins = [found.start() for found in _starts(text)]
    at = begins[-1] if begins else max(text.rfind(start) for start in STARTS)
    if at < 0:
        if not raw.startswith(HASH):
            raise Unreadable('a line without a sentence ($…)' if raw.isascii() else NO_TEXT)
        at = 0
    front, start, rest = text[:at], text[at], text[at + 1 :]
    found = _CHECKSUM.search(rest)
    if not rest[: found.end() if found else None].isascii():
        raise Unreadable(NO_TEXT)
    if found is None:
        if rest.endswith(tuple(STARTS)):
            raise Unreadable(CUT_SHORT)
        # A cell of a table ends with the quotes it began with.
        rest = rest.partition('"')[0] if front.endswith('"') else rest
        return Frame(start, rest, False, front, tag_time, tag_text)
    body = rest[: found.start()]
    if calc_checksum(body) != found[1].upper():
        raise Unreadable('a sentence whose checksum is wrong')
    return Frame(start, body, True, front, tag_time, tag_text)


def _starts(text: str) -> list[re.Match[str]]:
    """Yield where sentences start; inside AIS sentences ``@`` is an ordinary letter."""
    found: list[re.Match[str]] = []
    for start in _START.finditer(text):
        last = found[-1] if found else None
        near = last and last[0] == '!' and start.start() - last.end() < LONGEST_LINE
        if start[0] == '@' and last and near and not _ended(text, last, start):
            continue
        found.append(start)
    return found


def _ended(text: str, sentence: re.Match[str], following: re.Match[str]) -> re.Match[str] | None:
    """Return the checksum between the start of a sentence and that of the following one."""
    return _CHECKSUM.search(text, sentence.end(), following.start())


def split_sentences(line: bytes) -> list[bytes]:
    """Split a line with several sentences into one piece per sentence.

    A recorder's time or a tag block ahead of a sentence belongs to it, and to the following
    sentences that have none of their own. A sentence that was cut short by the next one ends with
    the start of that one, so that `parse_line` detects it.
    """
    if sum(map(line.count, (b'$', b'!', b'@'))) < 2:
        return [line]
    text = line.decode('latin-1')
    starts = _starts(text)
    if len(starts) < 2:
        return [line]
    pieces: list[str] = []
    front = text[: starts[0].start()][-LONGEST_FRONT:]
    for start, following in zip(starts, [*starts[1:], None], strict=True):
        end = following.start() if following else len(text)
        checksum = _ended(text, start, following) if following else None
        body = text[start.start() : checksum.end() if checksum else end]
        if following and not checksum and body[-1] not in ' \t;|':
            body += following[0]
        pieces.append(front + body)
        own = text[checksum.end() : end] if checksum else ''
        front = own[-LONGEST_FRONT:] if own.strip(' \t,;|"') else front
    return [piece.encode('latin-1') for piece in pieces]


def framed(start: str, body: str, *, checksum: bool) -> str:
    """Return a sentence as sent on the line, without its end."""
    return f'{start}{body}*{calc_checksum(body)}' if checksum else f'{start}{body}'


def tag_block(stamp: int) -> str:
    """Return the tag block of a UNIX time (ns), in milliseconds of thirteen digits."""
    content = f'c:{stamp // 1_000_000:013d}'
    return f'\\{content}*{calc_checksum(content)}\\'


def _unix_ns(digits: str) -> int:
    """Convert a UNIX time in seconds or, if it has more than ten digits, in milliseconds."""
    return int(digits) * (1_000_000 if len(digits) > 10 else 1_000_000_000)


class SentenceSplitter:
    """Splitter of a stream of bytes into sentences, in bounded memory.

    It is the same for files and links: lines end in CR, LF or both; several sentences stand on
    one line or in one datagram; text is of 8 or 16 bits; blocks of NULs, as a loss of power leaves
    them, mean nothing.

    Attributes
    ----------
    line
        Number of the line that was read last.
    too_long
        Pieces of more than `LONGEST_LINE` bytes without a sentence, which were left out.
    """

    def __init__(self) -> None:
        self.line = 0
        self.too_long = 0
        self._rest = b''
        self._skipping = False
        self._after_cr = False

    def feed(self, data: bytes) -> Iterator[bytes]:
        """Yield the results of `parse_line` for the sentences that these bytes complete."""
        # A text of 16 bits, too, is one of 8 without its NULs.
        data = data.replace(b'\x00', b'')
        if not data:
            return
        if self._after_cr and data.startswith(b'\n'):
            data = data[1:]
        self._after_cr = data.endswith(b'\r')
        data = data.replace(b'\r\n', b'\n').replace(b'\r', b'\n')
        if not self.line and not self._rest:
            data = data.removeprefix(b'\xff\xfe').removeprefix(b'\xfe\xff')
            data = data.removeprefix(b'\xef\xbb\xbf')
        *lines, rest = (self._rest + data).split(b'\n')
        self._rest = b''
        for line in lines:
            self.line += 1
            yield from self._bounded(line, ends=True)
            self._skipping = False
        yield from self._bounded(rest, ends=False)

    def datagram(self, data: bytes) -> Iterator[bytes]:
        """Yield the sentences of a datagram; the last one may lack its end."""
        yield from self.feed(data + b'\n')

    def end(self) -> Iterator[bytes]:
        """Yield the last sentence of a file, which may lack its end."""
        if self._rest:
            yield from self.feed(b'\n')

    def _bounded(self, line: bytes, *, ends: bool) -> Iterator[bytes]:
        """Yield the pieces of a line; keep the last piece of a line that has not ended."""
        if not ends and len(line) <= LONGEST_LINE and not self._skipping:
            self._rest = line
            return
        pieces = split_sentences(line) if line.strip() else []
        if self._skipping and pieces:
            # The piece that is too long ends at the next start.
            at = _START.search(pieces[0].decode('latin-1'))
            pieces[0] = pieces[0][at.start() :] if at else b''
        for number, piece in enumerate(pieces):
            last = not ends and number == len(pieces) - 1
            if len(piece) > LONGEST_LINE:
                self.too_long += not self._skipping
                self._skipping = True
            elif last:
                self._rest = piece
                self._skipping = self._skipping and not piece
            elif piece:
                self._skipping = False
                yield piece
