"""YAML of gears, scenarios, instruments and mappings: damaged, wrong, and written with intent."""

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from hostile.mutations import long, mutated
from hostile.target import Files, Target, one_file
from trawl_ros.bags.logs.mapping import load_mapping
from trawl_ros.core.resources import share_path
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.plan_table import plan_text, read_plan
from trawl_ros.gear.polars import load_door
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.model.gear_model import build_model
from trawl_ros.scenario.scenario import load_scenario
from trawl_ros.sentences.table import load_table

FILE = 'given.yaml'
PLAN = 'given.csv'

TABLE = """part,panel,section,mesh_mm,front_meshes,back_meshes,long_meshes,rtex,material,knots,cut
wing,upper,,800,16,40,25.5,3370,PA,,AB
wing,lower,,800,16,40,25.5,3370,PA,,AB
body,upper,front,800,110,,25,3370,PA,,1N4B
body,lower,front,800,110,,25,3370,PA,,1N4B
codend,all,end,40,3000,2000,100,2000,PE,knotless,
"""

TAGS = (
    *('int', 'float', 'bool', 'null', 'str', 'map', 'seq', 'set', 'omap', 'pairs', 'binary'),
    *('timestamp', 'merge', 'value', 'python/name:os.system'),
)
SCALARS = (
    *('1', '-0', '0.5', '1e999', '.nan', '-.inf', '0x1f', '010', '1_000', '12:30', 'true', '~'),
    *("''", 'abc', '=', '<<', '9' * 30, '9' * 5000, '2026-99-99', '"\\ud800"', '"\\0"', '"\\e[2J"'),
    *('-1', '1e-300', '1e300', '1000000', '600000.0', 'null', '|', '>', '*a', '&a 1', '%TAG', '@'),
)


@cache
def values() -> SearchStrategy[str]:
    """Values in flow style: scalars, lists and mappings, with tags and keys of any kind."""
    tagged = st.sampled_from(TAGS).map('!!{} '.format) | st.sampled_from(('', '! ', '!<x> ', '&a '))
    leaves = st.tuples(tagged, st.sampled_from(SCALARS)).map(''.join)

    def grown(inner: SearchStrategy[str]) -> SearchStrategy[str]:
        pairs = st.tuples(st.sampled_from(('', '? ')), inner, inner).map(
            lambda pair: f'{pair[0]}{pair[1]} : {pair[2]}'
        )
        return st.one_of(
            st.tuples(tagged, st.lists(inner, max_size=4).map(', '.join)).map(
                lambda made: f'{made[0]}[{made[1]}]'
            ),
            st.tuples(tagged, st.lists(pairs, max_size=3).map(', '.join)).map(
                lambda made: made[0] + '{' + made[1] + '}'
            ),
        )

    return st.recursive(leaves, grown, max_leaves=8)


@st.composite
def with_other_values(draw: DrawFn, sound: str) -> bytes:
    """A sound file in which values, of whole blocks too, are others."""
    lines = sound.splitlines()
    for _ in range(draw(st.integers(1, 3))):
        number = draw(st.sampled_from([n for n, line in enumerate(lines) if ':' in line]))
        key = lines[number].split(':', 1)[0]
        indent = len(key) - len(key.lstrip(' -'))
        end = number + 1
        if draw(st.booleans()):
            while end < len(lines) and len(lines[end]) - len(lines[end].lstrip()) > indent:
                end += 1
        name = draw(st.sampled_from((key, key, key, key[:indent] + '? ' + draw(values()))))
        lines[number:end] = [f'{name}: {draw(values())}']
    return '\n'.join(lines).encode('utf-8', 'surrogatepass')


def hostile_yaml(sound: list[str]) -> SearchStrategy[bytes]:
    """Content for a reader of YAML, from files that it takes."""
    pieces = [scalar.encode() for scalar in SCALARS] + [f'!!{tag} '.encode() for tag in TAGS]
    pieces += [b'[', b'{', b'? ', b': ', b'- ', b'\n', b'\t', b'---\n', b'...\n', b'\xff\xfe', b'#']
    deep = long(st.sampled_from((b'[', b'{a: ', b'- ', b'? ', b'!!seq [', b'{', b'[[]')), 200_000)
    wide = st.tuples(
        st.sampled_from((b'', b'a: ', b'name: ')),
        long(st.sampled_from((b'1,', b'a,', b'[],', b'"",', b'1', b'a: 1\n', b'- 1\n')), 200_000),
    ).map(lambda made: made[0] + (b'[' + made[1] + b']' if made[1].endswith(b',') else made[1]))
    start = st.sampled_from([text.encode() for text in sound])
    return st.one_of(
        st.sampled_from(sound).flatmap(with_other_values),
        st.sampled_from(sound).flatmap(with_other_values),
        mutated(start, pieces),
        values().map(lambda text: text.encode('utf-8', 'surrogatepass')),
        st.binary(max_size=64),
        st.one_of(deep, wide).filter(bool),
    )


def hostile_table() -> SearchStrategy[bytes]:
    """Content for the reader of net plans, from a table that it takes."""
    pieces = [scalar.encode() for scalar in SCALARS]
    pieces += [b',', b';', b'"', b'\n', b'\r', b'\0', b'#', b'\xff\xfe', b'part', b'1N2B', b'all']
    wide = long(st.sampled_from((b',', b'"', b'1,', b'wing,upper\n', b'"a\n')), 200_000)
    return st.one_of(mutated(st.just(TABLE.encode()), pieces), st.binary(max_size=64), wide)


def _files(folder: str) -> list[str]:
    return [path.read_text() for path in sorted(share_path('config', folder).glob('*.yaml'))]


def _known(name: str) -> dict[str, Callable[[], Files]]:
    contents = {
        'tag-int': b'!!int abc',
        'tag-map': b'!!map [1]',
        'key-of-a-list': b'? !!str [a]',
        'tag-below': f'{name}: !!int abc'.encode(),
        'tag-bool': f'{name}: !!bool abc'.encode(),
        'list-of-600-kB': f'{name}: [{"1," * 300_000}]'.encode(),
        'brackets': b'[' * 100_000,
    }
    return {what: (lambda content=content: {FILE: content}) for what, content in contents.items()}


def _target(name: str, folder: str, load: Callable[[Path], Any], key: str) -> Target:
    return Target(
        name=f'yaml-{name}',
        inputs=one_file(FILE, hostile_yaml(_files(folder))),
        read=lambda given, results: load(given / FILE),
        examples=60,
        known=_known(key),
    )


@st.composite
def with_other_numbers(draw: DrawFn, sound: str) -> bytes:
    """A sound file with other numbers, most of them possible."""
    spans = [found.span(1) for found in re.finditer(r'[:,\[] *(-?[\d.]+(?:e-?\d+)?)', sound)]
    chosen = draw(st.lists(st.sampled_from(spans), min_size=1, max_size=4, unique=True))
    for start, end in sorted(chosen, reverse=True):
        old = sound[start:end]
        factors = st.sampled_from((0.0, 1e-9, 0.01, 0.5, 2.0, 30.0, 1000.0, 1e9, 1e300, -1.0))
        if '.' in old or 'e' in old:
            new = repr(float(old) * draw(factors))
        else:
            new = str(draw(st.sampled_from((0, 1, 2, 12, 100, 240, 500, -1, 10**9))))
        sound = sound[:start] + new + sound[end:]
    return sound.encode()


def _gear_with(**changes: str) -> Callable[[], Files]:
    def made() -> Files:
        text = _files('gear')[0]
        for key, value in changes.items():
            text = re.sub(rf'\b{key}: [^ }}\n]+', f'{key}: {value}', text)
        return {FILE: text.encode()}

    return made


TARGETS = (
    Target(
        name='gear-model',
        inputs=one_file(FILE, st.sampled_from(_files('gear')).flatmap(with_other_numbers)),
        read=lambda given, results: build_model(load_gear(given / FILE)),
        examples=40,
        known={
            'netting-of-600-km': _gear_with(length_m='600000.0'),
            'netting-of-a-millimetre': _gear_with(length_m='0.001'),
            'knots-beyond-all-numbers': _gear_with(knot_diameters='2.5e+300'),
            'no-circumference': _gear_with(front_circumference_m='1.0e-300'),
        },
    ),
    _target('gear', 'gear', load_gear, 'name'),
    _target('door', 'doors', lambda path: load_door(str(path)), 'name'),
    Target(
        name='net-plan-table',
        inputs=one_file(PLAN, hostile_table()),
        read=lambda given, results: plan_text(read_plan(given / PLAN)),
        examples=60,
        known={'a-quote-that-does-not-end': lambda: {PLAN: TABLE.replace('AB', '"AB').encode()}},
    ),
    _target('scenario', 'scenarios', load_scenario, 'name'),
    _target('instruments', 'instruments', load_instruments, 'winch'),
    _target('csv-mapping', 'logs', load_mapping, 'clock'),
    _target('nmea-mapping', 'logs', load_mapping, 'nmea'),
    _target('sentences', 'sentences', load_table, 'system'),
)
