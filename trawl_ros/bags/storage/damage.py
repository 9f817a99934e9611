# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Damaged MCAP file: what can be read of one that was cut short or is wrong in places.

After a break in the chain of records, the next chunk is searched byte by byte. Its header is known
by lengths that agree with each other, and its content is used only if its checksum is right. A
chunk that occurs twice counts once. The description of a topic that was lost is replaced by one
from a damaged part, if metadata and messages confirm it.
"""

import hashlib
import io
import re
import struct
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import BinaryIO

import lz4.frame
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Schema
from mcap.writer import MCAP0_MAGIC

from trawl_ros.bags.storage.chunk_index import Piece
from trawl_ros.bags.storage.chunks import (
    DAMAGE,
    MAX_CHUNK_BYTES,
    RECORD_START,
    parse_records,
    unpacker,
)
from trawl_ros.bags.storage.decoding import BagTypes
from trawl_ros.bags.storage.stored import Definition, Description, channel_definition, describe
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.limits import RECOVERED_CHANNELS, RECOVERED_RECORDS
from trawl_ros.messages.cdr import STORE
from trawl_ros.records.topics import find_topic

_FIRST_PRIVATE_OPCODE = 0x80
_SEARCHED_BYTES = 1 << 20
"""Size of the part of a file that is searched at once."""

# Opcode, length, two times, size, checksum, compression, length of the compressed records.
# Lengths stay below 4 GB, so their upper halves are zero.
_CHUNK_HEADER = re.compile(
    rb'\x06(.{4})\0{4}.{16}.{4}\0{4}.{4}(\x04\0{3}zstd|\x03\0{3}lz4|\0{4})(.{4})\0{4}', re.DOTALL
)
_LONGEST_HEADER_BYTES = 57
_FIXED_HEADER_BYTES = 28
"""Bytes of a chunk after its length and before the name of its compression."""

_INDEX_HEAD = struct.Struct('<HI')
"""Channel of a message index, and the number of bytes of its entries."""

# Opcode, length, one or two numbers, and a length before a type's or topic's name.
_DESCRIPTION = re.compile(
    rb'(?=(\x03(.{4})\0{4}.{2}.{3}\0[A-Za-z]|\x04(.{4})\0{4}.{4}.{3}\0/))', re.DOTALL
)
_MAX_DESCRIPTION_BYTES = 1 << 20
_TAIL_BYTES = 16 << 20
"""Size of the end of a file that is searched for descriptions, for the summary repeats them."""

_SALVAGE_STEP_BYTES = 1 << 10
"""Number of bytes that are unpacked at once from a damaged chunk: the last step is lost."""

_SAMPLES = 16
"""Number of messages that identify a channel."""

_SAMPLE_BYTES = 1 << 22
"""Number of bytes of such messages after which no more are used."""


def scan_records(
    stream: BinaryIO, size: int, report: Callable[[str, int], None]
) -> Iterator[tuple[int, int, int]]:
    """Yield opcode, offset and length of each record, up to and with the end of data.

    Parameters
    ----------
    stream
        The file; it is moved about in.
    size
        Its length in bytes.
    report
        Takes a sentence, without the file's name, for each stretch that is skipped, and how
        many bytes that is.
    """
    offset = len(MCAP0_MAGIC)
    while offset + RECORD_START.size <= size:
        stream.seek(offset)
        opcode, inner = RECORD_START.unpack(stream.read(RECORD_START.size))
        length = RECORD_START.size + inner
        known = 0 < opcode <= Opcode.DATA_END or opcode >= _FIRST_PRIVATE_OPCODE
        if known and offset + length <= size and _fits(stream, opcode, offset, inner):
            yield opcode, offset, length
            if opcode == Opcode.DATA_END:
                return
            offset += length
            continue
        following = next_chunk(stream, offset + 1, size)
        if following is None:
            break
        gap = following - offset
        report(f'damaged at byte {offset}; {gap} bytes were skipped', gap)
        offset = following
    rest = size - offset
    report(
        f'cut short or damaged at byte {offset}; the data before it are used'
        + (f', {rest} bytes behind are not' if rest > 0 else ''),
        max(rest, 0),
    )


def next_chunk(stream: BinaryIO, offset: int, size: int) -> int | None:
    """Find the next offset at which a chunk's header starts; None if there is none."""
    while offset < size:
        stream.seek(offset)
        window = stream.read(_SEARCHED_BYTES)
        place = 0
        while header := _CHUNK_HEADER.search(window, place):
            start = offset + header.start()
            inner = int.from_bytes(header[1], 'little')
            if start + RECORD_START.size + inner <= size and _chunk_fits(header, inner):
                return start
            place = header.start() + 1
        # Windows overlap, so that a header across two of them is found too.
        offset += _SEARCHED_BYTES - _LONGEST_HEADER_BYTES
    return None


def _fits(stream: BinaryIO, opcode: int, offset: int, inner: int) -> bool:
    """True if a record's length agrees with the lengths of its own parts."""
    if opcode == Opcode.CHUNK:
        stream.seek(offset)
        header = _CHUNK_HEADER.match(stream.read(_LONGEST_HEADER_BYTES))
        # A chunk that is too large is passed here; whoever opens it reports it.
        return inner > MAX_CHUNK_BYTES or (header is not None and _chunk_fits(header, inner))
    if opcode == Opcode.MESSAGE_INDEX:
        head = stream.read(_INDEX_HEAD.size)
        return (
            len(head) == _INDEX_HEAD.size
            and inner == _INDEX_HEAD.size + _INDEX_HEAD.unpack(head)[1]
        )
    return True


def _chunk_fits(header: re.Match[bytes], inner: int) -> bool:
    records = int.from_bytes(header[3], 'little')
    return inner == _FIXED_HEADER_BYTES + len(header[2]) + 8 + records


def find_copies(stream: BinaryIO, pieces: Iterable[Piece]) -> dict[Piece, Piece]:
    """Find chunks equal to an earlier one byte for byte.

    A recorder never writes two: the same messages would have come at the same nanoseconds.

    Returns
    -------
    dict
        The first by each copy of it.
    """
    alike: defaultdict[tuple[int, int], list[Piece]] = defaultdict(list)
    for piece in pieces:
        alike[piece.start, piece.length].append(piece)
    copies = {}
    for group in alike.values():
        first: dict[bytes, Piece] = {}
        for piece in sorted(group) if len(group) > 1 else ():
            stream.seek(piece.offset)
            if stream.read(1) != bytes([Opcode.CHUNK]):
                continue
            stream.seek(piece.offset)
            digest = hashlib.sha256(stream.read(piece.length)).digest()
            if first.setdefault(digest, piece) != piece:
                copies[piece] = first[digest]
    return copies


@dataclass(frozen=True)
class Recovered:
    """Topic of a channel, the definition of its messages, and what confirms them."""

    topic: str
    definition: Definition
    witness: str


def recover(
    samples: Mapping[int, Sequence[bytes]],
    remains: Iterable[Description],
    taken: Iterable[str],
    stated: Mapping[str, Definition] | None,
) -> dict[int, Recovered]:
    """Find out what channels are whose descriptions were lost, by those left in damaged parts.

    Parameters
    ----------
    samples
        Messages of these channels.
    remains
        Schemas and channels from damaged parts, and those that are known.
    taken
        Topics of the channels that are described.
    stated
        Topics by ``metadata.yaml``; without it, the project's table of topics confirms.

    Returns
    -------
    dict
        Topic by channel; left out are those that nothing confirms, or two would be.
    """
    types = BagTypes()
    schemas: defaultdict[str, list[Schema]] = defaultdict(list)
    claims: defaultdict[str, dict[int, Channel]] = defaultdict(dict)
    for record in remains:
        if isinstance(record, Channel):
            claims[record.topic][record.id] = record
        else:
            schemas[record.name].append(record)
    for topic in taken:
        claims.pop(topic, None)
    found: defaultdict[int, list[Recovered]] = defaultdict(list)
    for channels in claims.values():
        # With two numbers for one topic, one of them may be damaged.
        if len(channels) > 1:
            continue
        ((number, channel),) = channels.items()
        confirmed = _confirmed(channel, schemas, stated, types)
        if confirmed and _all_decode(types, confirmed.definition, samples.get(number, ())):
            found[number].append(confirmed)
    return {number: one[0] for number, one in found.items() if len(one) == 1}


def _confirmed(
    channel: Channel,
    schemas: Mapping[str, Sequence[Schema]],
    stated: Mapping[str, Definition] | None,
    types: BagTypes,
) -> Recovered | None:
    """Return what metadata, or the project's topic table, state of a channel's topic, or None."""
    topic = channel.topic
    if stated is not None:
        if topic not in stated:
            return None
        said, witness = stated[topic], 'metadata.yaml'
    else:
        known = find_topic(topic)
        if known is None:
            return None
        said, witness = Definition(known.type, 'cdr', '', b''), "the project's table of topics"
    said = replace(said, qos=said.qos or channel_definition(channel, None).qos)
    if said.type in STORE.types:
        ours = describe(said.type, said.qos)
        if said.type_hash in ('', ours.type_hash):
            return Recovered(topic, ours, witness)
    for schema in schemas.get(said.type, ()):
        whole = replace(said, schema_encoding=schema.encoding, text=schema.data)
        try:
            own_hash = types.store(topic, whole).hash_rihs01(whole.type)
        except BagError:
            continue
        if own_hash == whole.type_hash:
            return Recovered(topic, whole, witness)
    return None


def _all_decode(types: BagTypes, definition: Definition, messages: Sequence[bytes]) -> bool:
    try:
        decode = types.decoder('', definition)
        for data in messages:
            decode(data)
    except (BagError, MessageError):
        return False
    return bool(messages)


def sample_messages(
    chunks: Iterable[Sequence[object]], numbers: Iterable[int]
) -> dict[int, list[bytes]]:
    """Return some messages of channels, out of all chunks."""
    samples: dict[int, list[bytes]] = {
        number: [] for number in islice(numbers, RECOVERED_CHANNELS.value)
    }
    for records in chunks:
        for record in records:
            some = samples.get(record.channel_id) if isinstance(record, Message) else None
            if not isinstance(record, Message) or some is None or len(some) == _SAMPLES:
                continue
            if sum(map(len, some)) < _SAMPLE_BYTES:
                some.append(record.data)
    return samples


def read_remains(stream: BinaryIO, damaged: Mapping[int, int], size: int) -> list[Description]:
    """Find schemas and channels in damaged chunks, and behind the last of all records.

    Parameters
    ----------
    stream
        The file; it is moved about in.
    damaged
        Lengths of the damaged chunks by their offsets.
    size
        Length of the file, bytes.

    Returns
    -------
    list
        Each of those that are equal once, and `RECOVERED_RECORDS` at most.
    """
    descriptions: list[Description] = []
    seen: set[bytes] = set()
    places = [(max(0, size - _TAIL_BYTES), _TAIL_BYTES), *damaged.items()]
    for offset, length in places:
        stream.seek(offset)
        data = stream.read(min(length, MAX_CHUNK_BYTES))
        for record in find_descriptions(salvage(data) if offset in damaged else data, seen):
            descriptions.append(record)
            if len(descriptions) == RECOVERED_RECORDS.value:
                return descriptions
    return descriptions


def find_descriptions(data: bytes, seen: set[bytes]) -> Iterator[Description]:
    """Find schemas and channels among damaged bytes, each record on its own.

    No checksum covers them, so the caller must verify them. ``seen`` are the bytes of records found
    before, which are not returned again.
    """
    for place in _DESCRIPTION.finditer(data):
        length = RECORD_START.size + int.from_bytes(place[2] or place[3], 'little')
        raw = data[place.start() : place.start() + length]
        if length > _MAX_DESCRIPTION_BYTES or len(raw) < length or raw in seen:
            continue
        builder = RecordBuilder()
        try:
            record = next(parse_records(raw))
            if not isinstance(record, Description):
                continue
            record.write(builder)
        except DAMAGE:
            continue
        # All lengths within fit the record's.
        if builder.end() == raw:  # type: ignore[no-untyped-call]  # of mcap
            seen.add(raw)
            yield record


def salvage(record: bytes) -> bytes:
    """Unpack a damaged chunk as far as possible; any part of the result may be wrong."""
    pieces: list[bytes] = []
    try:
        chunk = next(parse_records(record))
        if not isinstance(chunk, Chunk):
            return b''
        if chunk.compression == '':
            return chunk.data
        unpack = (
            lz4.frame.open(io.BytesIO(chunk.data))
            if chunk.compression == 'lz4'
            else unpacker(chunk.data)
        )
        left = min(chunk.uncompressed_size, MAX_CHUNK_BYTES)
        while left > 0 and (piece := unpack.read(min(left, _SALVAGE_STEP_BYTES))):
            pieces.append(piece)
            left -= len(piece)
    except (*DAMAGE, EOFError):
        pass
    return b''.join(pieces)
