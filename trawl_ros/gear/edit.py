"""Edits of a gear file's text: values changed at their places, comments and order kept."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import yaml

from trawl_ros.core.errors import GearError
from trawl_ros.core.files import write_text, written
from trawl_ros.core.resources import packaged
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.gear.rigging import ENDS

Key = tuple[str | int, ...]
"""Keys and indices from the top of the file to a value."""

DIGITS = 3
"""Decimals that are written: millimetres, and thousandths of a newton."""

FIGURES = '.12g'
"""Format of numbers in the file, in which none of those decimals is lost."""


CLOSE = 0.01
"""Rounding that numbers may have in the file."""


def changed_values(old: GearRecord, new: GearRecord) -> dict[Key, float]:
    """Numbers in which two gears differ, by their keys.

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
            raise GearError(f'{_dotted(key)}: found {new!r} as its change, expected a number')
        yield key, round(new, DIGITS)


def edited(text: str, values: Mapping[Key, float]) -> str:
    """Text of a gear file with some of its numbers changed.

    A number that the file leaves out is put beside the others of its record; one of the bridles,
    where the file has no list of them, into such a list at its end.

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
            raise GearError(f'{_dotted(key)}: missing, expected it in the file')
        elif (node := _child(record, last)) is not None:
            pieces.append((node.start_mark.index, node.end_mark.index, f'{value:{FIGURES}}'))
        elif isinstance(record, yaml.MappingNode):
            pieces.append(_added(record, str(last), value))
    for start, end, new in sorted(pieces, reverse=True):
        text = text[:start] + new + text[end:]
    if bridles:
        # Those that every gear without a list has; behind a sweep none has a place at the board.
        swept = _child(root, 'sweep') is not None
        rows = []
        for number, name in enumerate(ENDS):
            row = f'name: {name}, ' + ('' if swept else f'at_board: {name}, ') + f'at_net: {name}'
            length = f', length_m: {bridles[number]:{FIGURES}}' if number in bridles else ''
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
    """Insertion of a key ahead of the first one of its record."""
    first = node.value[0][0].start_mark
    ending = ', ' if node.flow_style else '\n' + ' ' * first.column
    return first.index, first.index, f'{name}: {value:{FIGURES}}{ending}'


def _named(key: Key) -> Key:
    """Key without the coordinate of a point at its end."""
    return key[:-1] if isinstance(key[-1], int) else key


def _dotted(key: Key) -> str:
    return '.'.join(map(str, key))


def write_changed(source: str | Path, out: Path, gear: GearRecord) -> None:
    """Write a copy of a gear file in which the numbers of a changed gear stand.

    Parameters
    ----------
    source
        A file, or the name of a gear that comes with the package.
    out
        New file.
    gear
        The changed gear.

    Raises
    ------
    GearError
        If ``out`` is there already, or what would be written does not load as that gear. Then no
        file is left.
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
            if abs(there.get(key, float('inf')) - value) > CLOSE:
                raise GearError(
                    f'{out}: {_dotted(key)} cannot be written beside what the file says'
                )


def require_new(path: Path) -> None:
    """Refuse a file that is there already.

    Raises
    ------
    GearError
        Naming it.
    """
    if path.exists() or path.is_symlink():
        raise GearError(f'{path}: found a file, expected a new name: none is written over')
