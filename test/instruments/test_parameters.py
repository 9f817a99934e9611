"""Instrument files are checked on load; what is wrong is named."""

from pathlib import Path

import pytest

from trawl_ros.core.errors import InstrumentError, ScenarioError
from trawl_ros.core.resources import share_path
from trawl_ros.instruments.parameters import default_instruments_with, load_instruments


def changed(folder: Path, old: str, new: str) -> Path:
    text = share_path('config', 'instruments', 'default.yaml').read_text()
    assert old in text
    path = folder / 'mine.yaml'
    path.write_text(text.replace(old, new, 1))
    return path


def test_the_packaged_set_is_the_default_and_a_copy_of_it_says_the_same(tmp_path: Path) -> None:
    copy = changed(tmp_path, 'winch:', 'winch:')
    assert load_instruments() == load_instruments('default') == load_instruments(copy)


@pytest.mark.parametrize(
    ('old', 'new', 'named'),
    [
        ('rate_hz: 2.0', 'rate_hz: 0', 'winch.rate_hz: found 0'),
        ('rate_hz: 2.0', 'period_s: 2.0', 'winch.rate_hz: missing'),
        (
            'noise_kn: 1.6',
            'noise_n: 1600',
            'winch.tension.noise_n: ',
        ),
        ('noise_m: 0.39', 'noise_m: -0.39', 'door.spread.noise_m: found -0.39'),
        ('min_range_m: 1.0', 'min_range_m: 500', 'max_range_m: found 400.0'),
        ('correlation_time_s: 600.0', 'correlation_time_s: 0', 'correlation_time_s: found 0'),
        ('datum_lat_deg: 60.0', 'datum_lat_deg: 95', 'vessel.datum_lat_deg: found 95'),
    ],
)
def test_a_wrong_parameter_is_named(tmp_path: Path, old: str, new: str, named: str) -> None:
    path = changed(tmp_path, old, new)
    with pytest.raises(InstrumentError) as caught:
        load_instruments(path)
    assert str(caught.value).startswith(f'{path}: ')
    assert named in str(caught.value)


def test_an_unknown_set_is_refused_with_the_names_there_are() -> None:
    with pytest.raises(InstrumentError, match=r'default, worn'):
        load_instruments('nosuch')


def test_a_file_may_say_only_what_differs_from_a_set_of_the_package(tmp_path: Path) -> None:
    path = tmp_path / 'mine.yaml'
    path.write_text('base: default\ndoor: {spread: {noise_m: 2.0}}\n')
    found, default = load_instruments(path), load_instruments()
    assert found.door.spread.noise_m == 2.0
    assert found.vessel == default.vessel
    path.write_text('base: other.yaml\n')
    with pytest.raises(InstrumentError, match=r"base: found 'other\.yaml'"):
        load_instruments(path)


def test_the_worn_set_differs_from_the_default_in_every_group() -> None:
    worn, default = load_instruments('worn'), load_instruments()
    for group in ('winch', 'door', 'sonar', 'vessel'):
        assert getattr(worn, group) != getattr(default, group)


@pytest.mark.parametrize(
    ('key', 'value', 'named'),
    [
        ('dropouts_per_hour', 3, 'dropouts_per_hour: found 3 with dropout_s 0'),
        ('freeze_s', 3, 'freezes_per_hour: found 0 with freeze_s 3'),
        ('outlier_share', 0.1, 'outlier_share: found 0.1 with outlier_m 0'),
        ('outlier_share', 7, 'outlier_share: found 7'),
    ],
)
def test_half_a_description_of_trouble_is_refused(
    tmp_path: Path, key: str, value: float, named: str
) -> None:
    path = tmp_path / 'mine.yaml'
    path.write_text(f'base: default\nvessel: {{fix: {{{key}: {value}}}}}\n')
    with pytest.raises(InstrumentError) as caught:
        load_instruments(path)
    assert named in str(caught.value)


def test_overrides_change_what_they_name_and_nothing_else() -> None:
    found = default_instruments_with(
        {'door': {'spread': {'noise_m': 2.0}}}, 'trial.yaml', ScenarioError, prefix='instruments'
    )
    default = load_instruments()
    assert found.door.spread.noise_m == 2.0
    assert found.door.spread.rate_hz == default.door.spread.rate_hz
    assert found.winch == default.winch


def test_a_wrong_override_is_named_where_it_stands() -> None:
    with pytest.raises(ScenarioError, match=r'trial\.yaml: instruments\.door\.spread\.noise_ft: '):
        default_instruments_with(
            {'door': {'spread': {'noise_ft': 2.0}}},
            'trial.yaml',
            ScenarioError,
            prefix='instruments',
        )
