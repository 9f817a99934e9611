# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Repair of a bag that was cut short or damaged, or whose metadata are missing or wrong.

The damaged bag is only read. Everything that passes its checksum goes into the new bag, with new
indexes and metadata. Messages that are known to be missing are counted.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from trawl_ros.bags.sources import check_topics, no_bag, refuse_missing
from trawl_ros.bags.storage.chunks import Allowance
from trawl_ros.bags.storage.decoding import BagTypes, Decoder
from trawl_ros.bags.storage.mcap_file import McapFile
from trawl_ros.bags.storage.metadata import FILE_NAME, BagMetadata, load_metadata
from trawl_ros.bags.storage.metadata_faults import metadata_faults
from trawl_ros.bags.storage.packed import PackedMessages
from trawl_ros.bags.storage.stored import Definition, RawMessage
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.files import new_folder, written_folder
from trawl_ros.core.foreign import reading
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.time import SECOND

SUFFIX = '_repaired'

_NUMBERED = re.compile(r'(?P<stem>.*)_(?P<number>\d+)')


@dataclass(frozen=True)
class Repair:
    """Result of a repair.

    ``out`` is None if the bag was sound and nothing was written. ``saved`` and ``lost`` give
    messages by full topic name; ``lost`` are those that metadata or indexes had counted. ``unread``
    is true if bytes were skipped that may have held more. ``problems`` has a sentence for each
    fault.
    """

    path: Path
    out: Path | None
    saved: Mapping[str, int]
    lost: Mapping[str, int]
    unread: bool
    problems: tuple[str, ...]

    @property
    def whole(self) -> bool:
        """True if nothing of the files' content can have been lost."""
        return not self.lost and not self.unread


def repair_bag(
    path: Path,
    out: Path | None = None,
    *,
    on_progress: OnProgress = ignore,
) -> Repair:
    """Write all readable messages of a bag of MCAP files into a new one, file for file.

    Parameters
    ----------
    path
        The bag's folder, or one MCAP file. It is left as it is.
    out
        Folder to be made; by default next to the bag, with `SUFFIX` behind its name.
    on_progress
        Called after each message, with the recorded time (s) of its file that is done.

    Returns
    -------
    Repair
        With ``out``, messages ``saved`` and ``lost`` by topic, and the ``problems`` found.

    Raises
    ------
    BagError
        If there is no bag of MCAP files, nothing of it can be saved, or the new one cannot be
        written.

    Examples
    --------
    >>> from pathlib import Path
    >>> import trawl_ros
    >>> bag = trawl_ros.tow('tow.yaml', 'cut_short')
    >>> (bag.path / 'metadata.yaml').unlink()
    >>> repair = trawl_ros.repair_bag(bag.path, Path('repaired'))
    >>> repair.whole, repair.saved['/trawl/door/spread']
    (True, 2)
    """
    with reading(path, BagError):
        damaged = _Damaged(path)
    place = path.resolve()
    target = out or place.parent / f'{place.stem if place.is_file() else place.name}{SUFFIX}'
    if damaged.is_sound():
        return Repair(path, None, damaged.read, {}, False, ())
    new_folder(target, BagError)
    with written_folder(target, BagError) as draft, ExitStack() as stack:
        bag: BagWriter | None = None
        for number, file in enumerate(damaged.files):
            begun = False
            for definition, stored in damaged.messages(file, on_progress):
                if bag is None:
                    bag = stack.enter_context(BagWriter(draft, custom_data=damaged.custom_data))
                elif number and not begun:
                    bag.split()
                begun = True
                if not bag.declared(stored.topic):
                    bag.declare(stored.topic, definition)
                bag.write(
                    stored.topic, stored.type, stored.data, stored.log_time, stored.publish_time
                )
        if bag is None:
            raise BagError(
                f'{path}: nothing can be saved ({"; ".join(damaged.problems) or "no message"})'
            )
        saved = bag.counts
    lost = damaged.lost(saved)
    return Repair(path, target, saved, lost, damaged.unread, tuple(damaged.problems))


class _Damaged:
    """Damaged bag, and its faults."""

    def __init__(self, path: Path) -> None:
        refuse_missing(path)
        self.path = path
        self.problems: list[str] = []
        self.read: Counter[str] = Counter()
        self._unusable: dict[Path, Counter[str]] = {}
        """Messages that are none of their type, by file and topic."""
        self._types: dict[str, Definition] = {}
        self._decoders: dict[str, Decoder | None] = {}
        self._bag_types = BagTypes()
        self._metadata = self._load_metadata() if path.is_dir() else None
        self._check_kind()
        self.files = [file for name in self._names() if (file := self._open(name))]
        check_topics(path, set[tuple[str, str]]().union(*(file.types() for file in self.files)))
        if not self.files:
            why = '; '.join(self.problems)
            raise BagError(why or f'{path}: no MCAP file that can be read; expected at least one')

    @property
    def custom_data(self) -> dict[str, str]:
        """Custom data of the metadata: text by key."""
        return dict((self._metadata and self._metadata.custom_data) or {})

    @property
    def unread(self) -> bool:
        """True if bytes were skipped; complete once all was read."""
        return any(file.passed_bytes or file.damaged_chunks for file in self.files)

    def is_sound(self) -> bool:
        """True if the bag has no fault; all of it is read for this."""
        indexed = all(file.complete and file.indexed for file in self.files)
        if self._metadata is None or self.problems or not indexed:
            return False
        times: list[int] = []
        for file in self.files:
            for _, stored in self.messages(file):
                self.read[stored.topic] += 1
                time = stored.log_time
                times = [min(times[0], time), max(times[1], time)] if times else [time, time]
        span = (times[0], times[1]) if times else None
        for fault in metadata_faults(self.path, self._metadata, ('mcap',), self.read, span):
            self._report(fault)
        return not self.problems

    def messages(
        self, file: McapFile, on_progress: OnProgress = ignore
    ) -> Iterator[tuple[Definition, RawMessage]]:
        """Yield the readable messages of a file, each with the definition of its topic."""
        definitions = file.definitions
        stated = self._metadata.offered() if self._metadata else {}
        left_out: Counter[str] = Counter()
        begin: int | None = None
        packed = PackedMessages()
        unusable = self._unusable[file.path] = Counter[str]()
        allowed = Allowance(file.path, file.path.stat().st_size)
        for stored in packed.unpack(file.messages(), allowed):
            topic, time = stored.topic, stored.log_time
            definition = self._types.setdefault(topic, definitions[topic])
            if not stored.type or stored.type != definition.type:
                left_out[topic] += 1
                continue
            if not definition.qos and stated.get(topic):
                definition = self._types[topic] = replace(definition, qos=stated[topic])
            if not self._decodes(stored, definition):
                unusable[topic] += 1
                continue
            begin = time if begin is None else begin
            on_progress(WorkProgress('repairing', (time - begin) / SECOND, None, 's'))
            yield definition, stored
        packed.report(file.path, self._report)
        for topic, count in unusable.items():
            self._report(
                f'{file.path}: {count} messages on {topic} are no {definitions[topic].type} and '
                'were left out'
            )
        unusable.update(packed.lost)
        for topic, count in left_out.items():
            self._report(
                f'{file.path}: {count} messages on {topic} have no type, or another type than '
                'the rest, and were left out'
            )

    def _decodes(self, stored: RawMessage, definition: Definition) -> bool:
        """True unless a message does not match its type; types that are not understood pass."""
        topic = stored.topic
        if topic not in self._decoders:
            try:
                self._decoders[topic] = self._bag_types.decoder(topic, definition)
            except BagError:
                self._decoders[topic] = None
        decode = self._decoders[topic]
        try:
            return decode is None or decode(stored.data) is not None
        except MessageError:
            return False

    def lost(self, saved: Mapping[str, int]) -> dict[str, int]:
        """Number of messages by topic that metadata or indexes count and that are not saved."""
        by_metadata: Counter[str] = Counter()
        for (topic, _), count in (self._metadata.counts() if self._metadata else {}).items():
            by_metadata[topic] += count
        by_index: Counter[str] = Counter()
        for file in self.files:
            for (topic, _), count in (file.counts() or {}).items():
                by_index[topic] += count
        missing = {
            topic: count - saved.get(topic, 0) for topic, count in (by_metadata | by_index).items()
        }
        for topic, count in sum(self._unusable.values(), Counter[str]()).items():
            missing[topic] = max(missing.get(topic, 0), count)
        return {topic: count for topic, count in sorted(missing.items()) if count > 0}

    def _load_metadata(self) -> BagMetadata | None:
        file = self.path / FILE_NAME
        if not file.is_file():
            self._report(f'{self.path}: no {FILE_NAME}')
            return None
        try:
            metadata = load_metadata(file)
        except BagError as reason:
            self._report(str(reason))
            return None
        return metadata

    def _check_kind(self) -> None:
        known = self._metadata
        if self.path.is_dir() and not any(self.path.glob('*.mcap*')):
            if any(self.path.glob('*.db3')):
                raise BagError(
                    f'{self.path}: found no MCAP file, expected at least one; '
                    '`sqlite3 FILE.db3 .recover` repairs databases'
                )
            raise BagError(no_bag(self.path))
        if known and known.compression_mode.lower() not in ('', 'none', 'message'):
            raise BagError(
                f'{self.path}: compressed per {known.compression_mode.lower()}; expected MCAP '
                'files as they are, so unpack them first'
            )

    def _names(self) -> list[Path]:
        """The bag's files in the order in which they were written."""
        if not self.path.is_dir():
            return [self.path]
        there = sorted(self.path.glob('*.mcap'), key=_place)
        if self._metadata is None:
            return there
        named = [self.path / Path(name).name for name in self._metadata.relative_file_paths]
        for name in named:
            if name not in there:
                self._report(f'{self.path}: {FILE_NAME} names {name.name}, which is not there')
        stems = {_place(name)[0] for name in named}
        for name in [name for name in there if name not in named]:
            if _place(name)[0] in stems:
                self._report(f'{self.path}: {FILE_NAME} does not name {name.name}')
            else:
                # Somebody else's: taken in, its messages might be in the bag twice.
                self._report(f'{self.path}: {name.name} is not of this bag and is left out')
                there.remove(name)
        return there

    def _open(self, path: Path) -> McapFile | None:
        try:
            stated = self._metadata.stated if self._metadata else None
            return McapFile(path, self._report, stated)
        except BagError as reason:
            self._report(str(reason))
            return None

    def _report(self, problem: str) -> None:
        if problem not in self.problems:
            self.problems.append(problem)


def _place(path: Path) -> tuple[str, int]:
    """Stem and number of a file, which place trial_10 after trial_9."""
    numbered = _NUMBERED.fullmatch(path.stem)
    return (numbered['stem'], int(numbered['number'])) if numbered else (path.stem, 0)
