# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Draft of a mapping: the columns of a log whose names are recognised."""

import csv
import re
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from trawl_ros.bags.logs.probe_files import format_of, refuse_without_clock
from trawl_ros.core.errors import LogError
from trawl_ros.core.foreign import one_line, open_file, reading
from trawl_ros.core.resources import share_path
from trawl_ros.core.units import UNITS
from trawl_ros.records.fields import FIELDS, STD_QUANTITIES

HEAD_BYTES = 100_000
"""Part of a log from which its layout is recognised, bytes."""

USUAL_NOISE = {'length': '1.0, unit: m', 'angle': '1.0, unit: deg', 'pressure': '0.5, unit: m'}
"""Assumed noise of a sensor, by quantity; that of a pressure is a depth."""


class Guess(NamedTuple):
    """Topic, field and usual unit of columns whose names contain the words."""

    words: str
    topic: str
    field: str
    unit: str


GUESSES = (
    *(
        Guess(f'(?=.*({side}))(?=.*({words}))', topic.format(name), field.format(name), unit)
        for side, name in (
            (r'\bport\b|\bprt\b|\bp\b', 'port'),
            (r'\bstarboard\b|\bstbd?\b|\bs\b', 'starboard'),
        )
        for words, topic, field, unit in (
            ('tension|load', 'winch/joint_states', '{}_tension', 'tf'),
            ('warp|wire|scope|length', 'winch/joint_states', '{}_length', 'm'),
            ('slant|range', 'door/{}/slant_range', 'distance', 'm'),
            ('depth', 'door/{}/pressure', 'depth', 'm'),
            ('pitch', 'door/{}/attitude', 'pitch', 'deg'),
            ('roll', 'door/{}/attitude', 'roll', 'deg'),
        )
    ),
    Guess('door.*spread|spread.*door|^spread', 'door/spread', 'distance', 'm'),
    Guess('opening|headline height|net height', 'sonar/opening_height', 'distance', 'm'),
    Guess('(net|headrope|headline|trawl).*depth', 'sonar/pressure', 'depth', 'm'),
    Guess('depth|sounder', 'vessel/echo_sounder/depth', 'distance', 'm'),
    Guess(r'(water.*speed|stw|^log\b)', 'vessel/velocity_water', 'forward', 'kn'),
    Guess('sog|speed', 'vessel/velocity_ground', 'speed', 'kn'),
    Guess('cog|course', 'vessel/velocity_ground', 'compass_course', 'deg'),
    Guess('heading|hdg', 'vessel/heading', 'compass_heading', 'deg'),
    Guess('^lat', 'vessel/fix', 'latitude', 'deg'),
    Guess('^lon', 'vessel/fix', 'longitude', 'deg'),
)  # fmt: skip
"""Guesses by the words of a name, the surest first."""


def draft_mapping(path: str | Path) -> str:
    """Write a mapping of a log, as text of a YAML file.

    Parameters
    ----------
    path
        A table with a line of column names, or a file of a known receiver.

    Raises
    ------
    LogError
        If the log is missing, or has no column that is recognised; names those found.
    """
    path = Path(path)
    with reading(path, LogError), open_file(path, LogError) as content:
        lines = content.read(HEAD_BYTES).decode('utf-8-sig', 'replace').splitlines()
    if form := format_of(lines):
        text = share_path('config', 'logs', f'{form}.yaml').read_text(encoding='utf-8')
        if form == 'netmind' and any('Head-Bottom' in line for line in lines[:10]):
            # Names of the 1990s.
            text = text.replace(': Primary', ': Head-Bottom').replace(': DoorSpread', ': Door')
        return text
    refuse_without_clock(path, lines)
    if any(re.match(r'.{0,40}[$!@][A-Z]{4,}', line) for line in islice(lines, 20)):
        return share_path('config', 'logs', 'nmea.yaml').read_text(encoding='utf-8')
    separator = max(';\t,', key=lambda sign: max(map(len, _table(lines, sign)), default=0))
    table = _table(lines, separator)
    width = max(map(len, table), default=0)
    start = next((n for n, row in enumerate(table) if len(row) == width), 0)
    names = [name.strip() for name in table[start]] if table else []
    below = table[start + 1] if len(table) > start + 1 else []
    # A line below the names without any digit has the units.
    units = below if below and not re.search(r'\d', ''.join(below)) else [''] * len(names)
    known = {
        name: guess
        for name, unit in zip(names, units, strict=False)
        if (guess := _guess(f'{name} {unit}'))
    }
    times = [n for n in names if re.search(r'date|time|utc', n.lower()) and n not in known]
    if not known:
        raise LogError(
            f'{path}: line {start + 1}: recognised none of the columns '
            f'{one_line(", ".join(names), 500)}; expected names such as "Port warp (m)" or '
            '"Door spread"'
        )
    layout = f'skip_lines: {start}, skip_after_names: {int(units is below)}'
    others = [name for name in names if name not in known and name not in times]
    return _written(path, separator, layout, known, times, others)


def _table(lines: list[str], separator: str) -> list[list[str]]:
    return list(csv.reader(lines[:50], delimiter=separator))


def _guess(name: str) -> Guess | None:
    """Return what a column is, with the unit that its name states."""
    words = re.sub(r'[_()\[\],.]', ' ', name.lower()).strip()
    words = re.sub(r'\bfms?\b', 'fathom', words)
    found = next((guess for guess in GUESSES if re.search(guess.words, words)), None)
    if found is None:
        return None
    quantity = FIELDS[found.topic][found.field]
    stated = [unit for unit in UNITS if unit.lower() in words.split()[1:]]
    unit = next((u for u in stated if UNITS[u].quantity == quantity), found.unit)
    return found._replace(unit=unit)


def _written(
    path: Path,
    separator: str,
    layout: str,
    known: dict[str, Guess],
    times: list[str],
    others: list[str],
) -> str:
    shown = 'tab' if separator == '\t' else f"'{separator}'"
    lines = [
        f'# Draft of a mapping for {path.name}: check units, signs and what is ASSUMED.',
        f'layout: {{separator: {shown}, {layout}}}',
        f'clock: {{columns: [{", ".join(map(_quoted, times or ["time"]))}], format: iso, '
        'utc_offset_h: 0} # ASSUMED: format and zone',
        'water: {density_kg_m3: 1025.0} # ASSUMED: sea water',
        'topics: # ASSUMED: noise',
    ]
    for topic in dict.fromkeys(guess.topic for guess in known.values()):
        columns = {
            guess.field: (n, guess.unit) for n, guess in known.items() if guess.topic == topic
        }
        lines += [f'  {topic}:', '    optional: true', '    fields:']
        lines += [
            f'      {field}: {{column: {_quoted(name)}, unit: {unit}}}'
            for field, (name, unit) in columns.items()
        ]
        if quantity := STD_QUANTITIES.get(topic):
            lines.append(f'    std: {{value: {USUAL_NOISE[quantity]}}}')
    if others:
        lines.append(f'# not recognised: {", ".join(others)}')
    return '\n'.join(lines) + '\n'


def _quoted(name: str) -> str:
    return "'" + name.replace("'", "''") + "'"
