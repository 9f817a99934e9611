"""A file is refused in words that name file, key, what was found and what was expected."""

from pathlib import Path

import pytest
from pydantic import Field, model_validator

from trawl_ros.core.errors import GearError
from trawl_ros.core.schema import Record, load_yaml, validated
from trawl_ros.core.validation_messages import key_unit


class Warp(Record):
    length_m: float = Field(gt=0, lt=3000)
    segments: int = 20
    points_m: tuple[tuple[float, float, float], ...] = ()


class Gear(Record):
    warp: Warp
    name: str = 'gear'
    speed_m_s: float = 2.0
    start: float | Warp = 1.0


def read(folder: Path, text: str | bytes) -> Gear:
    path = folder / 'gear.yaml'
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return validated(Gear, load_yaml(path, GearError), path, GearError)


def complaint(folder: Path, text: str | bytes) -> str:
    with pytest.raises(GearError) as caught:
        read(folder, text)
    return str(caught.value).replace(f'{folder / "gear.yaml"}: ', '')


def test_lists_become_tuples_and_whole_numbers_do_where_a_number_is_due(tmp_path: Path) -> None:
    gear = read(tmp_path, 'warp: {length_m: 300, points_m: [[1, 2, 3.5]]}')
    assert gear.warp.length_m == 300.0
    assert gear.warp.points_m == ((1.0, 2.0, 3.5),)


def test_numbers_are_those_of_yaml_1_2(tmp_path: Path) -> None:
    path = tmp_path / 'plain.yaml'
    path.write_text('a: 1e3\nb: 010\nc: no\nd: 12:30\ne: 2020-01-01\nf: -.5\ng: true\nh: ~\n')
    assert load_yaml(path, GearError) == {
        'a': 1000.0,
        'b': 10,
        'c': 'no',
        'd': '12:30',
        'e': '2020-01-01',
        'f': -0.5,
        'g': True,
        'h': None,
    }


@pytest.mark.parametrize(
    ('text', 'sentence'),
    [
        (
            'warp: {length_ft: 9}',
            'warp.length_ft: unknown key; did you mean warp.length_m (metres)?',
        ),
        (
            'warp: {length: 9}',
            'warp.length: unknown key; did you mean warp.length_m (metres)?',
        ),
        (
            'warp: {length_m: 9}\nspeed_kn: 4',
            'speed_kn: unknown key; did you mean speed_m_s (metres per second)?',
        ),
        (
            'warp: {length_m: 9}\nzzz: 4',
            'zzz: unknown key, expected warp, name, speed_m_s or start',
        ),
        (
            'warp: {}',
            'warp.length_m: missing, expected a number (metres)',
        ),
        (
            'name: a',
            'warp: missing, expected a section with length_m, segments and points_m',
        ),
        (
            'warp: {length_m: -3}',
            'warp.length_m: found -3, expected a number greater than 0 (metres)',
        ),
        (
            'warp: {length_m: "9"}',
            "warp.length_m: found '9', expected a number (metres)",
        ),
        (
            'warp: {length_m: true}',
            'warp.length_m: found true, expected a number (metres)',
        ),
        (
            'warp: {length_m: 9, segments: true}',
            'warp.segments: found true, expected a whole number',
        ),
        (
            'warp: {length_m: 9, segments: 2.5}',
            'warp.segments: found 2.5, expected a whole number',
        ),
        (
            'warp: {length_m: .nan}',
            'warp.length_m: found nan, expected a finite number (metres)',
        ),
        (
            'warp: {length_m: 1e999}',
            'warp.length_m: found inf, expected a finite number (metres)',
        ),
        (
            'warp: {length_m: 9, points_m: [[1, 2, 3], [1, 2, x]]}',
            "warp.points_m[1][2]: found 'x', expected a number (metres)",
        ),
        (
            'warp: {length_m: 9, points_m: [[1, 2]]}',
            'warp.points_m[0][2]: missing, expected a number (metres)',
        ),
        (
            'warp:',
            'warp: found nothing, expected a section with length_m, segments and points_m',
        ),
        (
            'warp: {length_m: 9}\nstart: {length_m: 0}',
            'start.length_m: found 0, expected a number greater than 0 (metres)',
        ),
    ],
)
def test_a_wrong_value_is_named_with_key_and_expectation(
    tmp_path: Path, text: str, sentence: str
) -> None:
    assert complaint(tmp_path, text) == sentence


@pytest.mark.parametrize(
    ('text', 'part'),
    [
        ('name: a\nname: b', "line 2, column 1: found key 'name' again"),
        ('warp: {a: 1, a: 2}', "found key 'a' again"),
        ('a: &x [1]\nb: *x', 'found an alias'),
        ('[' * 1000, '20 levels'),
        ('a: [1', 'line 1'),
        ('1: 2', 'a key that'),
        ('[1]: 2', 'a key that'),
        ('', 'the file is empty'),
        ('- 1', 'the top level'),
        (
            'a: !!python/object:os.system x',
            'found a tag (tag:yaml.org,2002:python/object:os.system)',
        ),
        ('!!int abc', 'line 1, column 1: '),
        ('!!map [1]', 'found a tag'),
        ('a: !!bool abc', 'found a tag'),
        ('? !!str [a]', 'found a tag'),
        ('a: ! b', 'found a tag'),
        ('a: "\\ud800"', 'control character or half'),
        ('a: "\\U00110000"', 'cannot be read'),
        (f'a: [{"1," * 300_000}]', '20000 values'),
        ('a: -2.5e+300', 'found -2.5e+300'),
        (f'a: 1{"0" * 30}', '1e+18 at most'),
        ('a: 1\n---\nb: 2', 'another document'),
        (b'a: \xff', 'byte 3 is not UTF-8'),
        ('#' * 1_000_001, 'larger than 1000000 bytes'),
    ],
)
def test_what_is_not_plain_yaml_is_refused(tmp_path: Path, text: str | bytes, part: str) -> None:
    assert part in complaint(tmp_path, text)


def test_a_missing_file_and_a_folder_are_named(tmp_path: Path) -> None:
    with pytest.raises(GearError, match=r'none\.yaml: no such file'):
        load_yaml(tmp_path / 'none.yaml', GearError)
    with pytest.raises(GearError, match='found a folder'):
        load_yaml(tmp_path, GearError)


def test_every_mistake_is_told_and_very_many_are_counted(tmp_path: Path) -> None:
    two = complaint(tmp_path, 'warp: {length_m: 0, segments: x}').splitlines()
    assert len(two) == 2
    many = complaint(tmp_path, '\n'.join(f'key{i}: 1' for i in range(20))).splitlines()
    assert len(many) == 11
    assert '11 more' in many[-1]


def test_a_part_of_a_file_is_named_by_its_place(tmp_path: Path) -> None:
    with pytest.raises(GearError, match=r'^f: gear\.warp\.length_m: found -1'):
        validated(Gear, {'warp': {'length_m': -1}}, 'f', GearError, prefix='gear')


class Pair(Record):
    low_m: float
    high_m: float

    @model_validator(mode='after')
    def _in_order(self) -> 'Pair':
        if self.low_m >= self.high_m:
            raise ValueError(f'high_m: found {self.high_m}, more than {self.low_m}')
        if self.low_m == -1:
            raise ValueError('not wanted')
        return self


class Pairs(Record):
    pair: Pair


@pytest.mark.parametrize(
    ('low', 'sentence'),
    [(5, 'high_m: found 2.0, more than 5.0'), (-1, 'not wanted')],
)
def test_a_check_across_keys_is_placed_where_it_belongs(low: float, sentence: str) -> None:
    data = {'low_m': low, 'high_m': 2}
    with pytest.raises(GearError) as caught:
        validated(Pair, data, 'f', GearError)
    assert str(caught.value) == f'f: {sentence}'
    with pytest.raises(GearError) as caught:
        validated(Pairs, {'pair': data}, 'f', GearError)
    assert str(caught.value) == f'f: pair{"." if low == 5 else ": "}{sentence}'


@pytest.mark.parametrize(
    ('key', 'unit'),
    [
        ('length_m', 'metres'),
        ('speed_m_s', 'metres per second'),
        ('density_gradient_kg_m4', 'kilograms per cubic metre and metre'),
        ('minutes', 'minutes'),
        ('name', None),
        ('m', None),
    ],
)
def test_the_end_of_a_key_states_its_unit(key: str, unit: str | None) -> None:
    assert key_unit(key) == unit


@pytest.mark.parametrize('sign', ['\\e[2J', '\\x07', '\\x9b', '\\u202e', '\\ud800', '\\0'])
def test_control_characters_are_refused(tmp_path, sign):
    path = tmp_path / 'gear.yaml'
    path.write_text(f'name: "mine {sign}"\n')
    with pytest.raises(GearError, match='control character') as refusal:
        load_yaml(path, GearError)
    assert str(refusal.value).isprintable()


def test_a_complaint_does_not_repeat_a_whole_file():
    class Named(Record):
        name: str

        @model_validator(mode='after')
        def _refuse(self) -> 'Named':
            raise ValueError(f'name: found {self.name}, expected another')

    for data in ({'name': 'x' * 100_000}, {'name': 'x', 'y' * 100_000: 1}):
        with pytest.raises(GearError) as refusal:
            validated(Named, data, 'gear.yaml', GearError)
        assert len(str(refusal.value)) < 3000
