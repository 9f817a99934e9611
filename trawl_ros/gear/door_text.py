# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Copies of gear files under another name, and gear files with a door of the catalogue."""

import re
from collections.abc import Sequence
from pathlib import Path

import yaml

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import GearError
from trawl_ros.core.files import write_text, written
from trawl_ros.core.resources import packaged
from trawl_ros.gear.boards import BoardRecord
from trawl_ros.gear.edit import WRITTEN_DECIMALS, edited, fastening_lines, require_new
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord

OLD_DOOR_KEYS: tuple[tuple[str, ...], ...] = (
    ('board', 'law'), ('board', 'coefficients'), ('board', 'fastening'), ('identification',),
)  # fmt: skip
"""Keys that belong to the old door: its law, its fastening points and its prior."""


def copy_gear(source: str | Path, out: Path) -> None:
    """Write a copy of a gear file that has the name of its file.

    Raises
    ------
    GearError
        If the source cannot be loaded, or ``out`` exists.
    """
    require_new(out)
    path = packaged(source, 'gear', GearError)
    load_gear(path)
    text = path.read_text(encoding='utf-8')
    text = re.sub(r'^name:.*$', f'name: {out.stem}', text, count=1, flags=re.MULTILINE)
    write_text(out, f'# Copy of {path.name}.\n{text}')


def with_door(text: str, board: BoardRecord, points: FloatArray, *, plate: bool) -> str:
    """Return the text of a gear file with the door of a board in place of the old one.

    Parameters
    ----------
    text
        Gear file, whose board is a block of lines.
    board
        Board with the law of the door.
    points : (3, 3) array
        Fastening points of warp, upper and lower bridle in the outward frame, m.
    plate
        True if the plate has another size. A given inertia then no longer holds.

    Raises
    ------
    GearError
        If the board is not a block, or a key is missing.
    """
    assert board.law is not None
    for keys in (*OLD_DOOR_KEYS, *((('board', 'inertia'),) if plate else ())):
        text = _without(text, keys)
    if plate:
        names = ('area_m2', 'span_m', 'chord_m')
        text = edited(
            text, {('board', key): round(getattr(board, key), WRITTEN_DECIMALS) for key in names}
        )
    found = _find(text, ('board',))
    if found is None or not isinstance(found[1], yaml.MappingNode) or found[1].flow_style:
        raise GearError('board: found no block of lines, expected one key on each line')
    first = found[1].value[0][0].start_mark
    rows = [
        f'law: {{kind: table, door: {board.law.door}}}',
        f'fastening:  # [derived] `trawl gear set-door` for {board.law.door}',
        *(f'  {line}' for line in fastening_lines(points)),
        '',
    ]
    between: str = '\n' + ' ' * first.column
    return text[: first.index] + between.join(rows) + text[first.index :]


def write_door(path: Path, text: str) -> GearRecord:
    """Replace a gear file and return its record; the file stays if the text does not load."""
    with written(path) as draft:
        write_text(draft, text)
        try:
            return load_gear(draft)
        except GearError as reason:
            raise GearError(str(reason).replace(str(draft), str(path))) from reason


def _find(text: str, keys: Sequence[str]) -> tuple[yaml.Node, yaml.Node] | None:
    """Return the nodes of a key and of its value."""
    node = yaml.compose(text, Loader=yaml.SafeLoader)
    found = None
    for name in keys:
        if not isinstance(node, yaml.MappingNode):
            return None
        found = next((pair for pair in node.value if pair[0].value == name), None)
        if found is None:
            return None
        node = found[1]
    return found


def _without(text: str, keys: Sequence[str]) -> str:
    """Return the text without a key, its value, and the comment lines right above it."""
    found = _find(text, keys)
    if found is None:
        return text
    key, value = found
    lines, first, column = (
        text.splitlines(keepends=True),
        key.start_mark.line,
        key.start_mark.column,
    )
    if lines[first][:column].strip():
        raise GearError(f'{".".join(keys)}: found it within braces, expected it on its own line')
    flow = getattr(value, 'flow_style', False) or isinstance(value, yaml.ScalarNode)
    after = value.end_mark.line + 1 if flow else first + 1
    while after < len(lines) and _indentation(lines[after]) > column:
        after += 1
    while first and lines[first - 1].startswith(' ' * column + '#'):
        first -= 1
    return ''.join(lines[:first] + lines[after:])


def _indentation(line: str) -> int:
    return len(line) - len(line.lstrip(' ')) if line.strip() else -1
