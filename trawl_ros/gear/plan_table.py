# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Net plan: read from a table (CSV), written as a section of a gear file."""

import csv
from pathlib import Path

import yaml

from trawl_ros.core.errors import GearError
from trawl_ros.core.foreign import read_whole, reading
from trawl_ros.core.limits import YAML_BYTES
from trawl_ros.core.schema import CONTROL, validated
from trawl_ros.gear.net_plan import NetPlanRecord, PieceRecord

TEXT_COLUMNS = ('part', 'panel', 'section', 'material', 'knots', 'cut', 'orientation')
INTEGER_COLUMNS = ('twines', 'pieces')


def read_plan(path: Path) -> NetPlanRecord:
    """Read a net plan from a CSV file.

    Parameters
    ----------
    path
        UTF-8 file with a heading. Columns are the keys of `PieceRecord`, separated by commas or
        semicolons. Empty cells are missing keys. Empty lines and lines that begin with # are
        ignored.

    Raises
    ------
    GearError
        If the table is wrong; it names file, line, column, found and expected values.
    """
    raw = read_whole(path, YAML_BYTES, GearError, 'a smaller table')
    try:
        text = raw.decode('utf-8-sig')
    except UnicodeDecodeError as reason:
        raise GearError(
            f'{path}: byte {reason.start} is not UTF-8, expected a text file'
        ) from reason
    if control := CONTROL.search(text):
        line = text.count('\n', 0, control.start()) + 1
        raise GearError(f'{path}: line {line}: a control character, expected text')
    with reading(path, GearError):
        return _plan(path, text)


def _plan(path: Path, text: str) -> NetPlanRecord:
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip(' ;,') and not line.lstrip().startswith('#')
    ]
    if not lines:
        raise GearError(f'{path}: found no lines, expected a heading and a line for each piece')
    mark = ';' if lines[0][1].count(';') > lines[0][1].count(',') else ','
    try:
        rows = list(csv.reader([line for _, line in lines], delimiter=mark, strict=True))
    except csv.Error as reason:
        raise GearError(f'{path}: found no table ({reason}), expected CSV') from reason
    heading, known = [name.strip() for name in rows[0]], list(PieceRecord.model_fields)
    for name in heading:
        if name not in known:
            raise GearError(f"{path}: found column '{name}', expected one of {', '.join(known)}")
        if heading.count(name) > 1:
            raise GearError(f"{path}: found column '{name}' twice, expected each column once")
    pieces = []
    for (number, _), cells in zip(lines[1:], rows[1:], strict=False):
        if len(cells) != len(heading):
            raise GearError(
                f'{path}: line {number}: found {len(cells)} cells, expected {len(heading)} as in '
                'the heading'
            )
        piece = {
            name: _value(name, cell.strip(), f'{path}: line {number}')
            for name, cell in zip(heading, cells, strict=True)
            if cell.strip()
        }
        validated(PieceRecord, piece, f'{path}: line {number}', GearError)
        pieces.append(piece)
    return validated(NetPlanRecord, {'pieces': pieces}, path, GearError)


def _value(name: str, cell: str, place: str) -> str | float | int:
    if name in TEXT_COLUMNS:
        return cell
    try:
        return int(cell) if name in INTEGER_COLUMNS else float(cell)
    except ValueError as reason:
        raise GearError(f"{place}: {name}: found '{cell}', expected a number") from reason


def plan_text(plan: NetPlanRecord) -> str:
    """Return the text of the ``plan`` in a gear file's ``netting``, with a line per piece."""
    lines = ['plan:', '  pieces:']
    for piece in plan.pieces:
        given = piece.model_dump(exclude_defaults=True, exclude_none=True)
        flow = yaml.safe_dump(
            given, default_flow_style=True, sort_keys=False, allow_unicode=True, width=10_000
        )
        lines.append(f'    - {flow.strip()}')
    return '\n'.join(lines) + '\n'
