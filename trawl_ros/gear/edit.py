# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Edits of a gear file's text that change values and keep comments and order."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import yaml

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import GearError
from trawl_ros.core.files import write_text, written
from trawl_ros.core.resources import packaged
from trawl_ros.gear.boards import FasteningRecord
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.gear.rigging import ENDS

Key = tuple[str | int, ...]
"""Keys and indices from the top of the file to a value."""

WRITTEN_DECIMALS = 3
"""Decimals of written numbers: millimetres, and thousandths of a newton."""

NUMBER_FORMAT = '.12g'
"""Format of numbers in the file, which keeps these decimals."""

ROUNDING_TOLERANCE = 0.01
"""Greatest difference between a number in the file and its value."""


def fastening_lines(points: FloatArray) -> tuple[str, ...]:
    """Return the lines of fastening points (3, 3) of warp, upper and lower bridle, m."""
    return tuple(
        f'{name}: [{", ".join(f"{x:.{WRITTEN_DECIMALS}f}" for x in point)}]'
        for name, point in zip(FasteningRecord.model_fields, points, strict=True)
    )


def changed_values(old: GearRecord, new: GearRecord) -> dict[Key, float]:
    """Return the numbers in which two gears differ, by their keys.

    Raises
    ------
    GearError
        If they differ in anything but numbers.
    """
    return dict(_differences((), old.model_dump(), new.model_dump()))


def _differences(key: Key, old: object, new: object) -> Iterator[tuple[Key, float]]:
    if isinstance(old, Mapping) and isinstance(new, Mapping) and set(old) == set(new):
        for name in old:
            yield from _differences((*key, name), old[name], new[name])
    elif (
        isinstance(old, Sequence)
        and isinstance(new, Sequence)
        and not isinstance(old, str)
        and len(old) == len(new)
    ):
        for number, pair in enumerate(zip(old, new, strict=True)):
            yield from _differences((*key, number), *pair)
    elif old != new:
        if not isinstance(new, float):
            raise GearError(f'{_dotted(key)}: found the new value {new!r}, expected a number')
        yield key, round(new, WRITTEN_DECIMALS)


def edited(text: str, values: Mapping[Key, float]) -> str:
    """Return the text of a gear file with some of its numbers changed.

    A number that the file does not have is added to its record. A number of the bridles is added
    in a list of bridles at the end if the file has none.

    Raises
    ------
    GearError
        If a record is not in the file.
    """
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    assert root is not None
    pieces: list[tuple[int, int, str]] = []
    bridles: dict[int, float] = {}
    for key, value in values.items():
        *ahead, last = key
        record, missing = root, ''
        for part in ahead:
            child = _child(record, part)
            missing = missing or ('' if child is not None else str(part))
            record = child or record
        if missing == 'bridles':
            bridles[int(key[1])] = value
        elif missing or not isinstance(record, yaml.MappingNode | yaml.SequenceNode):
            raise GearError(f'{_dotted(key)}: missing, expected this key in the file')
        elif (node := _child(record, last)) is not None:
            pieces.append((node.start_mark.index, node.end_mark.index, f'{value:{NUMBER_FORMAT}}'))
        elif isinstance(record, yaml.MappingNode):
            pieces.append(_added(record, str(last), value))
    for start, end, new in sorted(pieces, reverse=True):
        text = text[:start] + new + text[end:]
    if bridles:
        # The default bridles of a gear; behind a sweep they have no fastening point at the board.
        swept = _child(root, 'sweep') is not None
        rows = []
        for number, name in enumerate(ENDS):
            row = f'name: {name}, ' + ('' if swept else f'at_board: {name}, ') + f'at_net: {name}'
            length = f', length_m: {bridles[number]:{NUMBER_FORMAT}}' if number in bridles else ''
            rows.append(f'  - {{{row}{length}}}')
        text = '\n'.join([text.rstrip('\n'), '', 'bridles:', *rows, ''])
    return text


def _child(node: yaml.Node, part: str | int) -> yaml.Node | None:
    if isinstance(node, yaml.MappingNode):
        return next((value for key, value in node.value if key.value == part), None)
    if isinstance(node, yaml.SequenceNode) and isinstance(part, int):
        return node.value[part] if part < len(node.value) else None
    return None


def _added(node: yaml.MappingNode, name: str, value: float) -> tuple[int, int, str]:
    """Return the insertion of a key ahead of the first key of its record."""
    first = node.value[0][0].start_mark
    ending = ', ' if node.flow_style else '\n' + ' ' * first.column
    return first.index, first.index, f'{name}: {value:{NUMBER_FORMAT}}{ending}'


def _named(key: Key) -> Key:
    """Return a key without the coordinate of a point at its end."""
    return key[:-1] if isinstance(key[-1], int) else key


def _dotted(key: Key) -> str:
    return '.'.join(map(str, key))


def write_changed(source: str | Path, out: Path, gear: GearRecord) -> None:
    """Write a copy of a gear file with the numbers of a changed gear.

    Parameters
    ----------
    source
        A file, or the name of a gear in the package.
    out
        New file.
    gear
        Changed gear.

    Raises
    ------
    GearError
        If ``out`` exists, or the new file would not load as that gear. Then no file is written.
    """
    require_new(out)
    path = packaged(source, 'gear', GearError)
    old = load_gear(path)
    values = changed_values(old, gear)
    keys = ', '.join(dict.fromkeys(_dotted(_named(key)) for key in values))
    head = f'# Copy of {path.name} in which `trawl trim` changed {keys}.\n'
    text = head + edited(path.read_text(encoding='utf-8'), values)
    with written(out) as draft:
        write_text(draft, text)
        try:
            there = changed_values(old, load_gear(draft))
        except GearError as reason:
            raise GearError(str(reason).replace(str(draft), str(out))) from reason
        for key, value in values.items():
            if abs(there.get(key, float('inf')) - value) > ROUNDING_TOLERANCE:
                raise GearError(
                    f'{out}: {_dotted(key)}: found no place for it in the text of the gear file, '
                    'expected a key that can be changed there; set it by hand'
                )


def require_new(path: Path) -> None:
    """Check that a path is free.

    Raises
    ------
    GearError
        If there is a file or a link.
    """
    if path.exists() or path.is_symlink():
        raise GearError(f'{path}: found a file, expected a new name: none is written over')
